"""Tests of residuals: how often they notice, and their limits."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import Sample, fit_compression, joint_covariance, shear
from metafem.calibration.serial_correlation import Succession
from metafem.calibration.verdict import judged, judged_in_order
from tests.calibration.compression.scenes import AREA, RADIUS, A, load_of
from validation.scenes.compression_tests import ENERGY, compression_tests
from validation.scenes.drift import drifting


def test_covariances_are_handed_on_to_the_study():
    sample = Sample(contacts=5, radius_sd=0.005)
    pressed = fit_compression(5.0 * load_of(A, energy=0.0), 5.0 * AREA, RADIUS, sample)
    slid = shear(AREA, 0.85 * AREA, 0.34 * AREA)
    names, matrix = joint_covariance(pressed, slid)
    surface = mf.Surface.square_lattice(
        0.1, (1, 2), radius=RADIUS, material=pressed.material, friction=slid.friction
    )

    def found(names, matrix):
        return mf.studies.uncertainty(surface, (names, matrix), load=[0.05], draws=2048)

    both, friction = found(names, matrix), found(names[2:], matrix[2:, 2:])
    assert list(both.parameter.values) == ["radius + composite_modulus", "area_ratio + shear_strength"]
    # F = sigma B A0: the relative variances of independent blocks add
    relative = [float(each.friction_force_sd[0] / each.friction_force_mean[0]) for each in (both, friction)]
    area = float(both.area_sd[0] / both.area_mean[0])
    assert relative[0] == pytest.approx(math.hypot(relative[1], area), rel=0.01)
    # all contacts closed at one indentation: a^3 = 3 R P/(4 E*), and E* grows in proportion to R
    alone = found(("composite_modulus",), pressed.statistical_covariance[:1, :1])
    assert float(both.area_sd[0]) == pytest.approx(float(alone.area_sd[0]), rel=0.02)


def test_independent_normal_errors_are_noticed_as_often_as_stated():
    rng = np.random.default_rng(2)
    x = np.tile(np.linspace(0.5, 2.0, 20), 3)
    law = Succession(np.repeat(["b", "a", "c"], 20), np.column_stack([x, x**2]))
    left = np.eye(60) - law.regressor @ law.covariance(0.0) @ law.regressor.T
    found = [judged_in_order(left @ rng.standard_normal(60), x, law) for _ in range(1000)]
    for name in ("correlation", "largest"):
        share = np.mean([each[name].probability < 0.1 for each in found])
        assert abs(share - 0.1) < 4.0 * math.sqrt(0.1 * 0.9 / 1000)
    # four tests at 1 %
    assert np.mean([not each.fits for each in found]) < 0.05


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


def test_drifting_loads_are_noticed_and_widen_the_interval():
    given = {"sample": Sample(contacts=5), "test": np.repeat(["b", "a", "c"], 20)}
    found = fit_compression(*drifting(np.random.default_rng(3), 5), RADIUS, **given)
    assert found.verdict["correlation"].probability < 0.01
    measured = (each[0] for each in compression_tests(1, 5, ENERGY, np.random.default_rng(3)))
    steady = fit_compression(*measured, RADIUS, **given)
    assert steady.verdict.fits
    assert len(found.notes) > len(steady.notes)
    assert found.root_covariance[0, 0] > 2.0 * steady.root_covariance[0, 0]
