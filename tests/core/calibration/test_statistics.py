"""Intervals, verdicts on residuals, joint covariances and units, against exact distributions."""

from itertools import combinations, groupby

import numpy as np
import pytest
from scipy.special import ndtr

import metafem as mf
from metafem.calibration import Sample, compare, fit_compression, joint_covariance, shear
from metafem.calibration.bounded_interval import PROBABILITY, WIDTH, bounded_interval
from metafem.calibration.serial_correlation import Succession
from metafem.calibration.verdict import SingleTest, heterogeneity, judged, judged_in_order
from tests.calibration.compression.scenes import AREA, RADIUS, A, load_of
from tests.calibration.measured_law.scenes import linear_design, measured_on
from validation.scenes.compression_tests import ENERGY, compression_tests
from validation.scenes.sheared_contacts import sheared


def test_intervals_of_positive_quantities_are_those_of_the_published_table():
    # Feldman and Cousins, Phys. Rev. D 57, 3873 (1998), table X, 68.27 %: here 68 %, within 0.01
    estimate = np.array([-3.0, -1.0, 0.0, 0.5, 1.0, 3.0])
    low, high = bounded_interval(estimate, 1.0)
    assert low == pytest.approx([0.0, 0.0, 0.0, 0.02, 0.24, 2.0], abs=0.012)
    assert high == pytest.approx([0.04, 0.27, 1.0, 1.5, 2.0, 4.0], abs=0.012)
    wide = bounded_interval(2.5 * estimate, 2.5)
    assert np.array(wide) == pytest.approx(2.5 * np.array([low, high]))
    assert 2.0 * ndtr(WIDTH) - 1.0 == pytest.approx(PROBABILITY, abs=1e-9)
    for mean in (0.0, 0.5, 2.0):
        x = np.linspace(mean - 8.0, mean + 8.0, 200_001)
        low, high = bounded_interval(x, 1.0)
        inside = (low <= mean) & (mean <= high)
        assert (np.diff(ndtr(x - mean)) * inside[1:]).sum() == pytest.approx(PROBABILITY, abs=2e-4)


def test_the_probability_of_runs_is_that_of_all_orders_of_the_signs():
    count, positive = 9, 4
    orders = [np.isin(np.arange(count), chosen) for chosen in combinations(range(count), positive)]
    runs = np.array([len(list(groupby(signs))) for signs in orders])
    for signs, most in zip(orders, runs, strict=True):
        found = judged(np.where(signs, 1.0, -1.0), 0)["runs"].probability
        assert found == pytest.approx(np.mean(runs <= most), rel=1e-12)
    assert not judged(np.full(12, 0.9), 1).fits


def test_the_outlier_is_the_point_whose_own_error_is_exceeded_most():
    law = Succession(["a"] * 4, np.array([[1.0], [1.0], [1.0], [6.0]]))  # leverage 36/39 of the last
    verdict = judged_in_order(np.array([2.0, -1.0, 0.0, 1.0]), np.arange(4.0), law)
    assert verdict.outlier == 3
    assert verdict["largest"].statistic == pytest.approx(np.sqrt(13.0))
    # one point is blamed where the others obey the law
    for others, one in ((1.0, True), (6.0, False)):
        residual = others * np.tile([1.0, -1.0], 10)
        residual[7] = 10.0
        verdict = judged_in_order(residual, np.arange(20.0), Succession(["a"] * 20, np.ones((20, 1))))
        assert verdict["largest"].probability < 0.01
        assert verdict.one_outlier is one


def test_tests_differ_by_the_distance_of_their_parameters_over_its_deviation():
    def compared(*tests):
        return heterogeneity([SingleTest("", 20, np.array(v), np.array(matrix)) for v, matrix in tests])

    found = compared(([1.0], [[0.01]]), ([1.5], [[0.03]]))
    assert found.chi_square == pytest.approx(0.25 / 0.04)
    assert found.agree
    assert not compared(([1.0], [[0.01]]), ([1.9], [[0.03]])).agree
    found = compared(([1.0, np.nan], np.diag([0.1, np.nan])), ([1.2, 3.0], np.diag([0.1, 0.1])))
    assert (found.freedom, found.chi_square) == (1, pytest.approx(0.04 / 0.2))
    covariance = np.array([[2.0, -0.8], [-0.8, 1.0]])
    root, rng = np.linalg.cholesky(covariance), np.random.default_rng(0)
    drawn = [compared(*[(root @ rng.standard_normal(2), covariance) for _ in range(3)]) for _ in range(500)]
    probability = np.array([each.probability for each in drawn])
    assert drawn[0].freedom == 4
    assert abs((probability < 0.3).mean() - 0.3) < 4.0 * np.sqrt(0.3 * 0.7 / 500)


def test_covariance_and_correlation_of_successive_errors_are_those_of_dense_matrices():
    x = np.random.default_rng(0).uniform(0.5, 2.0, 60)
    test, x = np.tile(["b", "a", "c"], 20), np.column_stack([x, x**2])
    law = Succession(test, x)
    place = np.array([(test[:i] == test[i]).sum() for i in range(60)])
    apart, same = np.abs(place[:, None] - place), test[:, None] == test
    errors, beside = np.where(same, 0.7**apart, 0.0), np.where(same & (apart == 1), 0.5, 0.0)
    inverse = np.linalg.inv(x.T @ x)
    assert law.covariance(0.0) == pytest.approx(inverse)
    assert law.covariance(0.7) == pytest.approx(inverse @ x.T @ errors @ x @ inverse)
    left = np.eye(60) - x @ inverse @ x.T
    expected = np.trace(beside @ left @ errors @ left) / np.trace(left @ errors)
    assert law.of_errors(expected) == pytest.approx(0.7, abs=1e-5)
    assert (law.of_errors(-0.5), law.of_errors(1.0)) == (0.0, 0.99)
    residual = left @ np.random.default_rng(1).standard_normal(60)
    assert law.lag_one(residual)[0] == pytest.approx(residual @ beside @ residual / (residual @ residual))
    assert law.lag_one(np.zeros(60)) == (0.0, 1.0)
    assert law.leverage == pytest.approx(1.0 - np.diagonal(left))


def test_the_blocks_of_calibrations_are_independent():
    pressed = fit_compression(5.0 * load_of(A), 5.0 * AREA, RADIUS, Sample(contacts=5, radius_sd=0.005))
    slid = shear(AREA, 0.85 * AREA, 0.34 * AREA)
    names, matrix = joint_covariance(pressed, slid)
    assert names == ("radius", "composite_modulus", "area_ratio", "shear_strength")
    assert (matrix[:2, 2:] == 0.0).all()
    assert (matrix[:2, :2] == pressed.parameter_covariance).all()
    assert (matrix[2:, 2:] == slid.covariance).all()
    assert (matrix == matrix.T).all()


def test_another_unit_is_named_and_usual_data_are_not_suspected():
    load, area = (each[0] for each in compression_tests(1, 5, ENERGY, np.random.default_rng(0)))
    slid, design = sheared(np.random.default_rng(0))[0], linear_design()
    loads = np.linspace(0.05, 0.6, 12)

    def pressed(load_unit, area_unit):
        try:
            return fit_compression(load_unit * load, area_unit * area, RADIUS, Sample(5)).notes
        except mf.MetafemError as error:
            return [error]

    for column, notes in (
        ("load_mN", pressed(1e3, 1.0)),
        ("area_um2", pressed(1.0, 1e6)),
        ("", pressed(1.0, 1.0)),
        ("friction_force_mN", shear(slid[0], slid[1], 1e3 * slid[2]).notes),
        ("area_before_mm2", shear(1e-6 * slid[0], 1e-6 * slid[1], slid[2]).notes),
        ("", shear(*slid).notes),
        ("friction_force_N", compare(measured_on(design, loads, 1e-3), design).notes),
        ("", compare(measured_on(design, loads, 2.0), design).notes),
    ):
        before = [str(note).partition(" would fit")[0] for note in notes if "would fit" in str(note)]
        assert [words.split()[-1] for words in before[:1]] == [column] * bool(column)


def test_three_points_have_no_drift():
    load, area = (each[0] for each in compression_tests(1, 5, ENERGY, np.random.default_rng(0)))
    for robust in (False, True):
        found = fit_compression(load[4:20:7], area[4:20:7], RADIUS, sample=Sample(contacts=5), robust=robust)
        assert found.verdict["correlation"].probability == 1.0


def test_correct_laws_are_rejected_as_often_as_stated():
    rng = np.random.default_rng(1)
    verdicts = [judged(rng.standard_normal(30), 0) for _ in range(1000)]
    probabilities = np.array([verdict["chi_square"].probability for verdict in verdicts])
    # the binomial standard deviation of a share of 1000
    assert abs((probabilities < 0.2).mean() - 0.2) < 4.0 * np.sqrt(0.2 * 0.8 / 1000)
    assert np.mean([not verdict.fits for verdict in verdicts]) < 0.03  # two tests at 1 %
