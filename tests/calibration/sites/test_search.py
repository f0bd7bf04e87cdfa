from __future__ import annotations

import numpy as np

from metafem.calibration.sites.search import Pose, complex_points, fitted, real_points


def test_the_fit_has_the_least_squares():
    """Any small change of the fitted numbers raises the sum of squares."""
    rng = np.random.default_rng(0)
    points, sites = rng.normal(size=(2, 8)) + 1j * rng.normal(size=(2, 8))
    found = fitted(points, sites)

    def squares(factor, shift):
        return np.sum(np.abs(points - Pose(factor, shift).image(sites)) ** 2)

    least = squares(found.factor, found.shift)
    for step in (1e-3, -1e-3, 1e-3j, -1e-3j):
        assert squares(found.factor + step, found.shift) > least
        assert squares(found.factor, found.shift + step) > least


def test_points_as_complex_numbers():
    points = np.array([[1.0, 2.0], [-3.0, 0.5]])
    np.testing.assert_array_equal(real_points(complex_points(points)), points)
    np.testing.assert_array_equal(real_points(complex_points(points, mirrored=True)), points * [-1.0, 1.0])
