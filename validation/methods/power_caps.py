"""Independent contacts of power caps: sums over the heights, and bisection of the approach."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from metafem.reference.single_contacts import power_law

FloatArray = NDArray[np.float64]

# Halvings of the interval of the approach, after which its width is less than rounding.
HALVINGS = 60


def areas(height: FloatArray, load: FloatArray, coefficient: float, exponent: float) -> FloatArray:
    """Return A0 (k,) [mm²] of heights (n,) [mm] at loads P/E* (k,) [mm²]; the caps are c r^exponent [mm]."""
    unit_load, unit_depth = power_law(1.0, coefficient, exponent)
    gap = height.max() - height
    # the tallest alone would carry the load at this approach
    high = unit_depth * (load / unit_load) ** (exponent / (exponent + 1.0))
    low = np.zeros_like(high)

    def radii(approach: FloatArray) -> FloatArray:
        depth = np.clip(approach[:, None] - gap, 0.0, None)
        return np.asarray((depth / unit_depth) ** (1.0 / exponent))

    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        light = unit_load * (radii(middle) ** (exponent + 1.0)).sum(axis=1) < load
        low, high = np.where(light, middle, low), np.where(light, high, middle)
    return np.asarray(np.pi * (radii(high) ** 2).sum(axis=1))
