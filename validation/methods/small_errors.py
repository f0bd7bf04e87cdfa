"""Errors of products and of laws: propagation of small errors, and plain draws."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.methods.independent import areas


def relative_error(*relative: float) -> float:
    """Relative standard deviation of a product or quotient of factors with small independent ones."""
    return math.sqrt(sum(each**2 for each in relative))


def drawn_deviation(
    height: ArrayLike,
    radius: tuple[float, float],
    modulus: tuple[float, float],
    load: ArrayLike,
    load_sd: float,
    draws: int,
) -> NDArray[np.float64]:
    """Standard deviation of A0 (k,) [mm²] at loads (k,) [N] over normal draws of R, E* and P.

    Radius [mm] and composite modulus [MPa] are pairs of mean and standard deviation. With depths d the area
    is ``R pi sum d`` where ``P/(E* sqrt(R)) = 4/3 sum d^(3/2)``: the law of radius 1 gives all others.
    """
    loads = np.asarray(load, dtype=float)
    r, e, p = np.random.default_rng(1).standard_normal((3, draws, 1))
    drawn = radius[0] + r * radius[1]
    force = (loads + p * load_sd) / (modulus[0] + e * modulus[1])
    if force.min() <= 0.0:
        raise ValueError(f"load = {loads.min():g} N is drawn as 0 or less")
    found = areas(height, (force / np.sqrt(drawn)).ravel(), 1.0).reshape(force.shape)
    return np.asarray((drawn * found).std(axis=0, ddof=1))
