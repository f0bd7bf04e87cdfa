"""Tolerances and their draws."""

import math

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

import metafem as mf
from metafem.prediction.tolerances import scatter

SURFACE = mf.Surface([[0, 0], [1.5, 0], [0, 2.0]], [0.1, 0.12, 0.15], [0.5, 0.6, 0.7], mf.Material(1.36))


def drawn(tolerances, count=20_000):
    return tolerances.perturbed(SURFACE, count, np.random.default_rng(0))


def test_without_errors_a_draw_is_the_surface():
    height, radius, position = drawn(mf.Tolerances(), 2)
    assert_array_equal(height, [SURFACE.height] * 2)
    assert radius is None
    assert position is None


def test_heights_of_any_deviation_have_the_same_normal_numbers():
    one, three = (drawn(mf.Tolerances(height_sd=sd), 2)[0] - SURFACE.height for sd in (0.001, 0.003))
    assert_allclose(three, 3.0 * one, rtol=1e-9)


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
    """Heights are linear in the positions; both angles fill their range."""
    height, angle = drawn(mf.Tolerances(angle=0.02))[0], []
    for k, x in ((1, 1.5), (2, 2.0)):
        rise = height[:, k] - height[:, 0] - (SURFACE.height[k] - SURFACE.height[0])
        angle.append(np.arctan(rise / x))
    for row in range(3):
        assert_allclose(height[row], SURFACE.tilted(angle[0][row], angle[1][row]).height, rtol=1e-13)
    assert_allclose(
        np.quantile(angle, [0.0, 0.25, 0.75, 1.0], axis=1)[:, 0], [-0.02, -0.01, 0.01, 0.02], atol=5e-4
    )


def test_the_scatter_of_errors_is_that_of_draws():
    """Of few asperities of unequal and of many of equal heights, whose dA0/dh at a fixed load vanish."""
    equal = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    for surface, model, sd in ((SURFACE, mf.Interacting(), 1e-5), (equal, mf.Independent(), 0.0009)):
        load, count = np.array([0.001, 0.1]), 20_000
        height = mf.Tolerances(height_sd=sd).perturbed(surface, count, np.random.default_rng(1))[0]
        draws = mf.Independent().areas(surface, load, height) / mf.Independent().curve(surface, load).area
        mean, found = scatter(surface, model, load, sd)
        assert_allclose(found, draws.std(axis=0), rtol=5 / math.sqrt(2 * 256))
        assert_allclose(mean, draws.mean(axis=0), atol=5 * found.max() / math.sqrt(256))


def test_the_scatter_of_small_errors_follows_the_gradient():
    load, sd = np.array([0.001, 0.1]), 1e-7
    found = mf.Independent().sensitivity(SURFACE, load)
    error = mf.Tolerances(sd).perturbed(SURFACE, 256, np.random.default_rng(0))[0] - SURFACE.height
    expected = (error @ found.gradient.T / found.curve.area).std(axis=0, ddof=1)
    assert_allclose(scatter(SURFACE, mf.Independent(), load, sd)[1], expected, rtol=1e-3)
