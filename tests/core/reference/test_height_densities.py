"""The printed equations of the height densities, and the limits of their slope."""

import pytest

from metafem import reference as printed

RADIUS, TOP = 0.526, 0.120


def test_slope_tends_to_its_limits():
    assert printed.slope(1e4 * TOP, RADIUS, TOP) == pytest.approx(
        printed.smallest_slope(RADIUS, TOP), rel=2e-5
    )
    # x -> infinity: sqrt(pi R/lambda), whose relative error is of order sqrt(x) exp(-x)
    assert printed.slope(TOP / 40.0, RADIUS, TOP) == pytest.approx(
        (3.141592653589793 * RADIUS * 40.0 / TOP) ** 0.5, rel=1e-12
    )


def test_series_is_the_slope_up_to_the_third_order():
    for x in [0.01, 0.02]:
        excess = printed.slope(TOP / x, RADIUS, TOP) / printed.smallest_slope(RADIUS, TOP) - 1.0
        assert excess == pytest.approx(printed.slope_series(x), abs=0.01 * x**3 + 1e-9)
