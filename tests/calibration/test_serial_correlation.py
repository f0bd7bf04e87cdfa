"""Correlation of successive errors against dense matrices, and how often correlated errors are noticed."""

import math

import numpy as np
import pytest

from metafem.calibration import Sample, fit_compression
from metafem.calibration.serial_correlation import Succession
from metafem.calibration.verdict import judged_in_order
from validation.scenes.compression_tests import ENERGY, ERRORS, RADII, RADIUS, compression_tests
from validation.scenes.drift import RHO, drifting

TEST = np.repeat(["b", "a", "c"], 20)


@pytest.fixture
def law():
    """Return a fit of two parameters to three tests whose points are given in turn."""
    rng = np.random.default_rng(0)
    x = rng.uniform(0.5, 2.0, 60)
    return Succession(np.tile(["b", "a", "c"], 20), np.column_stack([x, x**2]))


def _dense(law, rho):
    """Return the correlation matrix of the errors, in the order of the points."""
    test = np.asarray(law.test)
    place = np.array([(test[:i] == test[i]).sum() for i in range(len(test))])
    apart = np.abs(place[:, None] - place)
    same = test[:, None] == test
    return np.where(same, rho**apart, 0.0), np.where(same & (apart == 1), 0.5, 0.0)


def test_covariance_and_correlation_are_those_of_dense_matrices(law):
    errors, beside = _dense(law, 0.7)
    x = law.regressor
    inverse = np.linalg.inv(x.T @ x)
    assert law.covariance(0.0) == pytest.approx(inverse)
    assert law.covariance(0.7) == pytest.approx(inverse @ x.T @ errors @ x @ inverse)
    left = np.eye(60) - x @ inverse @ x.T
    expected = np.trace(beside @ left @ errors @ left) / np.trace(left @ errors)
    assert law.of_errors(expected) == pytest.approx(0.7, abs=1e-5)
    residual = left @ np.random.default_rng(1).standard_normal(60)
    assert law.lag_one(residual)[0] == pytest.approx(residual @ beside @ residual / (residual @ residual))
    assert law.leverage == pytest.approx(1.0 - np.diagonal(left))


def test_limits_of_the_correlation(law):
    assert law.lag_one(np.zeros(60)) == (0.0, 1.0)
    assert Succession(["a"] * 2, np.eye(2)).lag_one(np.ones(2)) == (0.0, 1.0)
    three = Succession(["a"] * 3, np.column_stack([[1.0, 2.0, 4.0], [1.0, 4.0, 16.0]]))
    left = np.eye(3) - three.regressor @ three.covariance(0.0) @ three.regressor.T
    assert three.lag_one(left @ np.ones(3)) == (0.0, 1.0)
    assert law.of_errors(-0.5) == 0.0
    assert law.of_errors(1.0) == 0.99


def test_independent_normal_errors_are_noticed_as_often_as_stated():
    rng = np.random.default_rng(2)
    x = np.tile(np.linspace(0.5, 2.0, 20), 3)
    law = Succession(TEST, np.column_stack([x, x**2]))
    left = np.eye(60) - law.regressor @ law.covariance(0.0) @ law.regressor.T
    found = [judged_in_order(left @ rng.standard_normal(60), x, law) for _ in range(1000)]
    for name in ("correlation", "largest"):
        share = np.mean([each[name].probability < 0.1 for each in found])
        assert abs(share - 0.1) < 4.0 * math.sqrt(0.1 * 0.9 / 1000)
    # four tests at 1 %
    assert np.mean([not each.fits for each in found]) < 0.05


def test_drifting_loads_are_noticed_and_widen_the_interval():
    load, area = drifting(np.random.default_rng(3), 5)
    found = fit_compression(load, area, RADIUS, sample=Sample(contacts=5), test=TEST)
    assert found.verdict["correlation"].probability < 0.01
    (note,) = [str(note) for note in found.notes if "successive residuals" in str(note)]
    assert "E* and w: successive residuals of a test are correlated by 0." in note
    assert "times as large as independent ones; those stated include this factor" in note
    measured = (each[0] for each in compression_tests(1, 5, ENERGY, np.random.default_rng(3)))
    steady = fit_compression(*measured, RADIUS, Sample(contacts=5), test=TEST)
    assert steady.verdict.fits
    assert found.root_covariance[0, 0] > 2.0 * steady.root_covariance[0, 0]


def test_the_synthetic_drift_has_the_errors_of_independent_loads():
    rng = np.random.default_rng(6)
    apart = np.array([drifting(rng, 1, noise_only=True)[0] for _ in range(400)]).reshape(-1, len(RADII))
    assert apart.std() == pytest.approx(ERRORS.load, rel=0.1)
    assert np.corrcoef(apart[:, 3], apart[:, 4])[0, 1] == pytest.approx(RHO, abs=0.02)


@pytest.mark.parametrize("robust", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_three_points_have_no_drift(robust, seed):
    load, area = (each[0] for each in compression_tests(1, 5, ENERGY, np.random.default_rng(seed)))
    found = fit_compression(load[4:20:7], area[4:20:7], RADIUS, sample=Sample(contacts=5), robust=robust)
    assert found.verdict["correlation"].probability == 1.0
