"""The contour of a region, and formulas of the errors against closed forms and simulation."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import chndtrinc
from scipy.stats import norm

from metafem.calibration import images as errors
from metafem.calibration.images import contour


def test_a_region_with_a_hole_has_the_area_and_the_length_of_its_contours():
    image = np.ones((60, 70), dtype=np.float32)
    image[10:40, 15:55], image[20:25, 30:40] = 0.0, 1.0
    area, perimeter, holes = contour(image, 0.5)
    # the corners of the polygons are cut by triangles of half a pixel
    assert (area, holes) == (pytest.approx(30 * 40 - 5 * 10, abs=1.1), 1)
    assert perimeter == pytest.approx(2 * (70 + 15) - 8 * (1.0 - np.sqrt(0.5)), abs=1e-9)
    assert contour(image, -1.0)[0] == 0.0


def test_circles_are_larger_than_their_half_level_by_the_median_of_chi_square():
    for ratio, order in ((2.0, 4e-3), (10.0, 3e-6)):
        # in units of s: the half level has the radius at which the noncentral distribution has its median
        half = np.pi * chndtrinc(ratio**2, 2.0, 0.5)
        found = errors.enclosed(half, 0, 1.0) - np.pi * errors.INTERPOLATION
        assert found == pytest.approx(np.pi * ratio**2, rel=order)


def test_the_error_of_noise_is_least_for_the_blur_and_is_the_cramer_rao_bound():
    s, noise, length = 1.7, 0.05, 80.0
    widths = np.linspace(0.5, 4.0, 701)
    found = [errors.of_contour(length, noise, w, np.hypot(s, w), 0.0, 0.0) for w in widths]
    assert widths[np.argmin(found)] == pytest.approx(s, abs=0.005)
    information, _ = quad(lambda u: norm.pdf(u, scale=s) ** 2, -20.0, 20.0)
    assert min(found) == pytest.approx(length * noise / np.sqrt(length * information), rel=1e-6)


def test_errors_of_level_and_blur_are_derivatives():
    # d of the half level moves a straight edge by d over its slope; s_t enters the area by pi s_t²
    total, length = 2.1, 60.0
    moved = total * (norm.ppf(0.501) - norm.ppf(0.499)) / 0.002
    assert errors.of_contour(length, 0.0, 1.5, total, 1e-3, 0.0) == pytest.approx(60e-3 * moved, rel=1e-5)
    change = np.pi * ((total + 1e-4) ** 2 - (total - 1e-4) ** 2) / 2e-4
    assert errors.of_contour(length, 0.0, 1.5, total, 0.0, 1e-2) == pytest.approx(change * 1e-2, rel=1e-6)
