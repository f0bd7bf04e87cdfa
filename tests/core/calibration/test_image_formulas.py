"""Contours against scikit-image's, and formulas of the errors against closed forms and simulation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.ndimage import label
from scipy.special import chndtrinc
from scipy.stats import norm
from skimage.measure import euler_number, find_contours

from metafem.calibration import contours as errors
from metafem.calibration.contours import compactness, contours
from validation.scenes.pictures import coverage


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.floats(0.2, 0.8))
def test_random_images_have_the_contours_of_scikit_image(seed, level):
    image = np.ones((14, 17), dtype=np.float32)
    image[1:-1, 1:-1] = np.random.default_rng(seed).random((12, 15))
    level = float(np.float32(level))
    labels, count = label(image < level)
    found = contours(image, labels, level, count)
    # the same polygons as wholes; dark pixels that touch at a corner alone are not connected
    polygons = find_contours(image, level, fully_connected="high")
    area, length = 0.0, 0.0
    for points in polygons:
        row, column = points.T
        area += 0.5 * float(np.sum(row[:-1] * column[1:] - row[1:] * column[:-1]))
        length += float(np.hypot(*np.diff(points, axis=0).T).sum())
    assert found.area.sum() == pytest.approx(abs(area), rel=1e-6)
    assert found.length.sum() == pytest.approx(length, rel=1e-6)
    assert (1 - found.holes).tolist() == [euler_number(labels == i + 1, connectivity=1) for i in range(count)]


def test_moments_of_an_ellipse():
    a, b, angle, centre = 30.0, 18.0, 0.5, (45.2, 38.7)
    covered = coverage((80, 90), [centre], [(a, b)], angle, blur=2.0)
    image = np.pad(1.0 - covered, 1, constant_values=1.0).astype(np.float32)
    found = contours(image, (image < 0.5).astype(np.int32), 0.5, 1)
    assert found.centre[0] == pytest.approx(centre, abs=1e-3)
    xx, yy, xy = found.moment[0]
    # the blur moves the contour inwards; the direction is not changed
    assert 0.5 * np.arctan2(2.0 * xy, xx - yy) == pytest.approx(angle, abs=1e-3)
    assert xx + yy == pytest.approx(0.25 * np.pi * a * b * (a**2 + b**2), rel=0.04)


def test_the_compactness_of_an_ellipse_a_square_and_two_circles():
    cos, sin = np.cos(1.2), np.sin(1.2)
    second = [(9.0 * cos) ** 2 + sin**2, (9.0 * sin) ** 2 + cos**2, 80.0 * sin * cos]
    moment = 9.0 * np.pi / 4.0 * np.array([second])
    assert compactness(np.array([9.0 * np.pi]), moment)[0] == pytest.approx(1.0, rel=1e-12)
    square = np.array([[1.0 / 12.0, 1.0 / 12.0, 0.0]])
    assert compactness(np.ones(1), square)[0] == pytest.approx(3.0 / np.pi, rel=1e-12)
    # parallel axes: the distance 1.5, and the reduced area
    areas = np.pi * np.array([1.0, 0.25])
    own = areas @ np.array([1.0, 0.25]) / 4.0
    moment = np.array([[own + areas.prod() / areas.sum() * 1.5**2, own, 0.0]])
    assert compactness(areas.sum(keepdims=True), moment)[0] == pytest.approx(0.896, abs=1e-3)


def test_circles_are_larger_than_their_half_level_by_the_median_of_chi_square():
    for ratio, order in ((2.0, 4e-3), (10.0, 3e-6)):
        # in units of s: the half level has the radius at which the noncentral distribution has its median
        half = np.pi * chndtrinc(ratio**2, 2.0, 0.5)
        found = errors.enclosed(np.array([half]), 0.0, 1.0)[0] - np.pi * errors.INTERPOLATION
        assert found == pytest.approx(np.pi * ratio**2, rel=order)


def test_the_error_of_noise_is_least_for_the_blur_and_is_the_cramer_rao_bound():
    s, noise, length = 1.7, 0.05, np.array([80.0])
    widths = np.linspace(0.5, 4.0, 701)
    found = [errors.of_contour(length, noise, w, np.hypot(s, w), 0.0, 0.0)[0] for w in widths]
    assert widths[np.argmin(found)] == pytest.approx(s, abs=0.005)
    information, _ = quad(lambda u: norm.pdf(u, scale=s) ** 2, -20.0, 20.0)
    assert min(found) == pytest.approx(length[0] * noise / np.sqrt(length[0] * information), rel=1e-6)


def test_errors_of_level_and_blur_are_derivatives():
    # d of the half level moves a straight edge by d over its slope; s_t enters the area by pi s_t²
    total, length = 2.1, np.array([60.0])
    moved = total * (norm.ppf(0.501) - norm.ppf(0.499)) / 0.002
    assert errors.of_contour(length, 0.0, 1.5, total, 1e-3, 0.0) == pytest.approx(60e-3 * moved, rel=1e-5)
    change = np.pi * ((total + 1e-4) ** 2 - (total - 1e-4) ** 2) / 2e-4
    assert errors.of_contour(length, 0.0, 1.5, total, 0.0, 1e-2) == pytest.approx(change * 1e-2, rel=1e-6)
