"""What every model must do, on every kind of scene."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import metafem as mf
from tests.models.scenes import HEIGHT, MODELS, PLACE, RADIUS, lattice, scene


def same_contact(state, other, length=1.0, modulus=1.0, rtol=1e-12):
    """`other` is `state` with lengths and moduli multiplied."""
    force = modulus * length**2
    assert_allclose(
        other.asperity_load, force * state.asperity_load, rtol=rtol, atol=rtol * force * state.load
    )
    assert other.load == pytest.approx(force * state.load, rel=rtol)
    assert other.area == pytest.approx(length**2 * state.area, rel=rtol)
    assert other.approach == pytest.approx(length * state.approach, rel=rtol)
    # the inner iteration may stop a step earlier or later, which costs the square of its tolerance
    assert other.stiffness == pytest.approx(modulus * length * state.stiffness, rel=1e-7)


@pytest.fixture(params=MODELS, ids=lambda model: f"{model}".replace("metafem.", ""))
def model(request):
    return request.param


def test_area_load_and_stiffness_grow_with_the_approach(model):
    curve = model.curve_at(scene(), np.linspace(1e-4, 0.2, 40))
    assert (np.diff(curve.load) > 0.0).all()
    assert (np.diff(curve.area) > 0.0).all()
    assert (curve.stiffness > 0.0).all()
    assert curve.residual.max() <= model.tolerance


def test_open_surface_carries_nothing(model):
    state = mf.equilibrium(scene(), model, approach=-0.01)
    assert (state.load, state.area, state.stiffness) == (0.0, 0.0, 0.0)
    assert mf.equilibrium(scene(), model, load=0.0).area == 0.0


def test_load_and_approach_are_inverse(model):
    under_load = mf.equilibrium(scene(), model, load=0.1)
    assert under_load.load == pytest.approx(0.1, rel=1e-12)
    same_contact(under_load, mf.equilibrium(scene(), model, approach=under_load.approach), rtol=1e-11)
    # the separation carries the rounding of the height
    same_contact(under_load, mf.equilibrium(scene(), model, separation=under_load.separation), rtol=1e-11)


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
        assert law.area[k] == pytest.approx(state.area, rel=1e-11)
        assert law.stiffness[k] == pytest.approx(state.stiffness, rel=1e-6)


def test_permutation_changes_nothing(model):
    order = np.array([3, 0, 5, 1, 4, 2])
    state = mf.equilibrium(scene(), model, load=0.1)
    other = mf.equilibrium(scene(PLACE[order], HEIGHT[order], RADIUS[order]), model, load=0.1)
    assert_allclose(other.asperity_load, state.asperity_load[order], rtol=1e-11)
    assert other.area == pytest.approx(state.area, rel=1e-12)


@pytest.mark.parametrize("angle", [0.3, 2.0])
def test_rotation_changes_nothing(model, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    states = [mf.equilibrium(scene(place), model, load=0.1) for place in (PLACE, PLACE @ turn.T)]
    same_contact(*states)


def test_translation_costs_the_rounding_of_the_moved_input(model):
    states = [mf.equilibrium(scene(place), model, load=0.1) for place in (PLACE, PLACE + 1e6)]
    same_contact(*states, rtol=1e6 * 2.2e-16)  # eps of 1e6 mm over distances of 1 mm


@pytest.mark.parametrize("length", [1e-6, 1e6])
def test_unit_of_length_changes_nothing(model, length):
    moved = scene(PLACE * length, HEIGHT * length, RADIUS * length, thickness=7.2 * length)
    same_contact(
        mf.equilibrium(scene(), model, load=0.1),
        mf.equilibrium(moved, model, load=0.1 * length**2),
        length=length,
    )


@pytest.mark.parametrize("modulus", [1e-6, 1e6])
def test_unit_of_force_changes_nothing(model, modulus):
    state = mf.equilibrium(scene(), model, load=0.1)
    other = mf.equilibrium(scene(modulus=1.36 * modulus), model, load=0.1 * modulus)
    same_contact(state, other, modulus=modulus)


def test_one_asperity(model):
    surface = scene(PLACE[:1], HEIGHT[:1], RADIUS[:1])
    for load in (1e-9, 0.01):
        assert mf.equilibrium(surface, model, load=load).load == pytest.approx(load, rel=1e-12)


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


@given(
    st.integers(1, 12),
    st.integers(0, 2**32 - 1),
    st.floats(1e-9, 0.3),
    st.floats(0.0, 0.3),
    st.floats(0.0, 1.5),
    st.sampled_from(MODELS),
)
@settings(max_examples=200)
def test_random_scenes_converge(count, seed, approach, spread, decades, model):
    rng = np.random.default_rng(seed)
    place = 1.5 * np.column_stack([np.arange(count) % 4, np.arange(count) // 4])
    place = place + rng.uniform(-0.4, 0.4, place.shape)
    radius = 0.5 * 10.0 ** rng.uniform(-decades, 0.0, count)
    surface = scene(place, 0.3 - spread * rng.random(count), radius)
    state = mf.equilibrium(surface, model, approach=approach)
    assert state.residual <= model.tolerance
    again = mf.equilibrium(surface, model, load=state.load)
    assert again.area == pytest.approx(state.area, rel=1e-9)
