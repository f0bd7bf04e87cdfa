"""Tolerances and their draws."""

import math

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

import metafem as mf

SURFACE = mf.Surface([[0, 0], [1.5, 0], [0, 2.0]], [0.1, 0.12, 0.15], [0.5, 0.6, 0.7], mf.Material(1.36))
EVERY = mf.Tolerances(height_sd=0.003, angle=0.4, radius_sd=0.01, position_sd=0.02)


def drawn(tolerances, count=20_000):
    return tolerances.perturbed(
        SURFACE, np.random.default_rng(0).random((count, tolerances.dimensions(SURFACE)))
    )


def test_each_error_has_its_own_numbers():
    assert mf.Tolerances().dimensions(SURFACE) == 0
    assert mf.Tolerances(height_sd=0.003).dimensions(SURFACE) == 3
    assert mf.Tolerances(angle=0.1).dimensions(SURFACE) == 2
    assert mf.Tolerances(radius_sd=0.01, position_sd=0.02).dimensions(SURFACE) == 9
    assert EVERY.dimensions(SURFACE) == 14


def test_without_errors_a_draw_is_the_surface():
    height, radius, position = mf.Tolerances().perturbed(SURFACE, np.empty((2, 0)))
    assert_array_equal(height, [SURFACE.height] * 2)
    assert radius is None
    assert position is None


def test_a_point_of_the_cube_is_a_quantile():
    """Probabilities of -2, 0 and 1 standard deviations."""
    point = np.array([[0.022750131948179, 0.5, 0.841344746068543]])
    height = mf.Tolerances(height_sd=0.003).perturbed(SURFACE, point).height[0]
    assert_allclose(height, SURFACE.height + 0.003 * np.array([-2.0, 0.0, 1.0]), rtol=1e-12)


def test_draws_have_the_stated_moments():
    """Five standard errors of means and standard deviations."""
    count = 20_000
    height, radius, position = drawn(mf.Tolerances(height_sd=0.003, radius_sd=0.01, position_sd=0.02), count)
    parts = (
        (height, SURFACE.height, 0.003),
        (radius, SURFACE.radius, 0.01),
        (position, SURFACE.position, 0.02),
    )
    for values, mean, sd in parts:
        assert_allclose(values.mean(axis=0), mean, atol=5 * sd / math.sqrt(count))
        assert_allclose(values.std(axis=0), sd, rtol=5 / math.sqrt(2 * count))
    both = np.hstack([height, radius, position.reshape(count, -1)])
    correlation = np.corrcoef(both.T) - np.eye(both.shape[1])
    assert np.abs(correlation).max() < 5 / math.sqrt(count)


def test_a_tilt_is_that_of_the_surface():
    tolerances = mf.Tolerances(angle=0.02)
    height = tolerances.perturbed(SURFACE, np.array([[0.75, 0.25]])).height[0]
    assert_allclose(height, SURFACE.tilted(0.01, -0.01).height, rtol=1e-14)


def test_the_covariance_of_linear_functions_is_that_of_draws():
    gradient = np.random.default_rng(1).standard_normal((2, SURFACE.count))
    for tolerances in (EVERY, mf.Tolerances(height_sd=0.003), mf.Tolerances(angle=0.5)):
        values = (drawn(tolerances, 100_000).height - SURFACE.height) @ gradient.T
        found = tolerances.linear_covariance(SURFACE, gradient)
        scale = np.sqrt(np.outer(np.diag(found), np.diag(found)))
        assert_allclose(np.cov(values.T) / scale, found / scale, atol=0.02)


def test_scaled_tolerances():
    assert EVERY.scaled(0.5) == mf.Tolerances(0.0015, 0.2, 0.005, 0.01)
    assert mf.Tolerances().scaled(3.0) == mf.Tolerances()
