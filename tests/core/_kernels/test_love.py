"""The displacement of loaded square cells against Johnson, equation 3.25."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from metafem._kernels import love


def exact(x, y):
    """Johnson, equation 3.25, in 60 digits: the second difference of an antiderivative of 1/r."""
    with mpmath.workdps(60):
        half = mpmath.mpf(1) / 2

        def antiderivative(u, v):
            first = u * mpmath.asinh(v / abs(u)) if u != 0 else mpmath.mpf(0)
            return first + (v * mpmath.asinh(u / abs(v)) if v != 0 else mpmath.mpf(0))

        x1, x2, y1, y2 = (
            mpmath.mpf(x) - half,
            mpmath.mpf(x) + half,
            mpmath.mpf(y) - half,
            mpmath.mpf(y) + half,
        )
        total = (
            antiderivative(x2, y2) - antiderivative(x1, y2) - antiderivative(x2, y1) + antiderivative(x1, y1)
        )
        return float(total / mpmath.pi)


POINTS = [
    (0.0, 0.0),
    (0.5, 0.5),
    (0.5, -0.2),
    (1e-20, 1e-9),
    (0.49999999, 0.5),
    (1.0, 0.0),
    (3.0, 2.0),
    (8.0, 0.0),
    (8.0, 8.0),
    (9.0, 0.0),
    (9.0, 9.0),
    (1000.0, 4.0),
    (0.5, 1e5),
]


def test_displacement_is_loves_at_corners_edges_and_far_away():
    for x, y in POINTS:
        assert love.displacement(x, y) == pytest.approx(exact(x, y), rel=1e-13)


@settings(max_examples=20)
@given(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
def test_displacement_is_loves_anywhere(x, y):
    assert love.displacement(x, y) == pytest.approx(exact(x, y), rel=1e-13)


def test_the_loaded_cell_has_the_closed_form():
    # the middle of a square: 4 ln(1 + sqrt 2) / pi per side
    assert love.displacement(0.0, 0.0) == pytest.approx(
        4.0 * math.log(1.0 + math.sqrt(2.0)) / math.pi, rel=1e-15
    )


def test_table_holds_whole_cell_distances():
    table = love.table(4, 12)
    plain = np.array([[love.displacement(float(i), float(j)) for j in range(12)] for i in range(4)])
    np.testing.assert_allclose(table, plain, rtol=1e-14)
