"""What every model must do, on every kind of scene."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.models.boundary_elements.solve import TOLERANCE
from metafem.models.model import contact_of
from tests.models.scenes import HEIGHT, LAWS, MODELS, PLACE, RADIUS, lattice, scene, with_law

CELL = 0.015
CELLS = mf.BoundaryElements(CELL)
# The second tolerance makes another choice for most of the scenes here.
AUTOMATIC = (mf.Automatic(1e-3), mf.Automatic(1e-4), mf.Automatic(substrate=mf.BondedLayer()))
# The contact law of each model that has another than Hertz's, by its name. The mean field and the layer run
# with the slow tests.
LAW_OF = {model: name for name in LAWS for model in with_law(name)}
OTHER_LAWS = [
    pytest.param(model, marks=() if i % len(with_law(LAW_OF[model])) < 2 else pytest.mark.slow)
    for i, model in enumerate(LAW_OF)
]
# Resolved contacts take half of the time of all models; they run with the slow tests, and their own tests in
# tests/models/boundary_elements run by default.
EVERY = (*MODELS, *OTHER_LAWS, pytest.param(CELLS, marks=pytest.mark.slow), *AUTOMATIC)


def rounding(model, asperities=1e-11):
    """Relative difference of two solutions of the same equations.

    That of `asperities` is rounding; an iteration over cells ends within its tolerance, here ten times it.
    """
    return 10 * TOLERANCE if model == CELLS else asperities


def in_units(model, length=1.0, modulus=1.0):
    """The model in other units of length and of the modulus."""
    if model == CELLS:
        return mf.BoundaryElements(CELL * length)
    if model not in LAW_OF:
        return model
    name = LAW_OF[model]
    return with_law(name, length, modulus)[with_law(name).index(model)]


def cell_error(state):
    """Relative error of areas and loads by the cells, twice: 0.37 over the square of cells per radius."""
    smallest = np.sqrt(state.asperity_area[state.asperity_area > 0.0].min() / np.pi)
    return 2 * 0.37 * (CELL / smallest) ** 2


def same_contact(state, other, length=1.0, modulus=1.0, rtol=1e-12, stiffness=1e-7):
    """`other` is `state` with lengths and moduli multiplied."""
    force = modulus * length**2
    assert_allclose(
        other.asperity_load, force * state.asperity_load, rtol=rtol, atol=rtol * force * state.load
    )
    assert other.load == pytest.approx(force * state.load, rel=rtol)
    assert other.area == pytest.approx(length**2 * state.area, rel=rtol)
    assert other.approach == pytest.approx(length * state.approach, rel=rtol)
    # the inner iteration may stop a step earlier or later, which costs the square of its tolerance
    assert other.stiffness == pytest.approx(modulus * length * state.stiffness, rel=max(stiffness, rtol))


@pytest.fixture(params=EVERY, ids=lambda model: f"{model}".replace("metafem.", ""))
def model(request):
    return request.param


def test_area_load_and_stiffness_grow_with_the_approach(model):
    if contact_of(model).adhesive:  # at a given approach their load falls where contacts begin
        law = mf.friction_law(scene(), model, load=np.geomspace(1e-4, 1.0, 40))
        assert (np.diff(law.separation) < 0.0).all()
    else:
        approach = np.linspace(1e-4, 0.2, 10 if model == CELLS else 40)
        law = mf.friction_law(scene(), model, separation=HEIGHT.max() - approach)
        assert (np.diff(law.load) > 0.0).all()
    assert (np.diff(law.area) > 0.0).all()
    assert (law.stiffness > 0.0).all()
    assert law.status is mf.Status.CONVERGED


def test_open_surface_carries_nothing(model):
    state = mf.equilibrium(scene(), model, approach=-0.01)
    assert (state.load, state.area, state.stiffness) == (0.0, 0.0, 0.0)
    # adhesive contacts hold without a load
    assert (mf.equilibrium(scene(), model, load=0.0).area > 0.0) == contact_of(model).adhesive


def test_load_and_approach_are_inverse(model):
    under_load = mf.equilibrium(scene(), model, load=0.1)
    assert under_load.load == pytest.approx(0.1, rel=1e-12)
    assert under_load.asperity_load.sum() == pytest.approx(0.1, rel=1e-11)
    assert under_load.asperity_area.sum() == pytest.approx(under_load.area, rel=1e-12)
    rtol = rounding(model)
    same_contact(under_load, mf.equilibrium(scene(), model, approach=under_load.approach), rtol=rtol)
    # the separation carries the rounding of the height
    same_contact(under_load, mf.equilibrium(scene(), model, separation=under_load.separation), rtol=rtol)


def test_stiffness_is_the_derivative_of_the_load(model):
    for load in (0.003, 0.1):
        state = mf.equilibrium(scene(), model, load=load)
        step = 1e-5 * state.approach
        low, high = (mf.equilibrium(scene(), model, approach=state.approach + s).load for s in (-step, step))
        assert (high - low) / (2 * step) == pytest.approx(state.stiffness, rel=1e-6)


def test_curve_agrees_with_single_equilibria(model):
    loads = np.linspace(0.002, 0.2, 9)
    law = mf.friction_law(scene(), model, load=loads)
    for k in (0, 4, 8):
        state = mf.equilibrium(scene(), model, load=loads[k])
        if model in AUTOMATIC:  # one load may need a cheaper model than a curve: each is within the tolerance
            assert law.area[k] == pytest.approx(state.area, rel=2 * model.tolerance)
        else:
            assert law.area[k] == pytest.approx(state.area, rel=rounding(model))
            assert law.stiffness[k] == pytest.approx(state.stiffness, rel=1e-6)


@pytest.mark.parametrize("varied", ["height", "radius", "position"])
def test_areas_of_many_surfaces_are_those_of_their_curves(model, varied):
    surface, load = scene(), np.array([0.002, 0.05])
    rng = np.random.default_rng(0)
    height = surface.height + 0.003 * rng.standard_normal((2, surface.count))
    radius = surface.radius + 0.01 * rng.standard_normal((2, surface.count)) if varied == "radius" else None
    moved = surface.position + 0.05 * rng.standard_normal((2, surface.count, 2))
    position = moved if varied == "position" else None
    areas = model.areas(surface, load, height, radius, position)
    for row in range(2):
        alone = surface.replaced(
            height=height[row],
            radius=surface.radius if radius is None else radius[row],
            position=surface.position if position is None else position[row],
        )
        assert_allclose(areas[row], model.curve(alone, load).area, rtol=1e-12)


def test_permutation_changes_nothing(model):
    order = np.array([3, 0, 5, 1, 4, 2])
    state = mf.equilibrium(scene(), model, load=0.1)
    other = mf.equilibrium(scene(PLACE[order], HEIGHT[order], RADIUS[order]), model, load=0.1)
    assert_allclose(other.asperity_load, state.asperity_load[order], rtol=rounding(model))
    assert other.area == pytest.approx(state.area, rel=rounding(model, 1e-12))


@pytest.mark.parametrize("angle", [0.3, 2.0])
def test_rotation_changes_nothing(model, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    states = [mf.equilibrium(scene(place), model, load=0.1) for place in (PLACE, PLACE @ turn.T)]
    # the turned summits lie differently on the cells
    same_contact(*states, rtol=cell_error(states[0]) if model == CELLS else 1e-12)


def test_a_quarter_turn_changes_nothing(model):
    states = [
        mf.equilibrium(scene(place), model, load=0.1) for place in (PLACE, PLACE[:, ::-1] * [-1.0, 1.0])
    ]
    same_contact(*states, rtol=rounding(model, 1e-12))


def test_a_translation_by_a_part_of_a_cell_changes_nothing(model):
    """The grid of the cells moves with the surface."""
    states = [mf.equilibrium(scene(place), model, load=0.1) for place in (PLACE, PLACE + 0.37 * CELL)]
    same_contact(*states, rtol=rounding(model, 1e-12))


def test_translation_costs_the_rounding_of_the_moved_input(model):
    states = [mf.equilibrium(scene(place), model, load=0.1) for place in (PLACE, PLACE + 1e6)]
    same_contact(*states, rtol=rounding(model, 1e6 * 2.2e-16))  # eps of 1e6 mm over distances of 1 mm


@pytest.mark.parametrize("length", [1e-6, 1e6])
def test_unit_of_length_changes_nothing(model, length):
    moved = scene(PLACE * length, HEIGHT * length, RADIUS * length, thickness=7.2 * length)
    same_contact(
        mf.equilibrium(scene(), model, load=0.1),
        mf.equilibrium(moved, in_units(model, length=length), load=0.1 * length**2),
        length=length,
        rtol=rounding(model, 1e-12),
    )


@pytest.mark.parametrize("modulus", [1e-6, 1e6])
def test_unit_of_force_changes_nothing(model, modulus):
    state = mf.equilibrium(scene(), model, load=0.1)
    other = mf.equilibrium(
        scene(modulus=1.36 * modulus), in_units(model, modulus=modulus), load=0.1 * modulus
    )
    same_contact(state, other, modulus=modulus, rtol=rounding(model, 1e-12))


def test_one_asperity(model):
    surface = scene(PLACE[:1], HEIGHT[:1], RADIUS[:1])
    # too light for cells of a given size, for which a law is that of point loads: a law of two loads
    law = mf.friction_law(surface, model, load=[1e-9, 0.01])
    assert_allclose(law.load, [1e-9, 0.01], rtol=1e-12)
    assert mf.equilibrium(surface, model, load=0.01).area == pytest.approx(law.area[1], rel=rounding(model))


@pytest.mark.parametrize("height", [[0.1, 0.1 - 1e-6], [0.1, 0.1], [0.1, 0.1 - 1e-13]])
def test_nearly_equal_heights(model, height):
    surface = scene(PLACE[:2], height, 0.5)
    law = mf.friction_law(surface, model, load=np.geomspace(1e-14, 0.05, 30))
    assert (np.diff(law.area) > 0.0).all()
    state = mf.equilibrium(surface, model, load=0.02)
    assert_allclose(*state.asperity_load, rtol=1e-3)


def test_radii_over_three_decades(model):
    place = 20.0 * np.column_stack([np.arange(7) % 3, np.arange(7) // 3])
    surface = scene(place, 0.1 * np.ones(7), np.geomspace(0.01, 10, 7), thickness=30.0)
    law = mf.friction_law(surface, model, load=np.geomspace(1e-9, 0.1, 20))
    assert (np.diff(law.area) > 0.0).all()


# Resolved contacts of the whole surface, merged in the end, would take minutes.
@pytest.mark.parametrize("model", [*MODELS, *OTHER_LAWS])
def test_loads_from_nothing_to_ten_times_full_contact(model):
    surface = lattice(0.12 - np.minimum(np.random.default_rng(1).exponential(0.035, 36), 0.12))
    full = mf.equilibrium(surface, separation=0.0).load
    law = mf.friction_law(surface, model, load=full * np.geomspace(1e-12, 10.0, 60))
    assert (np.diff(law.area) > 0.0).all()


@pytest.mark.parametrize("thickness", [0.3, 1.0, 7.2, 1e3, 1e6])
@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.5])
def test_layers_of_every_thickness_and_poisson_ratio(thickness, poisson_ratio):
    surface = lattice(0.1 + 0.002 * np.arange(16), thickness=thickness, poisson_ratio=poisson_ratio)
    for order in (1, 3):
        model = mf.Interacting(order=order, substrate=mf.BondedLayer())
        law = mf.friction_law(surface, model, load=np.geomspace(1e-6, 0.1, 10))
        assert (np.diff(law.area) > 0.0).all()


RANDOM_SCENES = given(
    st.integers(1, 12),
    st.integers(0, 2**32 - 1),
    st.floats(1e-9, 0.3),
    st.floats(0.0, 0.3),
    st.floats(0.0, 1.5),
    st.sampled_from([*MODELS, *LAW_OF]),
)


@settings(max_examples=60)
@RANDOM_SCENES
def test_random_scenes_converge(count, seed, approach, spread, decades, model):
    assert_converges(count, seed, approach, spread, decades, model)


@pytest.mark.slow
@settings(max_examples=200)
@RANDOM_SCENES
def test_many_random_scenes_converge(count, seed, approach, spread, decades, model):
    assert_converges(count, seed, approach, spread, decades, model)


def assert_converges(count, seed, approach, spread, decades, model):
    rng = np.random.default_rng(seed)
    place = 1.5 * np.column_stack([np.arange(count) % 4, np.arange(count) // 4])
    place = place + rng.uniform(-0.4, 0.4, place.shape)
    radius = 0.5 * 10.0 ** rng.uniform(-decades, 0.0, count)
    surface = scene(place, 0.3 - spread * rng.random(count), radius)
    # blunt caps have wide contacts, which would overlap
    state = mf.equilibrium(surface, model, approach=0.2 * approach if model in LAW_OF else approach)
    assert state.status is mf.Status.CONVERGED
    if not contact_of(model).adhesive:  # under a load, these jump past some states
        again = mf.equilibrium(surface, model, load=state.load)
        assert again.area == pytest.approx(state.area, rel=1e-9)


def point_of(model):
    """A point that independent asperities meet with one of two 20 um lower; interaction changes it by 0.3 %.

    The search for heights begins without adhesion.
    """
    surface, law = scene(PLACE[:2], [0.12, 0.10], 0.526), contact_of(model).without_adhesion
    area = mf.friction_law(surface, mf.Independent(contact=law), load=[1.36 * 0.022]).area
    return mf.OperatingPoints([0.022], area)


# The law of a design has a hundred loads.
@pytest.mark.parametrize(
    "model", [*MODELS, *OTHER_LAWS, pytest.param(CELLS, marks=pytest.mark.slow), *AUTOMATIC]
)
def test_a_design_under_every_model_meets_its_target(model):
    template = scene(PLACE[:2], 0.12 * np.ones(2), 0.526)
    point = point_of(model)
    design = mf.design(point, template, model, mf.Limits(0.12))
    law = mf.friction_law(design.surface, model, load=1.36 * point.rescaled_load)
    misfit = abs(law.rescaled_friction[0] / point.rescaled_friction[0] - 1)
    assert design.misfit == pytest.approx(misfit, abs=1e-11)
    assert misfit < 1e-9
    assert design.status is DesignStatus.EXACT
    if model.couples:  # the design does more than repeat that of independent asperities
        alone = mf.friction_law(design.surface, load=law.load)
        assert abs(alone.area[0] / law.area[0] - 1) > 1e-3


class Sticky(mf.PowerCap):
    adhesive = True


LAW, CAP = r"contact = .* must be a contact law", r"contact = .* must be an elastic cap without adhesion"
WRONG = [
    *((kind, {"contact": 4}, LAW) for kind in (mf.Independent, mf.Interacting, mf.MeanField, mf.Automatic)),
    (mf.Independent, {"contact": mf.PowerCap}, LAW),
    *((mf.Interacting, {"order": order}, "order") for order in (2, True, np.array([1, 3]), 1.0)),
    (mf.Interacting, {"substrate": mf.HalfSpace}, "substrate"),
    (mf.Interacting, {"pedestal": 1}, "pedestal"),
    *((mf.Automatic, {"tolerance": tolerance}, "tolerance") for tolerance in (0.0, "low")),
    (mf.Automatic, {"substrate": 3}, "substrate"),
    *((mf.BoundaryElements, {"cell": cell}, "cell") for cell in (0.0, -1.0, np.nan, "x")),
    (mf.BoundaryElements, {"cell": 0.01, "substrate": 3}, "distance alone"),
    *((mf.BoundaryElements, {"cell": 0.01, "contact": law}, CAP) for law in (Sticky(4.0), 4, mf.Hertz)),
]


@pytest.mark.parametrize(("kind", "arguments", "words"), WRONG)
def test_models_that_do_not_exist_are_refused(kind, arguments, words):
    with pytest.raises(mf.InvalidInput, match=words):
        kind(**arguments)


QUARTIC = "PowerCap(exponent=4.0, coefficient=0.5)"


def test_names_state_what_differs_from_the_default():
    cap = mf.PowerCap(4)
    assert mf.BoundaryElements(0.01).name == "resolved"
    assert mf.BoundaryElements(0.01, mf.BondedLayer(), cap).name == f"resolved, layer, {QUARTIC}"
    for kind, name in ((mf.Independent, "independent"), (mf.MeanField, "mean-field")):
        assert repr(kind()) == f"{kind.__name__}()"
        assert repr(kind(cap)) == f"{kind.__name__}(contact={QUARTIC})"
        assert (kind().name, kind(cap).name) == (name, f"{name}, {QUARTIC}")
        assert kind(mf.Hertz()) == kind() != kind(cap)
