"""Agreement of tests against the distribution of chi-square."""

import numpy as np
import pytest

from metafem.calibration.verdict import SingleTest, heterogeneity


def compared(tests):
    return heterogeneity(
        [SingleTest(str(i), 20, np.array(value), np.array(matrix)) for i, (value, matrix) in enumerate(tests)]
    )


def test_tests_with_common_parameters_differ_as_often_as_stated():
    rng = np.random.default_rng(0)
    covariance = np.array([[2.0, -0.8], [-0.8, 1.0]])
    root = np.linalg.cholesky(covariance)
    found = [compared([(root @ rng.standard_normal(2), covariance) for _ in range(3)]) for _ in range(1000)]
    assert {each.freedom for each in found} == {4}
    probability = np.array([each.probability for each in found])
    assert abs((probability < 0.3).mean() - 0.3) < 4.0 * np.sqrt(0.3 * 0.7 / 1000)


def test_two_tests_are_as_far_apart_as_their_difference_over_its_deviation():
    found = compared([([1.0], [[0.01]]), ([1.5], [[0.03]])])
    assert found.chi_square == pytest.approx(0.25 / 0.04)
    assert found.agree
    assert not compared([([1.0], [[0.01]]), ([1.9], [[0.03]])]).agree


def test_a_parameter_that_one_test_lacks_is_compared_between_the_others():
    lacking = [1.0, np.nan], np.diag([0.1, np.nan])
    found = compared([lacking, ([1.2, 3.0], np.diag([0.1, 0.1]))])
    assert (found.freedom, found.chi_square) == (1, pytest.approx(0.04 / 0.2))
