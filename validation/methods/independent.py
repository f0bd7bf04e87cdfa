"""Independent Hertz contacts of one radius: sums over the heights, and Newton's method for the approach."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

# Steps of Newton's method, of which about eight are needed, and the size of the last one relative to the
# approach, some units of rounding.
STEPS, LAST = 100, 1e-15


def sums(depth: ArrayLike, radius: float) -> tuple[FloatArray, FloatArray]:
    """Areas [mm²] and loads P/E* [mm²] of indentations (…, n) [mm], summed over n; negative ones are open."""
    closed = np.clip(depth, 0.0, None)
    area = np.pi * radius * closed.sum(axis=-1)
    return area, 4.0 / 3.0 * np.sqrt(radius) * (closed * np.sqrt(closed)).sum(axis=-1)


def approaches(height: ArrayLike, load: ArrayLike, radius: float) -> FloatArray:
    """Approaches (…, k) [mm] of heights (…, n) [mm] at which they carry loads (k,) [mm²].

    The load is a convex function of the approach: Newton's method decreases from an upper bound.
    """
    heights, loads = np.asarray(height, dtype=float), np.asarray(load, dtype=float)
    gap = (heights.max(axis=-1, keepdims=True) - heights)[..., None, :]
    # the tallest alone carries each load at this approach
    approach = np.empty((*heights.shape[:-1], len(loads)))
    approach[...] = (0.75 * loads / np.sqrt(radius)) ** (2.0 / 3.0)
    for _ in range(STEPS):
        root = np.sqrt(np.clip(approach[..., None] - gap, 0.0, None))
        carried = 4.0 / 3.0 * np.sqrt(radius) * (root**3).sum(axis=-1)
        step = (carried - loads) / (2.0 * np.sqrt(radius) * root.sum(axis=-1))
        approach = approach - step
        if np.all(step <= LAST * approach):
            return approach
    raise ArithmeticError("Newton's method for the approach does not converge")


def areas(height: ArrayLike, load: ArrayLike, radius: float) -> FloatArray:
    """Areas A0 (…, k) [mm²] of heights (…, n) [mm] at loads P/E* (k,) [mm²]."""
    heights = np.asarray(height, dtype=float)
    gap = (heights.max(axis=-1, keepdims=True) - heights)[..., None, :]
    return sums(approaches(heights, load, radius)[..., None] - gap, radius)[0]


def fitted_slope(height: ArrayLike, load: ArrayLike, radius: float) -> FloatArray:
    """Slopes [-] of the straight lines of least squares through the laws of heights (…, n) at loads (k,)."""
    loads = np.asarray(load, dtype=float)
    weight = (loads - loads.mean()) / ((loads - loads.mean()) ** 2).sum()
    return areas(height, loads, radius) @ weight
