"""Height densities against quadrature in many digits, and the inversion of their slope."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from metafem import reference as printed
from metafem.inversion.density import (
    ExponentialDensity,
    middles,
    scale_from_slope,
    slope_excess,
    uniform_slope,
)

TOP, RADIUS = 0.12, 0.526


def exact_excess(x):
    """m(x)/m(0) - 1 in fifty digits."""
    with mpmath.workdps(50):
        x = mpmath.mpf(x)
        k = mpmath.gammainc(mpmath.mpf(3) / 2, 0, x, regularized=True)
        return mpmath.sqrt(x) * (1 - mpmath.exp(-x)) / (mpmath.gamma(mpmath.mpf(5) / 2) * k) - 1


def exact_moment(density, power, delta):
    """Mean of (h - delta)^power in thirty digits, piece by piece."""
    with mpmath.workdps(30):
        total = mpmath.mpf(0)
        for start, end, alpha in density.pieces:
            low = max(start, delta)
            if end > low:
                # h = delta + t^2 removes the root at the lower end
                ends = [mpmath.sqrt(mpmath.mpf(low) - delta), mpmath.sqrt(mpmath.mpf(end) - delta)]
                total += alpha * mpmath.quad(
                    lambda t: 2 * t ** (2 * power + 1) * mpmath.exp(-(delta + t * t) / density.scale), ends
                )
        return total


@given(st.floats(-12.0, 3.0).map(lambda e: 10.0**e))
def test_slope_excess_keeps_its_digits(x):
    # a few units in the last place: 5e-14 near x = 1, where the direct form loses one and a half digits
    assert float(slope_excess(x)) == pytest.approx(float(exact_excess(x)), rel=1e-13)


def test_slope_inversion_recovers_the_scale():
    for x in np.geomspace(1e-3, 400.0, 9):
        with mpmath.workdps(30):
            slope = float(mpmath.mpf(uniform_slope(RADIUS, TOP)) * (1 + exact_excess(x)))
        assert TOP / scale_from_slope(slope, RADIUS, TOP) == pytest.approx(x, rel=1e-10)


def test_moments_agree_with_quadrature():
    for density in [
        ExponentialDensity(TOP / 1e-3, TOP),
        ExponentialDensity(0.04, TOP),
        ExponentialDensity(TOP / 400.0, TOP),
        ExponentialDensity(0.03568, TOP, 0.0153, 0.149),
        ExponentialDensity(0.02, TOP, 0.05, 3.0),
    ]:
        for power in [0.5, 1.0, 1.5]:
            for delta in (0.0, 0.3 * TOP, 0.99 * TOP):
                exact = float(exact_moment(density, power, delta))
                assert float(density.moment(power, delta)) == pytest.approx(exact, rel=1e-12)


@given(st.floats(0.005, 1.0), st.floats(0.02, 0.9), st.floats(0.05, 1.0))
def test_two_branches_have_unit_mass_and_the_printed_slopes(scale, share, weight):
    density = ExponentialDensity(scale, TOP, share * TOP, weight)
    assert float(density.mass(0.0, TOP)) == pytest.approx(1.0, rel=1e-12)
    form = printed.second_slope(scale, RADIUS, TOP, share * TOP, weight)
    # the printed form loses digits where its k cancels: x^(3/2) of a unit in the last place
    assert density.asymptotic_slopes(RADIUS)[1] == pytest.approx(form, rel=1e-9)
    first = printed.slope(scale, RADIUS, TOP)
    assert density.asymptotic_slopes(RADIUS)[0] == pytest.approx(first, rel=1e-9)
    load = printed.crossover_load(scale, RADIUS, TOP, share * TOP, weight, 64)
    lost = (scale / (TOP * (1.0 - share))) ** 2.5 * np.finfo(float).eps
    assert density.crossover_load(64, RADIUS) == pytest.approx(load, rel=1e-9 + 100 * lost)


def test_intercept_vanishes_at_both_ends():
    assert ExponentialDensity(TOP / 700.0, TOP).intercept(64, RADIUS) < 1e-12
    thin = ExponentialDensity(TOP * 1e9, TOP)
    # lambda Gamma(x) tends to h_m/x * x/10 = h_m/10
    assert thin.intercept(64, RADIUS) == pytest.approx(math.pi * 64 * RADIUS * TOP / 10.0, rel=1e-8)


@given(st.floats(1e-3, 10.0), st.integers(2, 80))
def test_heights_are_the_middles_of_equal_masses(scale, parts):
    found = middles(ExponentialDensity(scale, TOP), 0.02, TOP, parts)
    ends = [TOP]
    for middle in found:
        ends.append(2.0 * middle - ends[-1])
    masses = ExponentialDensity(scale, TOP).mass(ends[1:], ends[:-1])
    np.testing.assert_allclose(masses, masses.mean(), rtol=1e-8)  # differences of close heights
