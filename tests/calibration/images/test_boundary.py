"""Contours against scikit-image's, and moments against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label
from skimage.measure import euler_number, find_contours

from metafem.calibration.images.boundary import compactness, contours
from validation.scenes.pictures import coverage


@settings(max_examples=40, deadline=None)
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


def test_an_image_without_regions_has_no_contours():
    found = contours(np.ones((9, 9), dtype=np.float32), np.zeros((9, 9), dtype=np.int32), 0.5, 0)
    assert found.area.shape == (0,)
    assert found.centre.shape == (0, 2)


@pytest.mark.parametrize(("a", "b", "angle"), [(3.0, 3.0, 0.0), (5.0, 2.0, 0.3), (9.0, 1.0, 1.2)])
def test_ellipses_have_the_compactness_one(a, b, angle):
    cos, sin = np.cos(angle), np.sin(angle)
    second = [(a * cos) ** 2 + (b * sin) ** 2, (a * sin) ** 2 + (b * cos) ** 2, (a * a - b * b) * sin * cos]
    area = np.pi * a * b
    assert compactness(np.array([area]), area / 4.0 * np.array([second]))[0] == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(("ratio", "expected"), [(1.0, 0.894), (0.5, 0.896), (0.3, 0.945)])
def test_circles_that_touch(ratio, expected):
    # parallel axes: the distance 1 + ratio, and the reduced area
    areas = np.pi * np.array([1.0, ratio**2])
    own = areas @ np.array([1.0, ratio**2]) / 4.0
    moment = np.array([[own + areas.prod() / areas.sum() * (1.0 + ratio) ** 2, own, 0.0]])
    assert compactness(areas.sum(keepdims=True), moment)[0] == pytest.approx(expected, abs=1e-3)


def test_squares():
    moment = np.array([[1.0 / 12.0, 1.0 / 12.0, 0.0]])
    assert compactness(np.ones(1), moment)[0] == pytest.approx(3.0 / np.pi, rel=1e-12)
