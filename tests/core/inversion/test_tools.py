"""Tools of several radii and caps: gradients, bounds, mixtures, and one tool where it suffices."""

import math

import numpy as np
import pytest
from metafem.inversion.search.asperities import OfExponents, OfRadii
from metafem.inversion.search.mixed_tools import grouped
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.strategies.mixture import Mixture
from metafem.inversion.tools.kit_bounds import least_ratio
from metafem.inversion.tools.radii import Radii

import metafem as mf
from metafem.inversion.density import ExponentialDensity

LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=mf.Material(1.36))
CELL = LATTICE.only(slice(6))
KIT = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4)), mf.Tool(0.6, mf.Power(1.5))]
LIMITS, ELASTIC = mf.Limits(0.3), mf.Independent(mf.Elastic())
COMMON, THREE = mf.Limits(0.12, offset=0.05, height_sd=0.0009), [0.8, 0.2, 0.526]


def assert_gradients(residual, at, columns, step=1e-5):
    """Compare gradients with differences of fourth order."""
    gradient = residual(at)[1]()
    for i in columns:
        e = step * np.eye(len(at))[i]
        first, second = (residual(at + k * e)[0] - residual(at - k * e)[0] for k in (1, 2))
        np.testing.assert_allclose(gradient[:, i], (8.0 * first - second) / (12.0 * step), atol=1e-7)


def test_gradients_by_radii_and_exponents_are_those_of_differences():
    target, rng = TargetLaw.fixed(np.array([0.05, 0.2]), np.ones(2)), np.random.default_rng(3)
    height, radius, exponent = rng.uniform(0.1, 0.2, 9), rng.uniform(0.2, 0.8, 9), rng.uniform(1.3, 5.0, 9)
    space = OfRadii(1.0, 9, radii=Radii(0.1, 2.0, None), depth=0.05)
    for cap in (mf.Hertz(), mf.Elastic(mf.Power(4)), mf.Elastic(mf.Sphere())):
        residual = space.residual(mf.Independent(contact=cap), target)
        assert_gradients(residual, space.joined(height, radius), range(9, 18))
    space = OfExponents(1.0, 9, range=mf.PowerRange(1.1, 7.0), radius=0.526, depth=0.05)
    assert_gradients(space.residual(ELASTIC, target), space.joined(height, exponent), range(18))


def test_no_random_contacts_have_a_smaller_local_exponent_than_the_bound():
    rng, least = np.random.default_rng(0), least_ratio(8)
    for _ in range(5000):
        count = int(rng.integers(1, 9))
        a, n = np.exp(rng.uniform(-9.0, 0.0, count)), rng.uniform(1.2, 6.0, count)
        depth = np.exp(rng.uniform(-9.0, 0.0, count))  # any size of the caps, so that d is free
        load, stiffness = 2.0 * n / (n + 1.0) * a * depth, 2.0 * a
        area, growth = a * a, 2.0 * a * a / (n * depth)
        exponent = load.sum() / stiffness.sum() * growth.sum() / area.sum()
        assert exponent >= 2.0 / 7.0 * least * (1.0 - 1e-12)


def test_the_least_ratio_is_that_of_random_sizes():
    a = np.exp(np.random.default_rng(1).uniform(-8.0, 0.0, (300000, 3)))
    ratio = (a**1.5).sum(axis=1) ** 2 / (a.sum(axis=1) * (a**2).sum(axis=1))
    assert least_ratio(3) <= ratio.min() <= least_ratio(3) * 1.001


def test_groups_of_exponents_are_means_of_neighbours():
    found = grouped(np.array([1.5, 1.6, 4.0, 4.1, 4.2]), 2)
    np.testing.assert_allclose(np.unique(found), [math.sqrt(2.4), (4.0 * 4.1 * 4.2) ** (1 / 3)])


def test_a_mixture_has_the_law_of_its_mean_radius():
    for cap in [mf.Hertz(), mf.Elastic(mf.Power(4))]:
        mixture, density = Mixture((0.2, 0.8), (3000, 1000), cap), ExponentialDensity(0.03, 0.12)
        height = np.sort(-0.03 * np.log1p(-np.linspace(0.0, -np.expm1(-4.0), 4001)[1:]))[::-1]
        load, delta = np.linspace(1.0, 10.0, 5), np.linspace(0.12, 0.0, 2000)
        area = mf.Independent(contact=mixture.law).curves(height, mixture.mixed(), load)[2][0]
        loads, areas = (f(delta, *mixture.asperities) for f in (density.rescaled_load, density.area))
        # the ends of 4,000 intervals, not their middles
        np.testing.assert_allclose(area, np.interp(load, loads, areas), rtol=2e-3)


def test_a_mixture_reaches_between_the_tools(template):
    """10 times height_sd = 3 um leaves a gap between the slopes of the two tools."""
    limits, per_slope = mf.Limits(0.12, offset=0.1, height_sd=0.003), 0.358 * 0.85 / 1.36
    low, high = (
        np.array(mf.achievable_friction_coefficients(template, limits, [radius])) / per_slope
        for radius in (0.2, 1.6)
    )
    target = mf.LinearLaw(0.5 * (low[1] + high[0]))
    result = mf.design(target, template, limits=limits, tools=[0.2, 1.6])
    assert result.parameters["used_radii"].tolist() == [0.2, 1.6]
    assert result.status is mf.DesignStatus.APPROXIMATE
    assert not any("height_sd" in note.text for note in result.notes)
    np.testing.assert_allclose(
        result.parameters["reachable_coefficients"] / per_slope, [low[0], high[1]], rtol=1e-9
    )
    # without height_sd no largest slope is known, and one number is no range
    result = mf.design(target, template, limits=mf.Limits(0.12, offset=0.1), tools=[0.2, 1.6])
    assert "reachable_coefficients" not in result.parameters
    assert result.parameters["lowest_coefficients"].shape == (2,)


def test_radii_of_a_range_are_those_of_its_steps(template):
    for step in (0.07, 0.6):
        radii = mf.RadiusRange(0.2, 0.8, step)
        result = mf.design(mf.LinearLaw(4.5), template, limits=LIMITS, tools=radii)
        steps = {0.2, 0.8, *(round(i * step, 12) for i in range(12) if 0.2 < i * step < 0.8)}
        assert {*result.surface.radius, *result.parameters["tried_radii"]} <= steps
        assert result.tools == radii
        tried = Radii.given(mf.RadiusRange(0.207, 0.803)).tried
        assert (tried[0], tried[-1]) == (0.207, 0.803)


def test_levels_of_different_radii_meet_points():
    """With three asperities, one radius cannot: the second point needs a large one after small ones."""
    three = mf.Surface.square_lattice(0.3, (1, 4), radius=1.0, material=mf.Material(1.0))
    built = three.replaced(height=[0.3, 0.3, 0.27, 0.25], radius=[0.1, 0.1, 2.0, 2.0])
    law = mf.friction_law(built, separation=[0.265, 0.2])
    target = mf.OperatingPoints(law.rescaled_load, law.rescaled_friction)
    for radius in (0.1, 2.0):
        with pytest.raises(mf.Infeasible):
            mf.design(target, three, limits=LIMITS, tools=[radius])
    result = mf.design(target, three, limits=LIMITS, tools=[0.1, 2.0])
    assert result.misfit <= 1e-9
    assert set(result.surface.radius) == {0.1, 2.0}


def test_one_tool_is_used_where_it_reaches_the_target():
    """A list of tools is one of radii where their caps are those of the template."""
    plain = mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS, rng=1)
    one = mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS, rng=1, tools=[0.526])
    assert (plain.tools, one.tools, one.surface) == (None, (0.526,), plain.surface)
    for given in ([0.2, 0.8], [mf.Tool(0.8), mf.Tool(0.2)]):
        mixed = mf.design(mf.PowerLaw(1.2, (0.1, 0.4)), LATTICE, limits=LIMITS, tools=given)
        assert mixed.tools == (0.2, 0.8)
        assert len(set(mixed.surface.radius)) == 1
    kit = mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS, tools=KIT)
    assert sorted(kit.parameters["tool_counts"].tolist()) == [0, 0, kit.surface.count]


def test_points_below_those_of_one_radius_are_met_by_two():
    """F grows by less than P^(2/3)."""
    target = mf.OperatingPoints([0.144, 0.336], [0.84, 0.84 * (0.336 / 0.144) ** 0.65])
    for radius in (0.2, 0.8):
        with pytest.raises(mf.Infeasible, match="point 2"):
            mf.design(target, LATTICE, limits=LIMITS, tools=[radius])
    assert mf.design(target, LATTICE, limits=LIMITS, tools=[0.2, 0.8]).misfit <= 1e-9


def test_reach_of_each_tool_is_told(template):
    found = mf.design(mf.LinearLaw(7.0), template, limits=COMMON, tools=THREE).parameters
    assert found["tried_radii"].tolist() == sorted(THREE)
    for i, radius in enumerate(found["tried_radii"]):
        bounds = mf.achievable_friction_coefficients(template.replaced(radius=radius), COMMON)
        assert (found["lowest_coefficients"][i], found["highest_coefficients"][i]) == bounds
