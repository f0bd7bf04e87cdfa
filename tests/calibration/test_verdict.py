"""Chi-square and runs of residuals against their distributions."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, groupby

import numpy as np
import pytest

from metafem.calibration.serial_correlation import Succession
from metafem.calibration.verdict import SignificanceTest, SingleTest, heterogeneity, judged, judged_in_order


@pytest.mark.parametrize(("count", "positive"), [(6, 3), (9, 4), (10, 2)])
def test_the_probability_of_runs_is_that_of_all_orders_of_the_signs(count, positive):
    orders = [np.isin(np.arange(count), chosen) for chosen in combinations(range(count), positive)]
    runs = np.array([len(list(groupby(signs))) for signs in orders])
    for signs, most in zip(orders, runs, strict=True):
        found = judged(np.where(signs, 1.0, -1.0), 0)["runs"].probability
        assert found == pytest.approx(np.mean(runs <= most), rel=1e-12)


def test_correct_laws_are_rejected_as_often_as_stated():
    rng = np.random.default_rng(1)
    verdicts = [judged(rng.standard_normal(30), 0) for _ in range(2000)]
    probabilities = np.array([verdict["chi_square"].probability for verdict in verdicts])
    # the binomial standard deviation of a share of 2000
    assert abs((probabilities < 0.2).mean() - 0.2) < 4.0 * np.sqrt(0.2 * 0.8 / 2000)
    assert np.mean([not verdict.fits for verdict in verdicts]) < 0.03  # two tests at 1 %


def test_residuals_of_one_sign_are_no_fit_and_one_degree_and_one_run_are_singular():
    assert not judged(np.full(12, 0.9), 1).fits
    assert "does not fit" in str(judged(np.full(12, 0.9), 1))
    assert "with 1 degree of freedom" in str(judged(np.array([0.4, 0.2]), 1))
    assert "1 run of residuals" in str(judged(np.array([0.4, 0.2]), 1))


def test_the_outlier_is_the_point_whose_own_error_is_exceeded_most():
    law = Succession(["a"] * 4, np.array([[1.0], [1.0], [1.0], [6.0]]))  # leverage 36/39 of the last
    verdict = judged_in_order(np.array([2.0, -1.0, 0.0, 1.0]), np.arange(4.0), law)
    assert verdict.outlier == 3
    assert verdict["largest"].statistic == pytest.approx(np.sqrt(13.0))


@pytest.mark.parametrize(("others", "one"), [(1.0, True), (6.0, False)])
def test_one_point_is_blamed_where_the_others_obey_the_law(others, one):
    residual = others * np.tile([1.0, -1.0], 10)
    residual[7] = 10.0
    verdict = judged_in_order(residual, np.arange(20.0), Succession(["a"] * 20, np.ones((20, 1))))
    assert verdict["largest"].probability < 0.01
    assert verdict.one_outlier is one
    assert "(p < 1e-9)" in str(verdict)


def test_a_law_fits_though_errors_drift_or_one_point_is_an_outlier():
    verdict = judged(np.tile([1.0, -1.0], 10), 2)
    verdict = replace(verdict, tests=(*verdict.tests, SignificanceTest("largest", 5.0, 1e-5)))
    assert verdict.law_fits
    assert not verdict.fits
    assert str(verdict).startswith("the law fits: ")
    assert ", but the largest residual is 5 standard deviations (p = 1e-05)" in str(verdict)


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
