"""Searches for laws of surfaces without levels, under other contact laws, and within the limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion import DesignStatus
from tests.models.scenes import said
from validation.scenes.random_laws import LATTICE, RADIUS, noisy_law, random_law
from validation.scenes.real_targets import misfit

LIMITS = mf.Limits(max_height=0.12, offset=0.05)
RHO = np.linspace(0.0, 0.5, 120)
TABLE = mf.Elastic(mf.Profile([RHO, RADIUS - np.sqrt(RADIUS**2 - RHO**2)]))


@settings(max_examples=15)
@given(st.floats(5.2, 12.0), st.floats(0.0, 1.0), st.floats(0.05, 0.8))
def test_every_second_slope_within_the_stated_bounds_is_solved(first, share, load):
    crossover = load * mf.design(mf.LinearLaw(first), LATTICE, limits=LIMITS).parameters["foot_load"]
    bounds = []
    for extreme in (1e-3, 1e6):
        with pytest.raises(mf.Infeasible) as caught:
            mf.design(mf.BilinearLaw((first, extreme), crossover), LATTICE, limits=LIMITS)
        bounds.append(caught.value.nearest.slopes[1])
    second = bounds[0] + share * (bounds[1] - bounds[0])
    found = mf.design(mf.BilinearLaw((first, second), crossover), LATTICE, limits=LIMITS)
    assert found.density.asymptotic_slopes(0.526)[1] == pytest.approx(second, rel=1e-9)


@pytest.mark.parametrize(("count", "points"), [(3, 2), (8, 3), (64, 5)])
def test_points_of_surfaces_without_levels_are_met_or_nearly_so(count, points):
    lattice = mf.Surface.square_lattice(0.5, (1, count), radius=0.526, material=mf.Material(1.0))
    for seed in range(4):
        rng = np.random.default_rng(seed)
        height, load = rng.exponential(0.03, count), np.sort(rng.uniform(0.001, 1.8, points)) * count / 64
        area = mf.Independent().curve_of(height, np.full(count, 0.526), load).area
        result = mf.design(mf.OperatingPoints(load, area), lattice, limits=mf.Limits(0.5))
        assert result.misfit < 3e-3
        assert result.status in (DesignStatus.EXACT, DesignStatus.REACHED)


def test_no_summit_stands_below_the_foot(template):
    """Heights over the whole span end at it to rounding."""
    for top in (0.06, 0.085):
        limits = mf.Limits(top, min_height=0.01)
        assert mf.design(mf.PowerLaw(1.5, (0.1, 0.4)), template, limits=limits).surface.height.min() >= 0.01


def test_the_notes_of_a_law_are_those_of_its_own_loads(template):
    design = mf.design(mf.LinearLaw(6.87), template, mf.Interacting())
    again = mf.friction_law(design.surface, mf.Interacting(), load=design.law.load)
    assert said(design.law) == said(again)


def test_later_points_move_as_well_where_the_moved_one_needs_all_asperities(template):
    target = mf.OperatingPoints([0.144, 0.336, 0.649], [4.0, 4.1, 4.2])
    with pytest.raises(mf.Infeasible) as caught:
        mf.design(target, template, limits=mf.Limits(0.27))
    near = caught.value.nearest
    assert near.rescaled_load.tolist() == target.rescaled_load.tolist()
    assert mf.design(near, template, limits=mf.Limits(0.27)).misfit < 1e-8


COUPLED = [mf.Interacting(3, mf.BondedLayer()), mf.Interacting(contact=mf.Elastic(mf.Sphere()))]


@pytest.mark.parametrize("model", COUPLED, ids=["layer", "spheres"])
@pytest.mark.parametrize("spread", [0.0, 0.03])
def test_points_of_a_surface_are_not_refused_under_its_own_model(model, spread):
    """Equal heights have the largest friction of independent asperities; coupled ones have more."""
    height = 0.2 - np.random.default_rng(0).uniform(0.0, spread, 9)
    surface = LATTICE.only(slice(9), height=height)
    for load in ([0.01, 0.05], [0.004, 0.02, 0.045]):
        points = mf.OperatingPoints(load, model.curve(surface, np.array(load)).area)
        assert mf.design(points, surface, model, mf.Limits(0.12, offset=0.08)).misfit < 1e-3


@pytest.mark.parametrize(
    "law",
    [mf.Elastic(mf.Power(1.5)), mf.Elastic(mf.Power(4)), mf.KogutEtsion(5.0), mf.JKR(9e-6), TABLE],
    ids=repr,
)
@settings(max_examples=2)
@given(seed=st.integers(0, 10**6))
def test_laws_of_random_surfaces_are_recovered_under_every_law(law, seed):
    """With adhesion a contact enters with a jump of its area, which other entries cannot follow."""
    model, rng = mf.Independent(contact=law), np.random.default_rng(seed)
    height, load = rng.exponential(rng.uniform(0.01, 0.05), 64), np.linspace(0.02, 0.2, 20)
    target = mf.SampledLaw(load, model.areas(LATTICE, load, height[None])[0])
    assert mf.design(target, LATTICE, model, mf.Limits(0.5)).misfit <= 1e-2


def test_power_laws_of_flat_and_adhesive_caps():
    for exponent, cap in ((0.5, mf.Elastic(mf.Power(4))), (0.8, mf.JKR(9e-6))):
        target, model = mf.PowerLaw(exponent, (0.1, 0.4)), mf.Independent(contact=cap)
        assert mf.design(target, LATTICE, model, mf.Limits(0.3)).misfit <= 2e-3


@pytest.mark.parametrize("seed", range(2))
def test_bands_are_kept_under_the_model(seed):
    law, model = random_law(seed, 8), mf.Interacting()
    for width in (0.005, 0.05):
        low, high = (1.0 - width) * law.rescaled_friction, (1.0 + width) * law.rescaled_friction
        found = mf.design(mf.Band(law.rescaled_load, low, high), LATTICE, model, mf.Limits(0.6))
        area = mf.friction_law(found.surface, model, load=1.36 * law.rescaled_load).area
        assert found.misfit == 0.0
        assert ((area >= low) & (area <= high)).all()


@pytest.mark.nightly
def test_a_design_under_resolved_contacts_is_refined_and_drawn():
    """Light loads that the cells do not resolve are those of order 3, and a note says so."""
    template = mf.Surface.square_lattice(0.12, (2, 3), radius=0.526, material=mf.Material(1.36))
    target = mf.OperatingPoints([0.0067, 0.02], [0.073, 0.173])
    result = mf.design(target, template, mf.BoundaryElements(0.013))
    assert result.misfit <= 1e-4
    assert "the law is that of the model half-space" in said(result.law)


def test_the_nearest_law_of_a_refusal_is_that_of_a_surface():
    """It is met to the goal of the search, which is far below the 1 % that counts as reached."""
    for seed in range(3):
        law, rng = random_law(seed, 20), np.random.default_rng(seed)
        friction = law.rescaled_friction * (1.0 + rng.normal(0.0, 0.05, 20))
        with pytest.raises(mf.Infeasible) as caught:
            mf.design(mf.SampledLaw(law.rescaled_load, friction), LATTICE, limits=mf.Limits(0.6))
        assert mf.design(caught.value.nearest, LATTICE, limits=mf.Limits(0.6)).misfit < 1e-3


def test_no_noisy_law_is_refused_whose_best_surface_is_within_a_percent_of_the_noise():
    for seed in range(20):
        target, true = noisy_law(seed)
        design = mf.design(target, LATTICE, limits=mf.Limits(0.6))
        assert design.misfit <= min(target.curve().misfit(true), design.largest_misfit)


@pytest.mark.parametrize("first", range(0, 60, 12))
def test_targets_of_real_surfaces_are_neither_refused_nor_missed(first):
    """The goal is 1 %. Height errors change a law by more than 0.2 %, which one in twelve may miss."""
    found = {seed: misfit(seed) for seed in range(first, first + 12)}
    assert max(found.values()) < 0.01
    assert sum(each > 2e-3 for each in found.values()) <= 1
