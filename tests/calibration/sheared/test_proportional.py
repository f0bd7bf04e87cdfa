"""Proportional quantities against a general minimiser, closed forms and the noise they are given."""

import numpy as np
import pytest
from scipy.optimize import minimize

from metafem.calibration.sheared.proportional import proportional
from validation.scenes.sheared_contacts import ERRORS, sheared

AREAS = (ERRORS.of_area, ERRORS.of_area, ERRORS.of_friction_force)


def test_constant_errors_of_two_quantities_give_demings_line():
    rng = np.random.default_rng(2)
    x = np.linspace(1.0, 2.0, 9)
    points = np.stack([x, 0.7 * x]) + 0.05 * rng.standard_normal((2, 9))
    constant = [lambda value: np.full_like(value, 0.05)] * 2
    factor, _, _ = proportional(points, constant)
    # the direction of the largest moment of the points about the origin
    moments = points @ points.T
    axis = np.linalg.eigh(moments)[1][:, -1]
    assert factor[0] == pytest.approx(axis[1] / axis[0], rel=1e-10)


def test_the_fit_minimises_the_sum_over_factors_and_values():
    points, _ = sheared(np.random.default_rng(3), tests=1, loads=4)
    points[2, 1] = points[0, 2] = np.nan
    factor, covariance, value = proportional(points, AREAS)
    fitted = np.vstack([value, factor[:, None] * value])
    deviation = np.stack([of(each) for of, each in zip(AREAS, fitted, strict=True)])

    def squares(unknown):
        q, x = np.append(1.0, unknown[:2]), unknown[2:]
        return 0.5 * np.nansum(((points - q[:, None] * x) / deviation) ** 2)

    found = minimize(squares, np.append(factor, value) * 1.01, tol=1e-14, method="BFGS")
    assert factor == pytest.approx(found.x[:2], abs=1e-5)
    # the covariance of all unknowns is the inverse of the curvature
    q = np.append(1.0, factor)
    weight = np.isfinite(points) / deviation**2
    hessian = np.diag(np.append([0.0, 0.0], (weight * q[:, None] ** 2).sum(0)))
    for j in (1, 2):
        hessian[j - 1, j - 1] = (weight[j] * value**2).sum()
        hessian[j - 1, 2:] = hessian[2:, j - 1] = weight[j] * q[j] * value
    assert covariance == pytest.approx(np.linalg.inv(hessian)[:2, :2], rel=1e-9)


def test_a_quantity_that_was_not_measured_leaves_the_fit_of_the_others():
    points, _ = sheared(np.random.default_rng(4))
    alone, square, _ = proportional(points[:2], AREAS[:2])
    some = points.copy()
    some[2, :58] = np.nan
    together, covariance, _ = proportional(some, AREAS)
    assert together[0] == pytest.approx(alone[0], abs=0.05 * square[0, 0] ** 0.5)
    assert covariance[0, 0] == pytest.approx(square[0, 0], rel=0.01)


def test_leading_axes_are_separate_fits():
    points, _ = sheared(np.random.default_rng(5), shape=(2, 3))
    factor, covariance, value = proportional(points, AREAS)
    one = proportional(points[1, 2], AREAS)
    assert factor.shape == (2, 3, 2)
    assert covariance.shape == (2, 3, 2, 2)
    for many, single in zip((factor, covariance, value), one, strict=True):
        assert many[1, 2] == pytest.approx(single, rel=1e-9)
