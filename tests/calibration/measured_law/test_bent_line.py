"""Distances of points from two lines that meet, and the least sum of their squares."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize, minimize_scalar

from metafem.calibration.measured_law.bent_line import chi_square, deviations, fitted, least


def one(x, y, sx, sy):
    return np.stack([np.atleast_2d(np.asarray(v, dtype=float)) for v in (x, y, sx, sy)])


def brute(x, y, sx, sy, c, a, m1, m2):
    """The squared distance by minimising over the true load, from many starts."""

    def square(xi):
        f = a + (m1 if xi < c else m2) * (xi - c)
        return ((x - xi) / sx) ** 2 + ((y - f) / sy) ** 2

    values = []
    for low, high in ((x - 8.0, c), (c, x + 8.0)):
        if low < high:
            values.append(minimize_scalar(square, bounds=(low, high), options={"xatol": 1e-10}).fun)
    return min([*values, square(c)])


@settings(max_examples=60, deadline=None)
@given(
    x=st.floats(-2.0, 2.0), y=st.floats(-2.0, 2.0), sx=st.floats(0.1, 1.0), sy=st.floats(0.1, 1.0),
    m1=st.floats(0.0, 4.0), m2=st.floats(0.0, 4.0),
)  # fmt: skip
def test_chi_square_is_the_distance_from_the_nearest_point_of_the_line(x, y, sx, sy, m1, m2):
    found = chi_square(one(x, y, sx, sy), np.array([[0.2, -0.1, m1, m2]]))[0]
    assert found == pytest.approx(brute(x, y, sx, sy, 0.2, -0.1, m1, m2), rel=1e-6, abs=1e-8)


def test_slopes_of_the_deviations_are_their_derivatives():
    rng = np.random.default_rng(1)
    points = one(rng.uniform(-1, 1, 12), rng.uniform(-1, 1, 12), np.full(12, 0.2), np.full(12, 0.3))
    p, step = np.array([[0.1, 0.0, 0.7, 2.0]]), 1e-6
    along_y, _, slopes = deviations(points, p)
    for i in range(4):
        shifted = p.copy()
        shifted[0, i] += step
        change = (deviations(points, shifted)[0] - along_y) / step
        np.testing.assert_allclose(change, slopes[:, :, i], atol=1e-5)


def test_exact_points_give_their_lines_back():
    x = np.linspace(0.01, 0.2, 12)
    y = np.where(x < 0.08, 0.5 + 7.0 * (x - 0.08), 0.5 + 12.0 * (x - 0.08))
    found, (value,) = least(one(x, y, np.full(12, 3e-3), np.full(12, 8e-3)), 31)
    np.testing.assert_allclose(found, [[0.08, 0.5, 7.0, 12.0]], rtol=1e-4)
    assert value < 1e-4


def test_the_least_chi_square_is_that_of_a_general_minimiser():
    rng = np.random.default_rng(3)
    x = np.linspace(0.01, 0.16, 16)
    y = np.where(x < 0.08, 0.5 + 7.0 * (x - 0.08), 0.5 + 12.0 * (x - 0.08))
    points = one(
        np.sort(x + rng.normal(0, 3e-3, 16)),
        y + rng.normal(0, 8e-3, 16),
        np.full(16, 3e-3),
        np.full(16, 8e-3),
    )
    _, (value,) = least(points, 41)
    best = min(
        minimize(
            lambda p: chi_square(points, p[None])[0], [c, 0.5, 7.0, 12.0], method="Nelder-Mead",
            options={"maxiter": 4000, "fatol": 1e-9, "xatol": 1e-9},
        ).fun
        for c in (0.06, 0.08, 0.1)
    )  # fmt: skip
    assert value == pytest.approx(best, abs=1e-3)
    fixed, (of_fixed,) = least(points, 41, left=6.0)
    assert fixed[0, 2] == 6.0
    assert min(of_fixed, *fitted(points, np.array([0.1]))[1]) >= value
