"""Intervals of moments cover their exact values."""

import numpy as np
from numpy.testing import assert_allclose

from metafem.studies.sampling.moments import moments
from metafem.studies.sampling.points import unit_points
from tests.core.studies.test_moments import EXACT_MEAN, EXACT_SD, drawn, total


def test_errors_cover_the_exact_moments():
    """68 % of 500 repetitions, five standard deviations of their number."""
    hits = np.zeros(2)
    for seed in range(500):
        found = moments(total(drawn(seed)))
        hits += np.abs(found.value[:, 0] - [EXACT_MEAN, EXACT_SD]) <= found.error[:, 0]
    assert_allclose(hits / 500, 0.68, atol=5 * np.sqrt(0.68 * 0.32 / 500))


def test_batches_together_are_uniform():
    size = 4
    points = np.concatenate([unit_points(1, batch, size, 2) for batch in range(2000 // size)])
    assert np.abs(points.mean(axis=0) - 0.5).max() < 5.0 / np.sqrt(12.0 * len(points))
