"""Designs for operating points and for densities: exact where they can be, and noted where they cannot."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.inversion.density import ExponentialDensity, level_counts
from metafem.inversion.problem import drafting
from tests.models.scenes import said

LIMITS, TALL = mf.Limits(max_height=0.12, offset=0.05), mf.Limits(0.27)
LATTICE = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
POINTS = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])


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
    assert mf.design(target, LATTICE, limits=mf.Limits(0.3)).misfit <= 1e-9


def test_discrete_law_approaches_that_of_the_density():
    result = mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS)
    delta = np.linspace(0.0, 0.08, 9)
    load = 1.36 * result.density.rescaled_load(delta, 64, 0.526)
    # the tallest interval holds 1/N of the mass: its middle is off by O(1/N) of the area there
    found = mf.friction_law(result.surface, load=load).area[::-1]
    np.testing.assert_allclose(found, result.density.area(delta, 64, 0.526), rtol=1.5 / 64)


def test_a_law_of_a_single_level_is_no_success():
    result = mf.design(mf.LinearLaw(50.0), LATTICE, limits=mf.Limits(0.12, height_step=0.006))
    assert result.status is DesignStatus.MISSED


@given(st.floats(0.003, 1.0), st.integers(1, 300), st.floats(0.02, 1.0))
def test_level_counts_add_up(scale, count, share):
    levels, counts = level_counts(ExponentialDensity(scale, 0.12), count, 0.12 * share)
    assert counts.sum() == count
    assert counts.min() >= 0
    assert levels.max() <= 0.12 * (1.0 + 1e-12)


def test_heights_are_dealt_by_the_seed_and_never_sorted():
    first, second, other = (
        mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS, rng=seed).surface.height for seed in (0, 0, 1)
    )
    np.testing.assert_array_equal(first, second)
    assert not (first == other).all()
    np.testing.assert_array_equal(np.sort(first), np.sort(other))
    assert np.ptp(np.sign(np.diff(first))) == 2.0


def test_heights_too_fine_for_the_workshop_are_noted():
    coarse = mf.Limits(max_height=0.12, height_sd=0.003)
    noted = mf.design(mf.LinearLaw(9.0), LATTICE, limits=coarse).notes
    assert noted[0].quantity == "scale"
    assert noted[0].bound == pytest.approx(0.03)
    assert "summits lower" in noted[1].quantity
    fine = mf.Limits(max_height=0.12, height_sd=0.0003)
    assert "scale" not in [note.quantity for note in mf.design(mf.LinearLaw(9.0), LATTICE, limits=fine).notes]


def test_plasticity_index_warns_above_its_limit():
    rough = LATTICE.replaced(height=np.linspace(0.0, 0.2, 64))
    psi = mf.plasticity_index(rough, 100.0)
    assert psi == pytest.approx(1.36 / 100.0 * math.sqrt(rough.height.std() / 0.526), rel=1e-12)
    with pytest.warns(mf.errors.MetafemWarning, match=r"plasticity index .* 0.6"):
        mf.plasticity_index(rough, 0.5)


def test_the_least_coefficient_is_that_of_uniform_heights(template):
    low, high = mf.achievable_friction_coefficients(template, mf.Limits(0.12))
    bound = 0.75 * math.pi * math.sqrt(0.526 / 0.12) * 0.358 * 0.85 / 1.36
    assert (low, high) == (pytest.approx(bound, rel=1e-12), math.inf)


def test_a_law_missed_for_want_of_height_says_so():
    result = mf.design(mf.PowerLaw(1.35, (0.1, 0.4)), LATTICE, limits=mf.Limits(0.1, offset=0.1))
    assert result.status is DesignStatus.MISSED
    assert np.ptp(result.surface.height) == pytest.approx(0.1)
    assert "raise max_height" in said(result)


def test_levels_are_not_told_where_interaction_moved_them():
    alone = mf.design(POINTS, LATTICE, limits=TALL)
    coupled = mf.design(POINTS, LATTICE, mf.Interacting(order=1), TALL)
    assert coupled.misfit <= 1e-9
    assert "levels" in alone.parameters
    assert "levels" not in coupled.parameters


@pytest.mark.parametrize("slope", [6.87, 9.0, 12.0])
def test_a_density_whose_heights_were_moved_is_refined_within_a_hundredth(slope):
    result = mf.design(mf.LinearLaw(slope), LATTICE, mf.Interacting(order=1), LIMITS)
    assert "heights were moved" in said(result)
    assert result.misfit <= 0.1
    expected = DesignStatus.REFINED if result.misfit <= 0.01 else DesignStatus.ADJUSTED
    assert result.status is expected


def test_the_law_of_a_draft_has_fewer_loads_and_the_same_end():
    whole = mf.design(POINTS, LATTICE, mf.Interacting(), TALL)
    with drafting():
        draft = mf.design(POINTS, LATTICE, mf.Interacting(), TALL)
    assert (len(whole.law.load), len(draft.law.load)) == (100, 25)
    assert draft.law.load[-1] == whole.law.load[-1]
    assert draft.misfit < 1e-2
    assert draft.law.residual.max() <= 1e-10
    assert draft.law.residual[-1] <= 1e-12


def test_a_design_states_its_target(template):
    found = mf.design(mf.PowerLaw(1.2, (0.1, 0.4)), template, limits=TALL)
    load = found.target_law.load
    law = mf.friction_law(found.surface, load=1.36 * load)
    np.testing.assert_allclose(found.target_area, law.area, rtol=1e-9)
