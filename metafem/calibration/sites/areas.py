"""How well areas measured at the sites of a design agree with the expected ones."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.sites.search import IntArray

# Odds at which one of two placements is preferred: with equal chances before, 1 % remains for the other.
ODDS = 100.0


def log_likelihood(area: FloatArray, expected: FloatArray, site: IntArray, seen: Any) -> float:
    """Return the log-likelihood of areas (k,) at sites (k,) under the expected ones (n,), up to a constant.

    The areas are those of the law times one unknown factor, for an error of modulus or load, with normal
    errors of one unknown standard deviation. That of a site that is `seen` (n,) without a contact is 0.
    """
    measured = np.zeros(len(expected))
    measured[site[site >= 0]] = area[site >= 0]
    measured, expected = measured[seen], expected[seen]
    total, own = measured @ measured, expected @ expected
    if not total or not own:
        return 0.0
    part = max(measured @ expected, 0.0) ** 2 / (total * own)
    # areas that agree to the last digit would have an infinite likelihood
    return -0.5 * len(measured) * math.log(max(1.0 - part, np.finfo(float).eps))


def decides(likely: float, other: float) -> bool:
    """Whether a log-likelihood exceeds another clearly."""
    return likely - other >= math.log(ODDS)
