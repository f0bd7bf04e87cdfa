"""Formulas of the errors against special functions, quadrature and simulation."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import chndtrinc, zeta
from scipy.stats import norm

from metafem.calibration.images import errors
from metafem.calibration.images.boundary import contours
from metafem.calibration.images.levels import smoothed
from validation.scenes.pictures import coverage


@pytest.mark.parametrize(("ratio", "order"), [(2.0, 4e-3), (4.0, 2e-4), (10.0, 3e-6)])
def test_circles_are_larger_than_their_half_level_by_the_median_of_chi_square(ratio, order):
    # in units of s: the half level has the radius at which the noncentral distribution has its median
    half = np.pi * chndtrinc(ratio**2, 2.0, 0.5)
    pixels = np.pi * errors.INTERPOLATION
    assert errors.enclosed(np.array([half]), 0.0, 1.0)[0] - pixels == pytest.approx(
        np.pi * ratio**2, rel=order
    )


def test_the_area_lost_by_interpolation_does_not_depend_on_radius_and_blur():
    lost = []
    for radius, blur in ((20.0, 1.0), (20.0, 2.0), (45.0, 1.5)):
        side = int(2.0 * radius + 40.0)
        centres = side / 2.0 + np.random.default_rng(1).uniform(-0.5, 0.5, (8, 2))
        for centre in centres:
            covered = coverage((side, side), [centre], [radius], blur=blur)
            image, variance = smoothed((1.0 - covered).astype(np.float32), blur)
            found = contours(image, (image < 0.5).astype(np.int32), 0.5, 1)
            total = np.sqrt(blur**2 + 1.0 / 12.0 + variance)
            lost.append(np.pi * radius**2 - errors.enclosed(found.area, 0.0, total)[0])
    # pi times 0.03 square pixels: the spread of the constant
    assert np.abs(np.reshape(lost, (3, 8)).mean(axis=1)).max() < np.pi * 0.03


def test_the_error_of_noise_is_least_for_the_blur_and_is_the_cramer_rao_bound():
    s, noise, length = 1.7, 0.05, np.array([80.0])
    widths = np.linspace(0.5, 4.0, 701)
    found = [errors.of_contour(length, noise, w, np.hypot(s, w), 0.0, 0.0)[0] for w in widths]
    assert widths[np.argmin(found)] == pytest.approx(s, abs=0.005)
    information, _ = quad(lambda u: norm.pdf(u, scale=s) ** 2, -20.0, 20.0)
    bound = length[0] * noise / np.sqrt(length[0] * information)
    assert min(found) == pytest.approx(bound, rel=1e-6)


def test_errors_of_level_and_blur_are_derivatives():
    # d of the half level moves a straight edge by d over its slope; s_t enters the area by pi s_t²
    total, length = 2.1, np.array([60.0])
    moved = total * (norm.ppf(0.501) - norm.ppf(0.499)) / 0.002
    assert errors.of_contour(length, 0.0, 1.5, total, 1e-3, 0.0) == pytest.approx(
        60.0 * moved * 1e-3, rel=1e-5
    )
    change = np.pi * ((total + 1e-4) ** 2 - (total - 1e-4) ** 2) / 2e-4
    assert errors.of_contour(length, 0.0, 1.5, total, 0.0, 1e-2) == pytest.approx(change * 1e-2, rel=1e-6)


def test_the_scatter_of_counted_pixels():
    odd = np.arange(1.0, 2e5, 2.0)
    beta = np.sum(odd**-1.5 * np.where(odd % 4 == 1, 1.0, -1.0))
    constant = 4.0 * zeta(1.5) * beta / (2.0 * np.pi**2) / (2.0 * np.pi)
    assert pytest.approx(constant, abs=5e-5) == errors.COUNTED
    rng = np.random.default_rng(2)
    place = np.arange(-60, 61)
    counts = []
    for radius in (20.0, 33.3, 50.7):
        for x, y in rng.uniform(0.0, 1.0, (400, 2)):
            inside = np.hypot(place - x, (place - y)[:, None]) < radius
            counts.append((inside.sum() - np.pi * radius**2) / np.sqrt(2.0 * np.pi * radius))
    # lattice points in a disc fluctuate with its radius, by a tenth about this constant
    assert np.var(counts) == pytest.approx(errors.COUNTED, rel=0.15)


@pytest.mark.parametrize("threshold", [0.35, 0.6])
def test_the_bias_of_counted_pixels(threshold):
    radius, blur = 24.0, 1.5
    counts = []
    for centre in 40.0 + np.random.default_rng(3).uniform(-0.5, 0.5, (40, 2)):
        counts.append((coverage((80, 80), [centre], [radius], blur=blur) > threshold).sum())
    length, edge = np.array([2.0 * np.pi * radius]), np.sqrt(blur**2 + 1.0 / 12.0)
    expected = errors.counting_bias(length, threshold, edge)[0]
    assert np.mean(counts) - np.pi * radius**2 == pytest.approx(expected, abs=1.5)


@pytest.mark.parametrize("noise", [0.0, 0.2, 0.6])
def test_the_error_of_grey_levels_in_steps(noise):
    # levels anywhere between two steps, each the mean of many pixels
    level = np.linspace(0.0, 1.0, 2000, endpoint=False)
    edges = np.arange(-8, 9) + 0.5
    mean = level.copy() * 0.0
    for low in edges:
        mean += norm.cdf((level - low) / noise) if noise else (level > low)
    error = mean + edges[0] - 0.5 - level
    assert np.sqrt(2.0) * error.std() == pytest.approx(errors.quantisation(noise, 1.0), rel=0.25, abs=1e-3)
