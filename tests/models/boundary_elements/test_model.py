"""Resolved contacts of random scenes, on finer cells, and of deformed contacts."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from tests.core.models.boundary_elements.test_model import MATERIAL, RADIUS, hertz_errors


def test_hertz_error_falls_as_the_square_of_the_cell():
    counts = np.array([10, 20, 40, 80])
    offsets = [(0.0, 0.0), (0.5, 0.5), (0.3, 0.1), (0.25, 0.4)]
    errors = [np.mean([hertz_errors(n, *o) for o in offsets], axis=0) for n in counts]
    for error in np.transpose(errors):
        rate = -np.polyfit(np.log(counts), np.log(error), 1)[0]
        assert rate >= 1.9


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


# Three contacts that nearly touch, and two that have merged; areas are extrapolated from 80 and 120 cells per
# 0.17 mm.
CROWDED = [
    ([[0, 0], [0.22, 0.05], [0.1, 0.2]], [0.1, 0.11, 0.1], 0.05, 0.138790),
    ([[0, 0], [0.1, 0.0]], [0.1, 0.1], 0.06, 0.125957),
]


@pytest.mark.parametrize(("place", "height", "approach", "area"), CROWDED)
def test_areas_of_deformed_contacts_are_within_seven_cells_each(place, height, approach, area):
    surface = mf.Surface(place, height, RADIUS, MATERIAL)
    for cell in (0.006, 0.004):
        found = mf.equilibrium(surface, mf.BoundaryElements(cell), approach=approach)
        assert abs(found.area - area) < 7.0 * surface.count * cell**2
