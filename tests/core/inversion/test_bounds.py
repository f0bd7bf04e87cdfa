"""Bounds that no surface of independent asperities leaves, with one radius and with several."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion.bounds import Bounds, relative_depth
from metafem.inversion.tools import Tools

RADIUS = 0.526
TEMPLATE = mf.Surface.square_lattice(0.12, radius=RADIUS, material=mf.Material(1.36))


def bounds_of(law, count, last, given=None):
    """Bounds of asperities of the given tools, whose caps are those of the law."""
    template = TEMPLATE.replaced(cap=law.cap) if isinstance(law, mf.Elastic) else TEMPLATE
    return Bounds(Tools.of(given, template, law), count, last)


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
    given = None if ratio == 1.0 else [RADIUS, ratio * RADIUS]
    radius = RADIUS * ratio ** rng.uniform(0.0, 1.0, count).round(0)
    load = np.sort(rng.uniform(1e-4, 1.0, 12))
    model, bounds = mf.Independent(contact=law), bounds_of(law, count, load[-1], given)
    found = model.curve_of(height, radius, load)
    carried, area = found.load, found.area
    low, high = bounds.friction(load)
    assert (area >= low * (1.0 - 1e-12)).all()
    assert (area <= high * (1.0 + 1e-12)).all()
    assert (area <= bounds.highest_after(load, area) * (1.0 + 1e-9)).all()
    exponents = np.diff(np.log(area)) / np.diff(np.log(carried))
    assert exponents.min() >= bounds.least_exponent - 1e-9


def test_bounds_of_hertz_contacts_are_the_closed_forms():
    load = np.array([0.01, 0.3])
    low, high = bounds_of(mf.Hertz(), 64, 0.3, [0.2, 0.8]).friction(load)
    single = [math.pi * R * (0.75 * load / math.sqrt(R)) ** (2.0 / 3.0) for R in (0.2, 0.8)]
    np.testing.assert_allclose([low, high], [single[0], 4.0 * single[1]], rtol=1e-13)


@pytest.mark.parametrize("law", LAWS[1:3], ids=repr)
def test_the_examined_bounds_of_a_profile_are_those_of_its_power(law):
    def profile(rho):
        return law.cap.coefficient * RADIUS * (rho / RADIUS) ** law.cap.exponent

    load, friction = np.array([0.1, 0.11, 0.3]), np.array([1.0, 1.2, 3.0])
    named, unnamed = (
        bounds_of(each, 64, 0.3) for each in (law, mf.Elastic(mf.Profile(profile, extent=2.0 * RADIUS)))
    )
    np.testing.assert_allclose(unnamed.friction(load), named.friction(load), rtol=1e-10)
    assert unnamed.least_exponent == pytest.approx(named.least_exponent, rel=1e-8)
    if law.cap.exponent > 2.0:
        after = [each.highest_after(load, friction) for each in (named, unnamed)]
        np.testing.assert_allclose(*after, rtol=1e-9)


def test_nothing_is_claimed_where_nothing_is_proven():
    """The load of a cap with a concave profile is a concave function of the area."""
    sharp = mf.Elastic(mf.Profile(lambda rho: 0.2 * rho**0.9, extent=2.0))
    bounds = bounds_of(sharp, 64, 0.1)
    low, high = bounds.friction(np.array([0.05, 0.1]))
    assert (low == 0.0).all()
    assert np.isinf(high).all()
    assert bounds.least_exponent == 0.0


@pytest.mark.parametrize(("ratio", "n"), [(1.5, 4.0), (100.0, 1.5)])
def test_the_least_exponent_is_that_of_two_kinds_of_contact(ratio, n):
    """With numbers as real weights the bound is attained, and no other pair of depths is below it."""
    k, s = math.sqrt(1.0 / ratio), relative_depth(1.0 / ratio, n)
    least = bounds_of(mf.Elastic(mf.Power(n)), 64, 1.0, [1.0, ratio]).least_exponent

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
