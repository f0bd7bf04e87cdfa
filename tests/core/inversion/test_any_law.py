"""Laws of any shape under any model, their bounds, and what cannot be reached."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion import DesignStatus
from validation.scenes.random_laws import LATTICE, LIMITS, random_law

MODELS = [mf.Independent(), mf.Interacting(), mf.Interacting(substrate=mf.BondedLayer())]


@settings(max_examples=25)
@given(st.integers(0, 10**6))
def test_laws_of_random_surfaces_are_recovered(seed):
    result = mf.design(random_law(seed), LATTICE, limits=mf.Limits(0.6))
    assert result.misfit <= 2e-3
    assert result.status in (DesignStatus.REACHED, DesignStatus.EXACT)


@pytest.mark.parametrize("model", MODELS, ids=repr)
def test_operating_points_are_met_exactly_under_every_model(model):
    target = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])
    for seed in range(3):
        result = mf.design(target, LATTICE, model, mf.Limits(0.27), rng=seed)
        assert result.misfit <= 1e-9
        areas = [mf.equilibrium(result.surface, model, load=1.36 * p).area for p in target.rescaled_load]
        np.testing.assert_allclose(areas, target.rescaled_friction, rtol=2e-9)


@pytest.mark.parametrize("exponent", [2 / 3, 0.8, 1.0, 1.2, 1.35])
@pytest.mark.parametrize("model", MODELS, ids=repr)
def test_power_laws_are_met_under_every_model(model, exponent):
    result = mf.design(mf.PowerLaw(exponent, (0.1, 0.4)), LATTICE, model, LIMITS)
    assert result.misfit <= 1.5e-3
    load = np.array([0.1, 0.2, 0.4])
    area = mf.friction_law(result.surface, model, load=1.36 * load).area
    wanted = result.parameters["prefactor"] * load**exponent
    np.testing.assert_allclose(area, wanted, rtol=1e-2)  # single loads against the rms of 30


def test_a_bilinear_law_with_a_smaller_second_slope():
    target = mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26))
    for model in MODELS:
        result = mf.design(target, LATTICE, model, LIMITS)
        for branch, fit in result.fits:
            assert fit.slope == pytest.approx(branch.slope, rel=0.01)


def test_branches_that_meet_share_one_intercept():
    target = mf.MultilinearLaw([7.0, 9.0], [0.15], (0.05, 0.3))
    result = mf.design(target, LATTICE, limits=LIMITS)
    assert len(result.parameters["intercepts"]) == 1
    assert result.misfit <= 0.01


def test_feasible_region_ends_where_the_base_plane_begins():
    low, high = mf.feasible_region(LATTICE, [0.1, 20.0], LIMITS)
    assert high[0] / low[0] == pytest.approx(4.0, rel=1e-12)
    assert np.isnan(low[1])
    assert np.isnan(high[1])


def test_laws_from_forces():
    pair = mf.Material(2.0), mf.Friction(0.5)
    power = mf.PowerLaw.from_forces([1.0, 2.0, 4.0], [1.0, 2.0**0.9, 4.0**0.9], *pair)
    assert power.exponent == pytest.approx(0.9, rel=1e-12)
    assert power.load_range == (0.5, 2.0)
    many = mf.MultilinearLaw.from_forces([1.0, 2.0, 3.0], [1.0, 2.0, 4.0], *pair)
    assert many.slopes == pytest.approx((4.0, 8.0), rel=1e-12)
    assert many.crossover_loads == ((1.0, 1.0),)
    sampled = mf.SampledLaw.from_forces([1.0, 2.0], [1.0, 2.0], *pair)
    np.testing.assert_allclose(sampled.rescaled_friction, [2.0, 4.0], rtol=1e-12)


def test_a_model_without_gradients_refines_and_names_whose_it_uses():
    target = mf.OperatingPoints([0.1, 0.2, 0.4], [0.8, 1.5, 2.9])
    result = mf.design(target, LATTICE, mf.Automatic(), mf.Limits(0.12))
    assert result.misfit <= 1e-9
    assert result.status is DesignStatus.EXACT
    assert any("gradients were those of the model half-space" in str(note) for note in result.notes)
