"""Agreement of tests against the distribution of chi-square."""

import numpy as np
import pytest

from metafem.calibration.verdict import heterogeneity


def test_tests_with_common_parameters_differ_as_often_as_stated():
    rng = np.random.default_rng(0)
    covariance = np.array([[2.0, -0.8], [-0.8, 1.0]])
    root = np.linalg.cholesky(covariance)
    found = [
        heterogeneity([root @ rng.standard_normal(2) for _ in range(3)], [covariance] * 3)
        for _ in range(1000)
    ]
    assert {each.freedom for each in found} == {4}
    probability = np.array([each.probability for each in found])
    assert abs((probability < 0.3).mean() - 0.3) < 4.0 * np.sqrt(0.3 * 0.7 / 1000)


def test_two_tests_are_as_far_apart_as_their_difference_over_its_deviation():
    found = heterogeneity([np.array([1.0]), np.array([1.5])], [np.eye(1) * 0.01, np.eye(1) * 0.03])
    assert found.chi_square == pytest.approx(0.25 / 0.04)
    assert found.agree
    assert not heterogeneity([np.array([1.0]), np.array([1.9])], [np.eye(1) * 0.01, np.eye(1) * 0.03]).agree


def test_a_parameter_that_one_test_lacks_is_compared_between_the_others():
    lacking = np.array([1.0, np.nan]), np.diag([0.1, np.nan])
    whole = np.array([1.2, 3.0]), np.diag([0.1, 0.1])
    found = heterogeneity([lacking[0], whole[0]], [lacking[1], whole[1]])
    assert (found.freedom, found.chi_square) == (1, pytest.approx(0.04 / 0.2))
