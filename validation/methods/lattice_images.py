"""Sums of an influence over the periods of a cell, one by one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from validation.methods.independent import FloatArray


def image_sum(
    influence: Callable[[FloatArray], FloatArray],
    sides: tuple[float, float],
    x: float,
    y: float,
    reach: float,
) -> float:
    """Return the influence at (x, y) [mm] of a point in all periods whose shift is at most `reach` [mm]."""
    i, j = (side * np.arange(-int(reach / side), int(reach / side) + 1) for side in sides)
    dx, dy = np.meshgrid(x - i, y - j)
    near = np.hypot(dx - x, dy - y) <= reach
    return float(influence(np.hypot(dx, dy)[near]).sum())
