"""Estimated Sobol indices, means and deviations against closed forms."""

import numpy as np
import pytest
from scipy.special import ndtri

from metafem.studies.sampling.sobol_indices import exchanged, plan, sobol_indices

GROUPS = [[0], [1], [2]]

# Ishigami and Homma (1990), doi:10.1109/ISUMA.1990.151285, a = 7 and b = 0.1: variances of the effects of x1,
# of x2, and of x1 and x3 together.
ALONE_1, ALONE_2, TOGETHER = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0, 0.08 * np.pi**8 / 225.0
VARIANCE = ALONE_1 + ALONE_2 + TOGETHER

# Coefficients of a linear law of Gaussian inputs.
LINEAR = np.array([3.0, 1.0, 0.3])
SHARE = LINEAR**2 / (LINEAR @ LINEAR)

# Mean, deviation, first-order and total indices; columns: Ishigami, linear.
EXACT = (
    np.array([3.5, 0.0]),
    np.sqrt([VARIANCE, LINEAR @ LINEAR]),
    np.transpose([np.array([ALONE_1, ALONE_2, 0.0]) / VARIANCE, SHARE]),
    np.transpose([np.array([ALONE_1 + TOGETHER, ALONE_2, TOGETHER]) / VARIANCE, SHARE]),
)


def both(unit):
    """Return the Ishigami function and the linear law, (..., 2)."""
    x, y, z = np.moveaxis(np.pi * (2.0 * unit - 1.0), -1, 0)
    ishigami = np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)
    return np.stack([ishigami, ndtri(unit) @ LINEAR], axis=-1)


def test_estimates_lie_within_their_errors():
    found = sobol_indices(both, GROUPS, 60_000, 0)
    for estimate, exact in zip(found, EXACT, strict=True):
        assert estimate.value.shape == exact.shape
        # four standard errors: 16 numbers fail together with a probability of 1e-2 (Student, 15 degrees)
        assert (np.abs(estimate.value - exact) <= 4.0 * estimate.error + 1e-12).all()
        assert (estimate.error[..., 1] <= 2e-3).all()


@pytest.mark.slow
def test_intervals_cover_the_exact_values_at_their_level():
    inside = [
        np.concatenate(
            [
                (np.abs(estimate.value - exact) <= estimate.error).ravel()
                for estimate, exact in zip(found, EXACT, strict=True)
            ]
        )
        for seed in range(2000)
        for found in [sobol_indices(both, GROUPS, 4_000, seed)]
    ]
    coverage = np.mean(inside, axis=0)
    # of 2,000 repetitions at 68.3 % the standard error is 1 %
    assert ((coverage >= 0.64) & (coverage <= 0.72)).all(), coverage


def test_a_function_of_one_group_has_exact_indices():
    found = sobol_indices(lambda x: np.exp(x[..., :2].sum(axis=-1, keepdims=True)), [[0, 1], [2]], 100,
                          1)  # fmt: skip
    for estimate in (found.first_order, found.total):
        np.testing.assert_allclose(estimate.value, [[1.0], [0.0]], atol=1e-13)
        np.testing.assert_allclose(estimate.error, 0.0, atol=1e-13)


def test_indices_of_a_constant_are_zero():
    found = sobol_indices(lambda x: np.ones((*x.shape[:-1], 1)), [[0], [1]], 100, 1)
    assert found.mean.value == 1.0
    for estimate in found[1:]:
        assert not np.any(estimate.value)
        assert not np.any(estimate.error)


def test_inputs_of_a_group_are_exchanged_together():
    points = exchanged(0, 0, [[0, 2], [1]], 8)
    a, b = points[:2]
    np.testing.assert_array_equal(points[2], np.column_stack([b[:, 0], a[:, 1], b[:, 2]]))
    np.testing.assert_array_equal(points[5], np.column_stack([b[:, 0], a[:, 1], b[:, 2]]))
    assert points.min() > 0.0
    assert points.max() < 1.0


def test_many_draws_are_many_batches():
    many = plan(10**7, 6)
    assert many.points == 1024
    assert 10**7 <= many.draws == 14 * many.points * many.batches < 1.01 * 10**7
