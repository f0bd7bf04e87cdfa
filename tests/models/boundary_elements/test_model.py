import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.models import _resources
from metafem.models.boundary_elements import patches, solve
from metafem.substrate import Radial
from tests.models.scenes import single_contact

MATERIAL = mf.Material(1.36)
RADIUS = 0.526
PAIR = mf.Surface([[0.0, 0.0], [1.0, 0.3]], [0.1, 0.11], RADIUS, MATERIAL)
COARSE = mf.BoundaryElements(0.008)


def hertz_errors(per_radius, *offset):
    """Relative errors in load and in area at one approach."""
    state, exact = single_contact(mf.Hertz(), per_radius, offset)
    return abs(state.load / exact.load - 1.0), abs(state.area / exact.area - 1.0)


@settings(deadline=None, max_examples=20)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_hertz_is_met_at_any_offset_from_the_grid(x, y):
    load, area = hertz_errors(50, x, y)
    assert load <= 5e-5
    assert area <= 1.5e-4


def test_hertz_error_falls_as_the_square_of_the_cell():
    counts = np.array([10, 14, 20, 28, 40, 56, 80])
    offsets = [(0.0, 0.0), (0.5, 0.5), (0.3, 0.1), (0.25, 0.4)]
    errors = [np.mean([hertz_errors(n, *o) for o in offsets], axis=0) for n in counts]
    for error in np.transpose(errors):
        rate = -np.polyfit(np.log(counts), np.log(error), 1)[0]
        assert rate >= 1.9


def order_one_load(surface, approach):
    """Point loads by plain Newton steps; every contact is closed."""
    influence, d = mf.HalfSpace().influence_matrix(surface), np.full(surface.count, 0.5 * approach)
    for _ in range(20):
        load = 4.0 / 3.0 * math.sqrt(RADIUS) * d**1.5
        slope = 2.0 * np.sqrt(RADIUS * d)
        d = d - np.linalg.solve(np.eye(d.size) + influence * slope, d + influence @ load - approach)
    return surface.material.composite_modulus * load.sum()


# physics.md, section 2: the total load of independent asperities and of point loads at fixed approach
# against resolved contacts, cells .005 to .008 mm; (approach, independent, its digit, point loads)
REFERENCE = [(0.1, 0.50, 5e-4), (0.2, 0.70, 7e-4), (0.3, 0.84, 8e-4), (0.45, None, 5e-4)]


@pytest.mark.parametrize(
    ("approach", "independent", "point_loads"),
    [REFERENCE[0], *(pytest.param(*row, marks=pytest.mark.slow) for row in REFERENCE[1:3]), REFERENCE[3]],
)
def test_nine_asperities_carry_what_the_reference_says(approach, independent, point_loads):
    surface = mf.Surface.square_lattice(0.5, (3, 3), 1.5, radius=RADIUS, material=MATERIAL)
    state = mf.equilibrium(surface, mf.BoundaryElements(0.006), approach=approach)
    # half of the last printed digit, and the 3e-5 of either solution
    assert order_one_load(surface, approach) / state.load - 1.0 == pytest.approx(point_loads, abs=5e-5 + 6e-5)
    if independent is not None:
        excess = mf.equilibrium(surface, approach=approach).load / state.load - 1.0
        assert excess == pytest.approx(independent, abs=5e-3)
    third = mf.Interacting(order=3)
    assert mf.equilibrium(surface, third, approach=approach).load == pytest.approx(state.load, rel=2.5e-4)
    assert mf.equilibrium(surface, third, load=state.load).area == pytest.approx(state.area, rel=8e-4)


@dataclass(frozen=True)
class Lifted(Radial):
    """A half-space whose surface rises everywhere alike under load."""

    @property
    def name(self):
        return "lifted"

    @property
    def self_influence(self):
        return -0.2

    @property
    def self_curvature(self):
        return 0.0

    def regular_derivatives(self, distance):
        return np.full_like(distance, -0.2), np.zeros_like(distance), np.zeros_like(distance)


def test_a_constant_in_the_influence_moves_the_approach_alone():
    plain = mf.equilibrium(PAIR, COARSE, load=0.05)
    lifted = mf.equilibrium(PAIR, mf.BoundaryElements(0.008, Lifted()), load=0.05)
    np.testing.assert_allclose(lifted.asperity_load, plain.asperity_load, rtol=1e-8)
    assert lifted.area == pytest.approx(plain.area, rel=1e-8)
    shift = -0.2 * 0.05 / MATERIAL.composite_modulus
    assert lifted.approach - plain.approach == pytest.approx(shift, rel=1e-8)


def on_layer(surface, thickness, cell=0.008, **given):
    bonded = surface.replaced(block=mf.Block(20.0, 20.0, thickness))
    return mf.equilibrium(bonded, mf.BoundaryElements(cell, mf.BondedLayer()), **given)


def test_a_very_thick_layer_is_a_half_space():
    thick, half = on_layer(PAIR, 1e6, load=0.05), mf.equilibrium(PAIR, COARSE, load=0.05)
    # the layer's part is -0.56/t per load
    assert thick.area == pytest.approx(half.area, rel=1e-6)
    assert thick.approach == pytest.approx(half.approach, rel=1e-6)


def test_a_layer_bends_the_contact_by_its_self_curvature():
    lone = mf.Surface([[0.0, 0.0]], [0.3], RADIUS, MATERIAL)
    state = on_layer(lone, 1.5, cell=0.004, load=0.05)
    load, cube = 0.05 / MATERIAL.composite_modulus, (state.area / math.pi) ** 1.5
    bend = load * mf.BondedLayer(1.5, 0.5).self_curvature
    # Hertz with the bent summit, P = 4/3 a^3 (1/R + bend); the next term is (a/t)^2 of the bend
    assert load / (4.0 / 3.0 * cube) == pytest.approx(1.0 / RADIUS + bend, rel=3e-4)
    assert bend * RADIUS > 2e-3


def test_thin_layers_are_resolved_and_their_shape_is_said():
    surface = PAIR.replaced(height=[0.3, 0.31])
    state = on_layer(surface, 0.1, load=0.05)
    assert any("not that of a Hertzian ellipse" in note.text for note in state.notes)
    # an incompressible layer squeezed thin: stiffer than any half-space
    assert state.stiffness > 2.0 * mf.equilibrium(surface, COARSE, load=0.05).stiffness


def test_residual_is_within_the_tolerance_and_stated():
    state = mf.equilibrium(PAIR, COARSE, load=0.05)
    assert 0.0 < state.residual <= COARSE.curve(PAIR, load=[0.05]).tolerance == 1e-9
    assert state.status is mf.Status.CONVERGED


def test_merged_contacts_are_said_and_counted():
    surface = PAIR.replaced(position=[[0.0, 0.0], [0.1, 0.0]], height=0.1 * np.ones(2))
    areas = []
    for cell in (0.004, 0.002):
        state = mf.equilibrium(surface, mf.BoundaryElements(cell), approach=0.06)
        assert any("merged" in note.text for note in state.notes)
        areas.append(state.area)
    # a tenth of the cell over the radius
    assert areas[0] == pytest.approx(areas[1], rel=3e-3)


def test_contacts_that_nearly_touch_are_resolved():
    surface = PAIR.replaced(position=[[0.0, 0.0], [0.33, 0.0]], height=0.1 * np.ones(2))
    state = mf.equilibrium(surface, mf.BoundaryElements(0.004), approach=0.06)
    assert state.asperity_area == pytest.approx(state.area / 2.0, rel=1e-6)
    assert state.status is mf.Status.CONVERGED


def test_small_contacts_are_said():
    surface = PAIR.replaced(height=[0.1, 0.2018])
    state = mf.equilibrium(surface, COARSE, load=0.05)
    assert any("fewer than 4 cells" in note.text for note in state.notes)


def test_neighbourhoods_grow_until_they_hold_the_contacts(monkeypatch):
    full = mf.equilibrium(PAIR, COARSE, load=0.05)
    monkeypatch.setattr(solve, "MARGIN_CELLS", 1.0)
    monkeypatch.setattr(solve, "MARGIN_SHARE", -0.5)
    grown = mf.equilibrium(PAIR, COARSE, load=0.05)
    assert grown.area == pytest.approx(full.area, rel=1e-7)


def test_cells_too_coarse_for_the_largest_contact_are_refused():
    with pytest.raises(mf.InvalidInput, match="4 cells per radius"):
        mf.equilibrium(PAIR, mf.BoundaryElements(0.1), load=0.05)


def test_memory_is_that_of_the_machine_or_a_guess(monkeypatch):
    def unknown(name):
        raise ValueError(name)

    assert _resources.memory() > 2**28
    monkeypatch.setattr(_resources.os, "sysconf", unknown)
    assert _resources.memory() == _resources.DEFAULT_MEMORY


def test_memory_is_estimated_before_it_is_taken():
    with pytest.raises(mf.InvalidInput, match="of memory, and the machine has"):
        mf.equilibrium(PAIR, mf.BoundaryElements(1e-6), load=0.05)


heights = st.lists(st.floats(0.0, 0.1), min_size=1, max_size=6)


@settings(deadline=None, max_examples=30)
@given(heights, st.integers(0, 10**6), st.floats(0.4, 4.0), st.floats(0.05, 0.15))
def test_random_scenes_end_certified(height, seed, spread, approach):
    rng = np.random.default_rng(seed)
    radius = 0.5 * 10.0 ** rng.uniform(-0.5, 0.5, len(height))
    surface = mf.Surface(rng.uniform(0.0, spread, (len(height), 2)), height, radius, MATERIAL)
    model = mf.BoundaryElements(0.015)
    at = mf.equilibrium(surface, model, approach=approach)
    under = mf.equilibrium(surface, model, load=1.1 * at.load)
    for state in (at, under):
        assert state.residual <= 1e-9
        assert state.asperity_load.min() >= 0.0
        assert state.asperity_load.sum() == pytest.approx(state.load, rel=1e-12)
    assert under.load == pytest.approx(1.1 * at.load, rel=1e-12)
    # the load is convex in the approach, so the tangent at the lower end underrates it
    assert approach < under.approach <= approach + 0.1 * at.load / at.stiffness * 1.02


def test_stopping_early_raises_with_the_state(monkeypatch):
    monkeypatch.setattr(solve, "MAX_ITERATIONS", 1)
    monkeypatch.setattr(solve, "MAX_GROWTHS", 1)
    with pytest.raises(mf.NotConverged) as caught:
        mf.equilibrium(PAIR, COARSE, load=0.05)
    assert caught.value.state.residual > 1e-9


def test_patches_give_what_one_grid_gives(monkeypatch):
    surface = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.1], (2, 2), 0.9, radius=RADIUS, material=MATERIAL)
    apart = mf.equilibrium(surface, COARSE, load=0.1)
    assert "4 patches" in apart.notes[1].text
    monkeypatch.setattr(patches, "SLOWEST_RATE", math.inf)
    whole = mf.equilibrium(surface, COARSE, load=0.1)
    assert len(whole.notes) == 1
    np.testing.assert_allclose(apart.asperity_load, whole.asperity_load, rtol=1e-8)
    np.testing.assert_allclose(apart.asperity_area, whole.asperity_area, rtol=1e-8)


def crowded(count):
    """Three contacts that nearly touch, or two that have merged."""
    place, height = ([[0, 0], [0.22, 0.05], [0.1, 0.2]], [0.1, 0.11, 0.1])
    if count == 2:
        place, height = ([[0, 0], [0.1, 0.0]], [0.1, 0.1])
    return mf.Surface(place, height, RADIUS, MATERIAL)


# Areas are extrapolated from 80 and 120 cells per 0.17 mm.
@pytest.mark.parametrize(("count", "area"), [(3, 0.138790), (2, 0.125957)])
def test_areas_of_deformed_contacts_are_within_seven_cells_each(count, area):
    for cell in (0.006, 0.004):
        found = mf.equilibrium(crowded(count), mf.BoundaryElements(cell), approach=0.05 + 0.01 * (count == 2))
        assert abs(found.area - area) < 7.0 * count * cell**2


def test_a_summit_in_the_contact_of_another_gets_cells_up_to_the_end_of_its_own():
    """The lower summit seems out of contact at first, and its part of the contact ends at the cells' edge."""
    pair = mf.Surface([[0.0, 0.0], [0.1, 0.0]], [0.10, 0.12], 0.526, mf.Material(1.36))
    state = mf.equilibrium(pair, mf.BoundaryElements(0.004), load=0.2)
    assert state.status is mf.Status.CONVERGED
    coarse = mf.equilibrium(pair, mf.BoundaryElements(0.01), load=0.2)
    assert state.area == pytest.approx(coarse.area, rel=5e-3)
