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


def tilt_variance(position: ArrayLike, gradient: ArrayLike, largest: float, steps: int) -> float:
    """Variance of a linear function of the heights, with a gradient (n,), over uniform tilts about both axes.

    Both angles are the middles of equal steps of [-largest, largest] [rad].
    """
    angle = largest * ((np.arange(steps) + 0.5) / steps * 2.0 - 1.0)
    x, y = np.asarray(gradient, dtype=float) @ np.asarray(position, dtype=float)
    change = x * np.tan(angle)[:, None] + y * np.tan(angle)
    return float((change**2).mean() - change.mean() ** 2)
