"""Designs of all three kinds: exact where they can be, refused with a reason where they cannot."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.inversion.height_density import ExponentialDensity
from metafem.inversion.strategies.exponential import level_counts
from tests.models.scenes import said

LIMITS = mf.Limits(max_height=0.12, offset=0.05)
LATTICE = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
TALL = mf.Limits(0.27)


def after(third, second=1.68):
    """Return three operating points with some frictions of the last two."""
    return mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, second, third])


POINTS = after(4.12)


@given(st.integers(0, 10**6))
def test_points_of_any_level_surface_can_be_designed(seed):
    """A law taken from levels with adjustments is reachable, whatever they are."""
    rng = np.random.default_rng(seed)
    levels = 0.3 - np.concatenate([[0.0], np.cumsum(rng.uniform(0.01, 0.06, 2))])
    height = np.repeat(levels, rng.integers(1, 12, 3))
    at = np.append(levels[1:], levels[-1] - 0.02)
    surface = mf.Surface.square_lattice(height, (1, len(height)), radius=0.526, material=mf.Material(1.0))
    law = mf.friction_law(surface, separation=at)
    target = mf.OperatingPoints(law.rescaled_load, law.rescaled_friction)
    result = mf.design(target, LATTICE, limits=mf.Limits(0.3))
    assert result.misfit <= 1e-9
    assert result.surface.count <= len(height) + 3


@pytest.mark.parametrize("shape", [(8, 8), (60, 60)])
def test_discrete_law_approaches_that_of_the_density(shape):
    lattice = mf.Surface.square_lattice(0.12, shape, radius=0.526, material=mf.Material(1.0))
    result = mf.design(mf.LinearLaw(7.0), lattice, limits=LIMITS)
    delta = np.linspace(0.0, 0.08, 9)
    load = result.density.rescaled_load(delta, lattice.count, 0.526)
    expected = result.density.area(delta, lattice.count, 0.526)
    found = mf.friction_law(result.surface, load=load).area[::-1]
    # the tallest interval holds 1/N of the mass: its middle is off by O(1/N) of the area there
    np.testing.assert_allclose(found, expected, rtol=1.5 / lattice.count)


@pytest.mark.parametrize("slope", [50.0, 1e3, 1e6])
def test_a_law_of_a_single_level_is_no_success(template, slope):
    result = mf.design(mf.LinearLaw(slope), template, limits=mf.Limits(0.12, height_step=0.006))
    assert result.status is DesignStatus.MISSED


@given(st.floats(0.003, 1.0), st.integers(1, 300), st.floats(0.02, 1.0))
def test_level_counts_add_up_and_stay_near_their_expectation(scale, count, share):
    density = ExponentialDensity(scale, 0.12)
    levels, counts = level_counts(density, count, 0.12 * share)
    assert counts.sum() == count
    assert counts.min() >= 0
    assert levels.max() <= 0.12 * (1.0 + 1e-12)


def test_heights_are_dealt_by_the_seed_and_never_sorted(template):
    first, second, other = (mf.design(mf.LinearLaw(7.0), template, limits=LIMITS, rng=s) for s in (0, 0, 1))
    np.testing.assert_array_equal(first.surface.height, second.surface.height)
    assert not (first.surface.height == other.surface.height).all()
    np.testing.assert_array_equal(np.sort(first.surface.height), np.sort(other.surface.height))
    assert (np.diff(first.surface.height) > 0).any()
    assert (np.diff(first.surface.height) < 0).any()


def test_heights_too_fine_for_the_workshop_are_noted(template):
    limits = mf.Limits(max_height=0.12, height_sd=0.003)
    notes = mf.design(mf.LinearLaw(9.0), template, limits=limits).notes
    assert "below 10 times height_sd" in notes[0].text
    assert "are lower than 10 times height_sd" in notes[1].text


def test_targets_from_forces(template):
    pair = template.material, template.friction
    factor = 0.358 * 0.85
    points = mf.OperatingPoints.from_forces([0.2, 0.4], [0.3, 0.5], *pair)
    np.testing.assert_allclose(points.rescaled_load, np.array([0.2, 0.4]) / 1.36, rtol=1e-12)
    np.testing.assert_allclose(points.rescaled_friction, np.array([0.3, 0.5]) / factor, rtol=1e-12)
    line = mf.LinearLaw.from_forces([0.1, 0.2, 0.3], [0.3, 0.5, 0.7], *pair)
    assert line.slope == pytest.approx(2.0 * 1.36 / factor, rel=1e-12)
    two = mf.BilinearLaw.from_forces([0.1, 0.2, 0.3], [0.1, 0.2, 0.4], *pair)
    assert two.slopes[1] == pytest.approx(2.0 * two.slopes[0], rel=1e-12)
    assert two.crossover_load == pytest.approx(0.2 / 1.36, rel=1e-12)


def test_plasticity_index_warns_above_its_limit(template):
    rough = template.replaced(height=np.linspace(0.0, 0.2, 64))
    psi = mf.plasticity_index(rough, 100.0)
    assert psi == pytest.approx(1.36 / 100.0 * math.sqrt(rough.height.std() / 0.526), rel=1e-12)
    with pytest.warns(mf.MetafemWarning, match="plasticity index .* is not below 0.6"):
        mf.plasticity_index(rough, 0.5)


def test_coefficient_bounds_need_a_friction(template):
    low, high = mf.achievable_friction_coefficients(template, mf.Limits(0.12))
    bound = 0.75 * math.pi * math.sqrt(0.526 / 0.12) * 0.358 * 0.85 / 1.36
    assert (low, high) == (pytest.approx(bound, rel=1e-12), math.inf)
    with pytest.raises(mf.InvalidInput, match="template has no friction"):
        mf.achievable_friction_coefficients(template.replaced(friction=None), LIMITS)


def test_a_law_missed_for_want_of_height_says_so(template):
    target = mf.PowerLaw(1.35, (0.1, 0.4))
    result = mf.design(target, template, limits=mf.Limits(0.1, offset=0.1))
    assert result.status is DesignStatus.MISSED
    assert "the heights use the whole allowed range of 0.1 mm: raise max_height" in " ".join(
        map(str, result.notes)
    )


def test_levels_are_not_told_where_interaction_moved_them(template):
    result = mf.design(POINTS, template, mf.Interacting(order=1), TALL)
    assert result.surface.count == 64
    assert "6 asperities were added" in said(result)
    assert "levels" not in result.parameters


@pytest.mark.parametrize(("slope", "status"), [(6.87, "APPROXIMATE"), (9.0, "REFINED")])
def test_a_density_is_refined_where_its_law_has_the_slope_within_a_hundredth(template, slope, status):
    result = mf.design(mf.LinearLaw(slope), template, mf.Interacting(order=1), LIMITS)
    assert "heights were moved" in said(result)
    assert (result.misfit <= 0.01) == (status == "REFINED")
    assert result.status.name == status
