"""Covariances of calibrations in the study of uncertainties."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import Sample, fit_compression, joint_covariance, shear

A = np.linspace(0.08, 0.4, 20)
AREA = math.pi * A**2
LOAD = 1.36 * 4.0 / 3.0 * A**3 / 0.526


@pytest.fixture(scope="module")
def calibrations():
    return fit_compression(5.0 * LOAD, 5.0 * AREA, 0.526, sample=Sample(contacts=5, radius_sd=0.005)), shear(
        AREA, 0.85 * AREA, 0.34 * AREA
    )


@pytest.fixture(scope="module")
def surface(calibrations):
    pressed, sheared = calibrations
    return mf.Surface.square_lattice(
        [0.1, 0.12], (1, 2), radius=0.526, material=pressed.material, friction=sheared.friction
    )


def test_the_blocks_of_calibrations_are_independent(calibrations):
    names, matrix = joint_covariance(*calibrations)
    assert names == ("radius", "composite_modulus", "area_ratio", "shear_strength")
    assert (matrix[:2, 2:] == 0.0).all()
    assert (matrix == matrix.T).all()
    assert (matrix[:2, :2] == calibrations[0].parameter_covariance).all()
    assert (matrix[2:, 2:] == calibrations[1].covariance).all()


def test_they_are_handed_on_to_the_study(calibrations, surface):
    names, matrix = joint_covariance(*calibrations)
    load = [0.05]
    found = mf.studies.uncertainty(surface, (names, matrix), load=load, draws=2048)
    assert list(found.parameter.values) == ["radius + composite_modulus", "area_ratio + shear_strength"]
    sheared = mf.studies.uncertainty(surface, (names[2:], matrix[2:, 2:]), load=load, draws=2048)
    # F = sigma B A0: the relative variances of independent blocks add
    relative = [float(part.friction_force_sd[0] / part.friction_force_mean[0]) for part in (found, sheared)]
    area = float(found.area_sd[0] / found.area_mean[0])
    assert relative[0] == pytest.approx(math.hypot(relative[1], area), rel=0.01)


def test_an_error_of_the_radius_nearly_cancels_in_the_area(calibrations, surface):
    pressed = calibrations[0]
    alone = pressed.statistical_covariance[:1, :1]
    # all contacts closed at one indentation: a^3 = 3 R P/(4 E*), and E* grows in proportion to R
    flat = mf.Surface.square_lattice(0.1, (1, 2), radius=0.526, material=pressed.material)
    both, statistical = (
        float(mf.studies.uncertainty(flat, (names, matrix), load=[0.05], draws=2048).area_sd[0])
        for names, matrix in (
            (pressed.parameters, pressed.parameter_covariance),
            (("composite_modulus",), alone),
        )
    )
    assert both == pytest.approx(statistical, rel=0.02)


def test_a_parameter_belongs_to_one_calibration(calibrations):
    with pytest.raises(mf.InvalidInput, match="composite_modulus is a parameter of two calibrations"):
        joint_covariance(fit_compression(LOAD, AREA, 0.526), fit_compression(LOAD, AREA, 0.526))
    with pytest.raises(
        mf.InvalidInput, match=r"'E\*' must be a result of metafem.calibration.fit_compression"
    ):
        joint_covariance("E*")
