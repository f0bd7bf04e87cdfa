"""Shear tests: closed forms of the fit, points drawn again, records with noise."""

import numpy as np
import pytest

from metafem.calibration import Bootstrap, shear, shear_record
from metafem.calibration.sheared.proportional import proportional
from tests.calibration.sheared.scenes import X, area, force
from validation.scenes.sheared_contacts import ERRORS, sheared

TESTS = np.repeat(["a", "b", "c"], 20)

AREAS = (ERRORS.of_area, ERRORS.of_area, ERRORS.of_friction_force)


@pytest.fixture(scope="module")
def points():
    return sheared(np.random.default_rng(7))[0]


def test_the_lines_are_drawn_with_their_points(points):
    for line, slope in (("area", 0.85), ("friction", 0.37)):
        ax = shear(*points).plot(line=line)
        fitted = ax.lines[-1].get_xydata()
        assert fitted[0].tolist() == [0.0, 0.0]
        assert fitted[1, 1] / fitted[1, 0] == pytest.approx(slope, rel=0.02)
        assert len(ax.containers[0].lines[0].get_xdata()) == 60


def test_constant_errors_of_two_quantities_give_demings_line():
    rng = np.random.default_rng(2)
    x = np.linspace(1.0, 2.0, 9)
    points = np.stack([x, 0.7 * x]) + 0.05 * rng.standard_normal((2, 9))
    constant = [lambda value: np.full_like(value, 0.05)] * 2
    factor, _, _ = proportional(points, constant)
    # the direction of the largest moment of the points about the origin
    moments = points @ points.T
    axis = np.linalg.eigh(moments)[1][:, -1]
    assert factor[0] == pytest.approx(axis[1] / axis[0], rel=1e-10)


def test_leading_axes_are_separate_fits():
    points, _ = sheared(np.random.default_rng(5), shape=(2, 3))
    factor, covariance, value = proportional(points, AREAS)
    one = proportional(points[1, 2], AREAS)
    assert factor.shape == (2, 3, 2)
    assert covariance.shape == (2, 3, 2, 2)
    for many, single in zip((factor, covariance, value), one, strict=True):
        assert many[1, 2] == pytest.approx(single, rel=1e-9)


def test_the_noise_is_that_of_the_plateau():
    rng = np.random.default_rng(0)
    x = np.linspace(0, 0.6, 6001)
    found = shear_record(x, force(x) + 1e-3 * rng.normal(size=6001))
    assert found.noise == pytest.approx(1e-3, rel=0.1)
    # the largest of many noisy values is above the peak by no more than is stated
    assert 0.2 < found.static_force < 0.2 + found.noise * np.sqrt(2.0 * np.log(6001))


def test_no_distinct_peak_and_a_first_frame_under_load_are_noted():
    flat = force(X, static=0.17) + 1e-3 * np.cos(50.0 * X)
    flat[20] = 0.1715
    assert "0.1715 N" in str(shear_record(X, flat).notes[0])
    late = area(X)
    late[:5] = np.nan
    found = shear_record(X, force(X), late)
    assert "33 %" in str(found.notes[0])


def test_points_drawn_again_scatter_as_stated_and_repeat(points):
    found = shear(*points, test=TESTS, bootstrap=Bootstrap(1000))
    assert found.bootstrap.shape == (1000, 2)
    # of 60 points the scatter is known within about 10 %
    ratio = found.bootstrap.std(0) / np.sqrt(np.diagonal(found.covariance))
    assert (np.abs(ratio - 1.0) < 0.35).all()
    assert found == shear(*points, test=TESTS, bootstrap=Bootstrap(1000))
    assert found != shear(*points, test=TESTS, bootstrap=Bootstrap(1000, 1))


def test_areas_between_the_frames_are_not_needed():
    sparse = np.full_like(X, np.nan)
    sparse[::4] = area(X)[::4]  # no frame at the peak, entry 15
    found = shear_record(X, force(X), sparse[:, None] * np.array([0.3, 0.7]))
    assert found.static_area == pytest.approx(0.25 * area(X)[12] + 0.75 * area(X)[16])
    assert found.sliding_area == pytest.approx(0.4)
    assert len(found.notes) == 1
