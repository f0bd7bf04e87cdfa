"""Intervals of moments cover their exact values."""

import numpy as np
from numpy.testing import assert_allclose

from metafem.studies.sampling.moments import moments
from tests.core.studies.test_moments import EXACT_MEAN, EXACT_SD, drawn, total


def test_errors_cover_the_exact_moments():
    """68 % of 500 repetitions, five standard deviations of their number."""
    hits = np.zeros(2)
    for seed in range(500):
        found = moments(total(drawn(seed)))
        hits += np.abs(found.value[:, 0] - [EXACT_MEAN, EXACT_SD]) <= found.error[:, 0]
    assert_allclose(hits / 500, 0.68, atol=5 * np.sqrt(0.68 * 0.32 / 500))
