"""The linear update against dense formulas, and open contacts against truncated normal distributions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from metafem.calibration.diagnosis.linearised import Linear
from metafem.calibration.diagnosis.update import update

NONE = np.zeros(0)


def gaussian(matrix: np.ndarray, data: np.ndarray, sd: np.ndarray):
    """Return the linear observations data = matrix z with Gaussian errors."""

    def linear(z: np.ndarray, covariance: np.ndarray) -> Linear:
        nothing = np.zeros((0, len(z)))
        return Linear((data - matrix @ z) / sd, matrix / sd[:, None], sd, NONE, nothing, NONE)

    return linear


def truncated(gradient: np.ndarray, offset: np.ndarray):
    """Return the observations that offset + gradient z is at most 0."""

    def linear(z: np.ndarray, covariance: np.ndarray) -> Linear:
        return Linear(
            NONE, np.zeros((0, len(z))), NONE, offset + gradient @ z, gradient, np.zeros(len(offset))
        )

    return linear


def test_linear_observations_give_the_dense_gaussian_formula():
    rng = np.random.default_rng(0)
    matrix, sd = rng.standard_normal((12, 5)), rng.uniform(0.5, 2.0, 12)
    data = rng.standard_normal(12)
    found = update(gaussian(matrix, data, sd), 5)
    of_data = np.diag(sd**2) + matrix @ matrix.T
    gain = matrix.T @ np.linalg.inv(of_data)
    np.testing.assert_allclose(found.mean, gain @ data, rtol=1e-10)
    np.testing.assert_allclose(found.covariance, np.eye(5) - gain @ matrix, atol=1e-12)
    evidence = stats.multivariate_normal(np.zeros(12), of_data).logpdf(data)
    assert found.log_evidence == pytest.approx(evidence, rel=1e-10)
    assert found.change < 1e-6


def test_the_true_loads_as_unknowns_are_the_effective_covariance():
    # y = s + c t with a measured load t of the error tau: z = (s, error of t) is y with sd^2 + (c tau)^2
    c, tau, sd = np.array([2.0, 3.0]), np.array([0.5, 0.7]), np.array([0.3, 0.4])
    matrix = np.column_stack([np.ones(2), np.diag(c * tau)])
    data = np.array([0.8, -0.4])
    found = update(gaussian(matrix, data, sd), 3)
    effective = update(gaussian(np.ones((2, 1)), data, np.hypot(sd, c * tau)), 1)
    assert found.mean[0] == pytest.approx(effective.mean[0], rel=1e-12)
    assert found.covariance[0, 0] == pytest.approx(effective.covariance[0, 0], rel=1e-12)
    assert found.log_evidence == pytest.approx(effective.log_evidence, rel=1e-12)


@pytest.mark.parametrize("offset", [-3.0, 0.0, 1.0, 20.0])
def test_one_open_contact_is_a_truncated_normal_distribution(offset):
    found = update(truncated(np.array([[1.0]]), np.array([offset])), 1)
    exact = stats.truncnorm(-math.inf, -offset)
    assert found.mean[0] == pytest.approx(exact.mean(), rel=1e-4, abs=2e-5)
    assert found.covariance[0, 0] == pytest.approx(exact.var(), rel=1e-3)
    assert found.log_evidence == pytest.approx(stats.norm.logcdf(-offset), rel=1e-4, abs=1e-4)


def test_several_open_contacts_are_close_to_their_exact_moments():
    gradient, offset = np.array([[1.0, 0.0], [0.8, 0.6], [-0.3, 0.9]]), np.array([0.5, -0.2, 0.3])
    found = update(truncated(gradient, offset), 2)
    draws = np.random.default_rng(1).standard_normal((400_000, 2))
    kept = draws[(draws @ gradient.T + offset <= 0.0).all(axis=1)]
    sd = kept.std(axis=0)
    np.testing.assert_allclose(found.mean, kept.mean(axis=0), atol=0.03 * sd.max())
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), sd, rtol=0.03)
    assert found.log_evidence == pytest.approx(math.log(len(kept) / len(draws)), abs=0.03)
