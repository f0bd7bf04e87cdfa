"""Intervals, verdicts on residuals, joint covariances and units, against exact distributions."""

import numpy as np
import pytest
from scipy.special import ndtr

from metafem.calibration import MeasurementErrors, fit_compression, joint_covariance, shear
from metafem.calibration.statistics import PROBABILITY, WIDTH, bounded_interval
from tests.calibration.compression.scenes import AREA, RADIUS, A, load_of
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


def test_tests_of_one_material_differ_as_often_as_stated():
    rng, labels = np.random.default_rng(0), np.repeat(["a", "b", "c"], 5)
    drawn = [shear(*sheared(rng, loads=5)[0], test=labels).heterogeneity for _ in range(60)]
    assert drawn[0].freedom == 4
    share = np.mean([each.probability < 0.3 for each in drawn])
    assert abs(share - 0.3) < 3.0 * np.sqrt(0.3 * 0.7 / 60)


def test_the_blocks_of_calibrations_are_independent():
    errors = MeasurementErrors(radius_sd=0.005)
    pressed = fit_compression(5.0 * load_of(A), 5.0 * AREA, RADIUS, contacts=5, errors=errors)
    slid = shear(AREA, 0.85 * AREA, 0.34 * AREA)
    names, matrix = joint_covariance(pressed, slid)
    assert names == ("radius", "composite_modulus", "area_ratio", "shear_strength")
    assert (matrix[:2, 2:] == 0.0).all()
    assert (matrix[:2, :2] == pressed.covariance).all()
    assert (matrix[2:, 2:] == slid.covariance).all()
    assert matrix == pytest.approx(matrix.T, rel=1e-12)
