"""Independent contacts of power caps: sums over the heights, and bisection of the approach."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from metafem.reference.single_contacts import power_law

FloatArray = NDArray[np.float64]

# Halvings of the interval of the approach, after which its width is less than rounding.
HALVINGS = 60


def areas(
    height: FloatArray, load: FloatArray, coefficient: float | FloatArray, exponent: float | FloatArray
) -> FloatArray:
    """Return A0 (k,) [mm²] of heights (n,) [mm] at loads P/E* (k,) [mm²]; cap i is c_i r^n_i [mm]."""
    c, n = (np.broadcast_to(values, height.shape) for values in (coefficient, exponent))
    unit_load, unit_depth = np.array([power_law(1.0, *one) for one in zip(c, n, strict=True)]).T
    gap, first = height.max() - height, height.argmax()
    # the tallest alone would carry the load at this approach
    high = unit_depth[first] * (load / unit_load[first]) ** (n[first] / (n[first] + 1.0))
    low = np.zeros_like(high)

    def radii(approach: FloatArray) -> FloatArray:
        depth = np.clip(approach[:, None] - gap, 0.0, None)
        return np.asarray((depth / unit_depth) ** (1.0 / n))

    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        light = (unit_load * radii(middle) ** (n + 1.0)).sum(axis=1) < load
        low, high = np.where(light, middle, low), np.where(light, high, middle)
    return np.asarray(np.pi * (radii(high) ** 2).sum(axis=1))
