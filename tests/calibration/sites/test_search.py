from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from metafem.calibration.sites.search import Similarity, complex_points, fitted, real_points


@settings(deadline=None)
@given(st.integers(0, 10**6))
def test_a_similarity_is_found_again(seed):
    rng = np.random.default_rng(seed)
    similarity = Similarity(complex(*rng.normal(size=2)), complex(*rng.normal(size=2)))
    sites = rng.normal(size=5) + 1j * rng.normal(size=5)
    found = fitted(similarity.image(sites), sites)
    np.testing.assert_allclose(found.image(sites), similarity.image(sites), atol=1e-13)
    np.testing.assert_allclose(similarity.sites(similarity.image(sites)), sites, rtol=1e-9, atol=1e-9)


def test_the_fit_has_the_least_squares():
    """Any small change of the fitted numbers raises the sum of squares."""
    rng = np.random.default_rng(0)
    points, sites = rng.normal(size=(2, 8)) + 1j * rng.normal(size=(2, 8))
    found = fitted(points, sites)

    def squares(factor, shift):
        return np.sum(np.abs(points - Similarity(factor, shift).image(sites)) ** 2)

    least = squares(found.factor, found.shift)
    for step in (1e-3, -1e-3, 1e-3j, -1e-3j):
        assert squares(found.factor + step, found.shift) > least
        assert squares(found.factor, found.shift + step) > least


def test_points_as_complex_numbers():
    points = np.array([[1.0, 2.0], [-3.0, 0.5]])
    np.testing.assert_array_equal(real_points(complex_points(points)), points)
    np.testing.assert_array_equal(real_points(complex_points(points, mirrored=True)), points * [-1.0, 1.0])
