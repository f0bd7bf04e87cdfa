"""68 % intervals of a quantity that cannot be negative, although its estimate can."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize.elementwise import find_root
from scipy.special import ndtr

from metafem._validate import FloatArray

# Probability that an interval contains the mean. Half-width of the normal interval with this probability, in
# standard deviations.
PROBABILITY, WIDTH = 0.68, 0.9944578832

# Table of means: smallest mean, in standard deviations of the estimate, and number of means.
SMALLEST_MEAN, MEANS = 1e-4, 4000


def bounded_interval(estimate: ArrayLike, sd: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper ends of the 68 % intervals of nonnegative means, from normal estimates.

    The estimates may be negative. For every mean, 0 included, the interval contains the mean in 68 % of
    repeated measurements; no interval is empty. Far above 0 an interval is symmetric about the estimate. The
    method is that of Feldman and Cousins, Phys. Rev. D 57, 3873 (1998), doi:10.1103/PhysRevD.57.3873: for
    each mean, estimates are ranked by the ratio of their likelihood to the likelihood of the most probable
    nonnegative mean.

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
    """Return the lower and upper end of the 68 % interval of a nonnegative mean, from one estimate."""
    low, high = bounded_interval(estimate, math.sqrt(variance))
    return float(low), float(high)


@lru_cache
def _accepted() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return means up to WIDTH, and the lowest and the highest accepted estimate of each, (MEANS,).

    For a mean m, the accepted estimates lie between ``m - (m^2 + t^2)/(2 m)`` and ``m + t``. The likelihood
    ratio is equal at the two ends.
    """
    mean = np.geomspace(SMALLEST_MEAN, WIDTH, MEANS)

    def excess(t: FloatArray, m: FloatArray) -> FloatArray:
        return np.asarray(ndtr(t) - ndtr(-(m**2 + t**2) / (2.0 * m)) - PROBABILITY)

    t = find_root(excess, (np.zeros(MEANS), np.full(MEANS, 2.0)), args=(mean,)).x
    return mean, mean - (mean**2 + t**2) / (2.0 * mean), mean + t
