"""What every model must do, on every kind of scene: of eight models here, of the others in `tests/models`."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.models.boundary_elements.solve import TOLERANCE
from metafem.models.model import contact_of
from tests.models.scenes import HEIGHT, LAWS, MODELS, PEDESTAL, PLACE, RADIUS, lattice, scene, with_law

CELL = 0.015
CELLS = mf.BoundaryElements(CELL)
# The second tolerance makes another choice for most of the scenes here.
AUTOMATIC = (mf.Automatic(1e-3), mf.Automatic(1e-4), mf.Automatic(substrate=mf.BondedLayer()))
# The contact law of each model that has another than Hertz's, by its name.
LAW_OF = {model: name for name in LAWS for model in with_law(name)}
RESOLVING = (CELLS, *AUTOMATIC)
EVERY = (*MODELS, *LAW_OF, *RESOLVING)
FIRST = (
    mf.Independent(),
    mf.Interacting(order=1),
    PEDESTAL,
    *(with_law(name)[1] for name in ("quartic", "jkr", "kogut-etsion")),
    AUTOMATIC[0],
)


def named(model):
    return f"{model}".replace("metafem.", "")


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


def point_of(model):
    """A point that independent asperities meet with one of two 20 um lower; interaction changes it by 0.3 %.

    The search for heights begins without adhesion.
    """
    surface, law = scene(PLACE[:2], [0.12, 0.10], 0.526), contact_of(model).without_adhesion
    area = mf.friction_law(surface, mf.Independent(contact=law), load=[1.36 * 0.022]).area
    return mf.OperatingPoints([0.022], area)


class Contract:
    """The tests of one model, the fixture `model` of a subclass."""

    def test_area_load_and_stiffness_grow_with_the_approach(self, model):
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

    def test_open_surface_carries_nothing(self, model):
        state = mf.equilibrium(scene(), model, approach=-0.01)
        assert (state.load, state.area, state.stiffness) == (0.0, 0.0, 0.0)
        # adhesive contacts hold without a load
        assert (mf.equilibrium(scene(), model, load=0.0).area > 0.0) == contact_of(model).adhesive

    def test_load_and_approach_are_inverse(self, model):
        under_load = mf.equilibrium(scene(), model, load=0.1)
        assert under_load.load == pytest.approx(0.1, rel=1e-12)
        assert under_load.asperity_load.sum() == pytest.approx(0.1, rel=1e-11)
        assert under_load.asperity_area.sum() == pytest.approx(under_load.area, rel=1e-12)
        rtol = rounding(model)
        same_contact(under_load, mf.equilibrium(scene(), model, approach=under_load.approach), rtol=rtol)
        # the separation carries the rounding of the height
        same_contact(under_load, mf.equilibrium(scene(), model, separation=under_load.separation), rtol=rtol)

    def test_stiffness_is_the_derivative_of_the_load(self, model):
        for load in (0.003, 0.1):
            state = mf.equilibrium(scene(), model, load=load)
            step = 1e-5 * state.approach
            low, high = (
                mf.equilibrium(scene(), model, approach=state.approach + s).load for s in (-step, step)
            )
            assert (high - low) / (2 * step) == pytest.approx(state.stiffness, rel=1e-6)

    def test_curve_agrees_with_single_equilibria(self, model):
        loads = np.linspace(0.002, 0.2, 9)
        law = mf.friction_law(scene(), model, load=loads)
        for k in (0, 4, 8):
            state = mf.equilibrium(scene(), model, load=loads[k])
            # one load may need a cheaper model than a curve: each is within the tolerance
            if model in AUTOMATIC:
                assert law.area[k] == pytest.approx(state.area, rel=2 * model.tolerance)
            else:
                # all loads but the last are solved to 1e-10
                rtol = rounding(model) if k == 8 else 1e-9
                assert law.area[k] == pytest.approx(state.area, rel=rtol)
                assert law.stiffness[k] == pytest.approx(state.stiffness, rel=1e-6)

    def test_areas_of_many_surfaces_are_those_of_their_curves(self, model):
        surface, load, rng = scene(), np.array([0.002, 0.05]), np.random.default_rng(0)
        height = surface.height + 0.003 * rng.standard_normal((2, surface.count))
        radius = surface.radius + 0.01 * rng.standard_normal((2, surface.count))
        position = surface.position + 0.05 * rng.standard_normal((2, surface.count, 2))
        for varied in ({}, {"radius": radius}, {"position": position}):
            areas = model.areas(surface, load, height, varied.get("radius"), varied.get("position"))
            for row in range(2):
                changed = {name: values[row] for name, values in varied.items()}
                alone = surface.replaced(height=height[row], **changed)
                expected = model.curve(alone, load).area
                assert_allclose(areas[row], expected, rtol=1e-9)
                assert_allclose(areas[row, -1], expected[-1], rtol=1e-12)

    def test_order_rotation_and_translation_change_nothing(self, model):
        """The grid of the cells moves with the surface; far away, the rounding of the moved input remains."""
        state, rtol = mf.equilibrium(scene(), model, load=0.1), rounding(model, 1e-12)
        order = np.array([3, 0, 5, 1, 4, 2])
        other = mf.equilibrium(scene(PLACE[order], HEIGHT[order], RADIUS[order]), model, load=0.1)
        assert_allclose(other.asperity_load, state.asperity_load[order], rtol=rounding(model))
        assert other.area == pytest.approx(state.area, rel=rtol)
        c, s = np.cos(0.3), np.sin(0.3)
        for place, error in (
            (PLACE @ [[c, s], [-s, c]], cell_error(state) if model == CELLS else rtol),
            (PLACE[:, ::-1] * [-1.0, 1.0], rtol),
            (PLACE + 0.37 * CELL, rtol),
            (PLACE + 1e6, rounding(model, 1e6 * 2.2e-16)),  # eps of 1e6 mm over 1 mm
        ):
            same_contact(state, mf.equilibrium(scene(place), model, load=0.1), rtol=error)

    def test_units_change_nothing(self, model):
        state = mf.equilibrium(scene(), model, load=0.1)
        for unit in (1e-6, 1e6):
            moved = scene(PLACE * unit, HEIGHT * unit, RADIUS * unit, thickness=7.2 * unit)
            other = mf.equilibrium(moved, in_units(model, length=unit), load=0.1 * unit**2)
            same_contact(state, other, length=unit, rtol=rounding(model, 1e-12))
            harder, same = scene(modulus=1.36 * unit), in_units(model, modulus=unit)
            other = mf.equilibrium(harder, same, load=0.1 * unit)
            same_contact(state, other, modulus=unit, rtol=rounding(model, 1e-12))

    def test_one_asperity(self, model):
        surface = scene(PLACE[:1], HEIGHT[:1], RADIUS[:1])
        # too light for cells of a given size, for which a law is that of point loads: a law of two loads
        law = mf.friction_law(surface, model, load=[1e-9, 0.01])
        assert_allclose(law.load, [1e-9, 0.01], rtol=1e-12)
        assert mf.equilibrium(surface, model, load=0.01).area == pytest.approx(
            law.area[1], rel=rounding(model)
        )

    def test_nearly_equal_heights(self, model):
        for height in ([0.1, 0.1 - 1e-6], [0.1, 0.1], [0.1, 0.1 - 1e-13]):
            surface = scene(PLACE[:2], height, 0.5)
            law = mf.friction_law(surface, model, load=np.geomspace(1e-14, 0.05, 30))
            assert (np.diff(law.area) > 0.0).all()
            state = mf.equilibrium(surface, model, load=0.02)
            assert_allclose(*state.asperity_load, rtol=1e-3)

    def test_radii_over_three_decades(self, model):
        place = 20.0 * np.column_stack([np.arange(7) % 3, np.arange(7) // 3])
        surface = scene(place, 0.1 * np.ones(7), np.geomspace(0.01, 10, 7), thickness=30.0)
        law = mf.friction_law(surface, model, load=np.geomspace(1e-9, 0.1, 20))
        assert (np.diff(law.area) > 0.0).all()

    def test_loads_from_nothing_to_ten_times_full_contact(self, model):
        surface = lattice(0.12 - np.minimum(np.random.default_rng(1).exponential(0.035, 36), 0.12))
        full = mf.equilibrium(surface, separation=0.0).load
        # to resolve contacts that have merged would take minutes
        most = 1e-2 if model in RESOLVING else 10.0
        law = mf.friction_law(surface, model, load=full * np.geomspace(1e-12, most, 60))
        assert (np.diff(law.area) > 0.0).all()

    def test_a_design_under_every_model_meets_its_target(self, model):
        template = scene(PLACE[:2], 0.12 * np.ones(2), 0.526)
        point = point_of(model)
        design = mf.design(point, template, model, mf.Limits(0.12))
        law = mf.friction_law(design.surface, model, load=1.36 * point.rescaled_load)
        misfit = abs(law.rescaled_friction[0] / point.rescaled_friction[0] - 1)
        assert design.misfit == pytest.approx(misfit, abs=1e-9)
        assert misfit < 1e-9
        assert design.status is DesignStatus.EXACT
        if model.couples:  # the design does more than repeat that of independent asperities
            alone = mf.friction_law(design.surface, load=law.load)
            assert abs(alone.area[0] / law.area[0] - 1) > 1e-3


class TestContract(Contract):
    @pytest.fixture(params=FIRST, ids=named)
    def model(self, request):
        return request.param


def test_layers_of_every_thickness_and_poisson_ratio():
    for thickness, poisson_ratio in product((0.3, 1.0, 7.2, 1e3, 1e6), (0.0, 0.3, 0.5)):
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


@settings(max_examples=40)
@RANDOM_SCENES
def test_random_scenes_converge(count, seed, approach, spread, decades, model):
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
