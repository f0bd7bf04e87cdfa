"""Intervals of quantities that are not negative, against the published table and by simulation."""

import numpy as np
import pytest
from scipy.special import ndtr

from metafem.calibration.bounded_interval import PROBABILITY, WIDTH, bounded_interval


@pytest.mark.parametrize(
    ("estimate", "low", "high"),
    # Feldman and Cousins, Phys. Rev. D 57, 3873 (1998), table X, 68.27 %: here 68 %, within 0.01
    [
        (-3.0, 0.0, 0.04),
        (-1.0, 0.0, 0.27),
        (0.0, 0.0, 1.0),
        (0.5, 0.02, 1.5),
        (1.0, 0.24, 2.0),
        (3.0, 2.0, 4.0),
    ],
)
def test_the_published_table(estimate, low, high):
    assert np.ravel(bounded_interval(estimate, 1.0)) == pytest.approx([low, high], abs=0.012)


@pytest.mark.parametrize("mean", [0.0, 0.1, 0.5, 1.0, 2.0])
def test_every_mean_is_covered_equally(mean):
    x = np.linspace(mean - 8.0, mean + 8.0, 200_001)
    low, high = bounded_interval(x, 1.0)
    step = np.diff(ndtr(x - mean))
    inside = (low <= mean) & (mean <= high)
    assert (step * inside[1:]).sum() == pytest.approx(PROBABILITY, abs=2e-4)


def test_intervals_scale_and_are_never_empty():
    x = np.linspace(-30.0, 30.0, 301)
    low, high = bounded_interval(x, 1.0)
    assert (high > low).all()
    assert (low >= 0.0).all()
    assert (np.diff(high) >= 0.0).all()
    wide = bounded_interval(2.5 * x, 2.5)
    assert wide[0] == pytest.approx(2.5 * low)
    assert wide[1] == pytest.approx(2.5 * high)
    assert 2.0 * ndtr(WIDTH) - 1.0 == pytest.approx(PROBABILITY, abs=1e-9)
