"""Independent Hertz contacts of one radius: sums over the heights, and bisection of the approach."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

# Halvings of the interval of the approach, after which its width is less than rounding.
HALVINGS = 60


def sums(depth: ArrayLike, radius: float) -> tuple[FloatArray, FloatArray]:
    """Areas [mm²] and loads P/E* [mm²] of indentations (…, n) [mm], summed over n; negative ones are open."""
    closed = np.clip(depth, 0.0, None)
    area = np.pi * radius * closed.sum(axis=-1)
    return area, 4.0 / 3.0 * np.sqrt(radius) * (closed * np.sqrt(closed)).sum(axis=-1)


def approaches(height: ArrayLike, load: ArrayLike, radius: float) -> FloatArray:
    """Approaches (…, k) [mm] of heights (…, n) [mm] at which they carry loads (k,) [mm²]."""
    heights, loads = np.asarray(height, dtype=float), np.asarray(load, dtype=float)
    gap = (heights.max(axis=-1, keepdims=True) - heights)[..., None, :]
    # the tallest alone would carry the largest load at this approach
    most = (0.75 * loads.max() / np.sqrt(radius)) ** (2.0 / 3.0)
    low = np.zeros((*heights.shape[:-1], len(loads)))
    high = np.full_like(low, most)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        light = sums(middle[..., None] - gap, radius)[1] < loads
        low, high = np.where(light, middle, low), np.where(light, high, middle)
    return high


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
