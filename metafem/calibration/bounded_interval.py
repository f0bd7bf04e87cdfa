"""68 % intervals of a quantity that cannot be negative, from an estimate that can."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize.elementwise import find_root
from scipy.special import ndtr

from metafem._validate import FloatArray

# Probability of an interval, and half its width for a normal distribution, in standard deviations.
PROBABILITY, WIDTH = 0.68, 0.9944578832

# Means in standard deviations at which the intervals of the estimates are computed.
SMALLEST_MEAN, MEANS = 1e-4, 4000


def bounded_interval(estimate: ArrayLike, sd: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the 68 % intervals of means that are at least 0, from normal estimates of any sign.

    They contain the mean in 68 % of the draws for every mean, 0 included, and are never empty. Far above 0
    they are symmetric about the estimate. Feldman and Cousins, Phys. Rev. D 57, 3873 (1998),
    doi:10.1103/PhysRevD.57.3873: the estimates of a mean are ranked by the ratio of their likelihood to that
    of the best mean that is at least 0.

    Examples
    --------
    >>> low, high = bounded_interval([3.0, 0.3, -1.0], 1.0)
    >>> low.round(2), high.round(2)
    (array([2.01, 0.  , 0.  ]), array([3.99, 1.29, 0.27]))
    """
    mean, first, last = _accepted()
    x = np.divide(estimate, sd)
    low = np.where(x >= last[-1], x - WIDTH, np.interp(x, last, mean, left=0.0))
    high = np.where(x >= first[-1], x + WIDTH, np.interp(x, first, mean))
    return np.asarray(low * sd), np.asarray(high * sd)


def interval_of(estimate: float, variance: float) -> tuple[float, float]:
    """Return the 68 % interval of one mean that is at least 0, from an estimate and its variance."""
    low, high = bounded_interval(estimate, math.sqrt(variance))
    return float(low), float(high)


@lru_cache
def _accepted() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return means up to WIDTH, and the lowest and highest estimates that are accepted for each.

    Estimates from ``m - (m^2 + t^2)/(2 m)``, where the ratio is that of ``m + t``, to ``m + t``.
    """
    mean = np.geomspace(SMALLEST_MEAN, WIDTH, MEANS)

    def excess(t: FloatArray, m: FloatArray) -> FloatArray:
        return np.asarray(ndtr(t) - ndtr(-(m**2 + t**2) / (2.0 * m)) - PROBABILITY)

    t = find_root(excess, (np.zeros(MEANS), np.full(MEANS, 2.0)), args=(mean,)).x
    return mean, mean - (mean**2 + t**2) / (2.0 * mean), mean + t
