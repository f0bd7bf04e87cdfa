"""The smallest standard errors of a cap agree with a dense computation."""

import numpy as np
import pytest

from validation.scenes.cap_bound import smallest_errors
from validation.scenes.height_maps import Roughness


@pytest.mark.parametrize("common", [False, True])
def test_the_rings_agree_with_generalised_least_squares_on_a_grid(common):
    height, radius, rough, noise, pixel = 0.05, 0.526, Roughness(1.2e-3, 0.06), 3e-3, 0.01
    reach = np.sqrt(height * (2.0 * radius - height))
    axis = np.arange(-reach, reach, pixel) + 0.5 * pixel
    x, y = (each.ravel() for each in np.meshgrid(axis, axis))
    on = np.hypot(x, y) < reach
    x, y = x[on], y[on]
    root = np.sqrt(radius**2 - x**2 - y**2)
    columns = [np.ones(len(x)), x / root, y / root] + ([] if common else [radius / root - 1.0])
    matrix = np.column_stack(columns)
    square = (x - x[:, None]) ** 2 + (y - y[:, None]) ** 2
    covariance = rough.sd**2 * np.exp(-square / rough.length**2) + noise**2 * np.eye(len(x))
    errors = np.sqrt(np.diagonal(np.linalg.inv(matrix.T @ np.linalg.solve(covariance, matrix))))
    found = smallest_errors(height, radius, rough, noise, pixel, common_radius=common)
    # the pixels of the edge are whole or absent: a relative error of the area of about pixel / reach, 5 %
    assert found[0] == pytest.approx(errors[0], rel=0.04)
    assert found[2] == pytest.approx(errors[1], rel=0.08)
    if not common:
        assert found[1] == pytest.approx(errors[3], rel=0.12)
