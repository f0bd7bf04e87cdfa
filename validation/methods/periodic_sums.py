"""Influence of point loads on a half-space that repeat with a rectangular cell, by Ewald's method."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import erf, erfc

from validation.methods.independent import FloatArray


def influence(position: FloatArray, width: float, length: float) -> FloatArray:
    """Return the influence (n, n) [1/mm] of loads P/E* in all periods, relative to the mean displacement."""
    x, y = np.moveaxis(position[:, None, :] - position, -1, 0)
    r = np.hypot(x, y)
    np.fill_diagonal(r, np.inf)
    return np.asarray(1.0 / (np.pi * r) + _others(x, y, width, length))


def _others(x: FloatArray, y: FloatArray, width: float, length: float) -> FloatArray:
    """Return the sum over all periods but the source itself, relative to its mean [1/mm]."""
    cell, alpha = width * length, math.sqrt(math.pi / (width * length))
    total = np.full(x.shape, -2.0 / (math.sqrt(math.pi) * alpha * cell))
    reach = [math.ceil(6.0 / (alpha * side)) + 1 for side in (width, length)]
    for i in range(-reach[0], reach[0] + 1):
        for j in range(-reach[1], reach[1] + 1):
            r = np.hypot(x - i * width, y - j * length)
            if i or j:
                near = r < 6.5 / alpha
                total[near] += erfc(alpha * r[near]) / (np.pi * r[near])
            else:  # erfc - 1 = -erf; at r = 0 its limit
                own = np.where(
                    r > 0.0, erf(alpha * r) / np.where(r > 0.0, r, 1.0), 2.0 * alpha / math.sqrt(math.pi)
                )
                total -= own / np.pi
    last = [math.ceil(6.0 * alpha * side / np.pi) for side in (width, length)]
    for i in range(-last[0], last[0] + 1):
        for j in range(-last[1], last[1] + 1):
            q = 2.0 * np.pi * math.hypot(i / width, j / length)
            if 0.0 < q < 12.0 * alpha:
                wave = np.cos(2.0 * np.pi * (i * x / width + j * y / length))
                total += 2.0 / (q * cell) * erfc(q / (2.0 * alpha)) * wave
    return total
