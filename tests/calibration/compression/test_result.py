"""What a calibration of contacts holds, prints and draws."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import fit_compression
from metafem.calibration.bounded_interval import WIDTH

A = np.linspace(0.08, 0.4, 20)
AREA = math.pi * A**2
FOUND = fit_compression(
    1.36 * 4.0 / 3.0 * A**3 / 0.526 - np.sqrt(8.0 * math.pi * 9e-6 * 1.36 * A**3), AREA, 0.526
)


def test_intervals_follow_from_the_covariance():
    modulus, root = np.sqrt(np.diag(FOUND.root_covariance))
    assert np.diff(FOUND.composite_modulus_interval) == pytest.approx(2.0 * WIDTH * modulus)
    assert np.mean(FOUND.adhesion_root_interval) == pytest.approx(FOUND.adhesion_root)
    assert np.diff(FOUND.adhesion_root_interval) == pytest.approx(2.0 * WIDTH * root)
    low, high = FOUND.adhesion_energy_interval
    assert low < FOUND.adhesion_energy < high
    assert high - FOUND.adhesion_energy > FOUND.adhesion_energy - low


def test_no_interval_of_the_modulus_is_below_zero():
    a = np.array([0.05, 0.06, 0.08])
    found = fit_compression(4.0 / 3.0 * 1.36 * a**3 / 0.526, np.pi * a**2, 0.526)
    assert np.sqrt(found.root_covariance[0, 0]) > found.composite_modulus
    low, high = found.composite_modulus_interval
    assert 0.0 <= low < found.composite_modulus < high


def test_the_covariance_of_w_is_that_of_the_square_of_a_normal_root():
    rng = np.random.default_rng(0)
    mean = [FOUND.composite_modulus, FOUND.adhesion_root]
    modulus, root = rng.multivariate_normal(mean, FOUND.root_covariance, 100_000).T
    assert FOUND.covariance == pytest.approx(np.cov(modulus, root**2), rel=0.03)


def test_the_modulus_without_adhesion_is_that_of_a_fit_without_it():
    q = mf.Hertz().load(A, 0.526)
    slope = FOUND.composite_modulus * 1.5 * q / AREA
    weight = 1.0 / (FOUND.load_sd**2 + (slope * FOUND.area_sd) ** 2)
    modulus, sd = FOUND.modulus_without_adhesion
    assert modulus == pytest.approx((weight * q * FOUND.load).sum() / (weight * q**2).sum(), rel=1e-3)
    assert sd == pytest.approx((weight * q**2).sum() ** -0.5, rel=0.02)


def test_it_prints_its_values():
    assert repr(FOUND).startswith("<ContactCalibration: E* = 1.36 ± 0.06 MPa, sqrt(w) = 0.003 ± ")
    assert FOUND == FOUND
    assert FOUND.material == mf.Material(FOUND.composite_modulus)


def test_it_draws_points_with_error_bars_and_the_law():
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    assert FOUND.plot(ax) is ax
    assert len(ax.containers) == 1
    x, y = ax.lines[-1].get_data()
    assert x[-1] == pytest.approx(FOUND.load_fitted[-1])
    assert y[[0, -1]] == pytest.approx([0.0, AREA[-1]])
    assert np.interp(AREA, y, x) == pytest.approx(FOUND.load_fitted, abs=1e-5)
