"""Bounds that no surface of independent asperities leaves, with one radius and with several."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from metafem.inversion.tools.radii import Radii

import metafem as mf
from metafem.inversion.bounds import Bounds, relative_depth

RADIUS = 0.526


LAWS = [
    mf.Hertz(),
    mf.Elastic(mf.Power(1.5)),
    mf.Elastic(mf.Power(4)),
    mf.Elastic(mf.Power(8, 0.2)),
    mf.Elastic(mf.Sphere()),
]


@pytest.mark.parametrize("law", [LAWS[0], LAWS[2], LAWS[4]], ids=repr)
@settings(max_examples=20)
@given(seed=st.integers(0, 10**6), ratio=st.sampled_from([1.0, 1.5, 4.0, 30.0]))
def test_no_surface_leaves_the_bounds(law, seed, ratio):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 40))
    height = rng.exponential(rng.uniform(0.001, 0.1), count)
    radii = Radii.of(RADIUS) if ratio == 1.0 else Radii.given(mf.RadiusRange(RADIUS, ratio * RADIUS))
    radius = RADIUS * ratio ** rng.uniform(0.0, 1.0, count).round(int(rng.integers(0, 3)))
    load = np.sort(rng.uniform(1e-4, 1.0, 12))
    model, bounds = mf.Independent(contact=law), Bounds(law, radii, count, load[-1])
    _, carried, area, _ = model.curves(height, radius, load)
    low, high = bounds.friction(load)
    assert (area[0] >= low * (1.0 - 1e-12)).all()
    assert (area[0] <= high * (1.0 + 1e-12)).all()
    assert (area[0] <= bounds.highest_after(load, area[0]) * (1.0 + 1e-9)).all()
    exponents = np.diff(np.log(area[0])) / np.diff(np.log(carried[0]))
    assert exponents.min() >= bounds.least_exponent - 1e-9
    assert math.log(area[0, -1] / area[0, 0]) / math.log(load[-1] / load[0]) <= bounds.largest_exponent(
        (load[0], load[-1])
    ) * (1.0 + 1e-12)
    step = 1e-7
    near = model.curves(height, radius, load[5] * np.array([1.0, 1.0 + step]))[2][0]
    flattest = bounds.least_exponent * area[0, 5] / load[5]
    slope = float(np.diff(near)[0]) / (load[5] * step)
    # a difference of first order
    assert flattest * (1.0 - 1e-5) <= slope <= bounds.steepest(load[5], area[0, 5]) * (1.0 + 1e-5)


def test_bounds_of_hertz_contacts_are_the_closed_forms():
    load, radii = np.array([0.01, 0.3]), Radii.given([0.2, 0.8])
    low, high = Bounds(mf.Hertz(), radii, 64, 0.3).friction(load)
    single = [math.pi * R * (0.75 * load / math.sqrt(R)) ** (2.0 / 3.0) for R in (0.2, 0.8)]
    np.testing.assert_allclose([low, high], [single[0], 4.0 * single[1]], rtol=1e-13)
    bounds = Bounds(mf.Hertz(), Radii.of(RADIUS), 64, 0.3)
    # N equal contacts of the largest radius with this sum of R d carry the load
    steepest = 0.5 * math.pi * 64 * RADIUS**2 * 0.75 * 0.1 / (1.1 / math.pi) ** 2
    assert bounds.steepest(0.1, 1.1) == pytest.approx(steepest, rel=1e-12)
    factor = math.pi * RADIUS * (0.75 / math.sqrt(RADIUS)) ** (2.0 / 3.0)
    assert bounds.start_of_line(7.0) == pytest.approx((factor / 7.0) ** 3, rel=1e-12)
    assert bounds.end_of_line(7.0, 0.0) == pytest.approx(128.0 / 3.0 * (factor / 7.0) ** 3, rel=1e-12)
    assert bounds.tangent_load(7.0) == pytest.approx((2.0 / 3.0 * factor / 7.0) ** 3, rel=1e-12)


def test_a_line_ends_where_it_meets_equal_contacts():
    for intercept in [-0.1, 0.1]:
        for law in [mf.Elastic(mf.Power(4)), mf.Elastic(mf.Sphere())]:
            bounds = Bounds(law, Radii.of(RADIUS), 64, 1.0)
            end = bounds.end_of_line(9.0, intercept)
            highest = float(bounds.region(np.array([end]))[1][0])
            assert 9.0 * end + intercept == pytest.approx(highest, rel=1e-9)


@pytest.mark.parametrize("law", LAWS[1:3], ids=repr)
def test_the_examined_bounds_of_a_profile_are_those_of_its_power(law):
    def profile(rho):
        return law.cap.coefficient * RADIUS * (rho / RADIUS) ** law.cap.exponent

    radii, load, friction = Radii.of(RADIUS), np.array([0.1, 0.11, 0.3]), np.array([1.0, 1.2, 3.0])
    named, unnamed = (
        Bounds(each, radii, 64, 0.3) for each in (law, mf.Elastic(mf.Profile(profile, extent=2.0 * RADIUS)))
    )
    np.testing.assert_allclose(unnamed.friction(load), named.friction(load), rtol=1e-10)
    assert unnamed.least_exponent == pytest.approx(named.least_exponent, rel=1e-8)
    if law.cap.exponent > 2.0:
        after = [each.highest_after(load, friction) for each in (named, unnamed)]
        np.testing.assert_allclose(*after, rtol=1e-9)


def test_nothing_is_claimed_where_nothing_is_proven():
    """The load of a cap with a concave profile is a concave function of the area."""
    sharp = mf.Elastic(mf.Profile(lambda rho: 0.2 * rho**0.9, extent=2.0))
    bounds = Bounds(sharp, Radii.of(RADIUS), 64, 0.1)
    low, high = bounds.friction(np.array([0.05, 0.1]))
    assert (low == 0.0).all()
    assert np.isinf(high).all()
    assert bounds.least_exponent == 0.0
    assert math.isinf(bounds.largest_exponent((0.05, 0.1)))


@pytest.mark.parametrize(("ratio", "n"), [(1.5, 4.0), (100.0, 1.5)])
def test_the_least_exponent_is_that_of_two_kinds_of_contact(ratio, n):
    """With numbers as real weights the bound is attained, and no other pair of depths is below it."""
    radii = Radii.given(mf.RadiusRange(1.0, ratio))
    k, s = math.sqrt(1.0 / ratio), relative_depth(radii, n)
    least = Bounds(mf.Elastic(mf.Power(n)), radii, 64, 1.0).least_exponent

    def exponent(small, relative):
        R, number = np.array([ratio, 1.0]), np.array([1.0, small])
        a = R * np.array([1.0, relative])
        grown = number @ (R ** (n - 1.0) * a ** (2.0 - n)) * (number @ (R ** (1.0 - n) * a ** (n + 1.0)))
        grown *= 2.0 / (n + 1.0)
        return grown / ((number @ a**2) * (number @ a))

    best = exponent(1.0 / (k * s) ** 3, s * s)
    assert best == pytest.approx(least, rel=1e-12)
    shares = np.geomspace(0.01, 100.0, 81)
    assert best <= min(exponent(a / (k * s) ** 3, b * s * s) for a in shares for b in shares) * (1.0 + 1e-12)
