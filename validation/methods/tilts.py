"""The slope of a law while the plane is tilted, by plain sums over the angles."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.methods.independent import fitted_slope


def slope_scatter(
    position: ArrayLike, height: ArrayLike, load: ArrayLike, radius: float, largest: float, steps: int
) -> NDArray[np.float64]:
    """Standard deviation of the fitted slope over angles in [-largest, largest] [rad], over the slope at 0.

    The heights (…, n) [mm] of each list grow by ``(x + y) tan(angle)`` at the sites (n, 2) [mm]; the angles
    are 2 steps + 1 equal steps, of which the first and the last count half.
    """
    heights = np.asarray(height, dtype=float)
    angle = np.linspace(-largest, largest, 2 * steps + 1)
    rise = np.tan(angle)[:, None] * np.asarray(position, dtype=float).sum(axis=1)
    slopes = fitted_slope(heights[..., None, :] + rise, load, radius)
    weight = np.full(len(angle), 1.0)
    weight[[0, -1]] = 0.5
    weight /= weight.sum()
    mean = (slopes @ weight)[..., None]
    return np.asarray(np.sqrt((slopes - mean) ** 2 @ weight) / slopes[..., steps])
