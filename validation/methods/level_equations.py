"""Levels of heights that reach operating points, from the printed eq. S1 by a bracketed root finder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from validation.methods.independent import FloatArray

# Intervals of the separation in which a change of sign is looked for.
INTERVALS = 400


class Levels(NamedTuple):
    """Numbers of asperities, heights of levels and of adjustment asperities, and planes, (k,) [mm]."""

    count: FloatArray
    level: FloatArray
    adjustment: FloatArray
    plane: FloatArray


def levels(load: Sequence[float], friction: Sequence[float], top: float, radius: float) -> Levels:
    """Solve eq. S1 for the points one after the other, with the steps that the paper states.

    n_i is the integer part of the solution of both equations without the adjustment asperity, and h_{i,a}
    their solution with it. The next level is at the plane that belongs to it.
    """
    found: list[tuple[float, float, float, float]] = []
    height = np.zeros(0)
    for p, f in zip(load, friction, strict=True):
        sum_1, sum_15 = f / (np.pi * radius), 0.75 * p / np.sqrt(radius)

        def number(plane: float, depth: float = sum_1, above: FloatArray = height, top: float = top) -> float:
            return float((depth - (above - plane).sum()) / (top - plane))

        def short(plane: float, total: float = sum_15, above: FloatArray = height, top: float = top) -> float:
            rest = total - ((above - plane) ** 1.5).sum()
            return float(rest - number(plane) * (top - plane) ** 1.5)

        count = np.floor(number(_root(short, top)))
        height = np.append(height, np.full(int(count), top))

        def added(plane: float, depth: float = sum_1, above: FloatArray = height) -> float:
            return float(depth - (above - plane).sum())

        def left(plane: float, total: float = sum_15, above: FloatArray = height) -> float:
            last = max(added(plane), 0.0)
            return float(total - ((above - plane) ** 1.5).sum() - last**1.5)

        plane = _root(left, top, lambda plane, top=top: 0.0 <= added(plane) <= top - plane)
        height = np.append(height, plane + added(plane))
        found.append((count, top, height[-1], plane))
        top = plane
    return Levels(*np.array(found).T)


def _root(
    function: Callable[[float], float], top: float, meant: Callable[[float], bool] = lambda plane: True
) -> float:
    """Return the highest separation below a level that is a root and is meant."""
    edges = top * (1.0 - np.arange(1, INTERVALS + 1) / INTERVALS)
    values = [function(edge) for edge in edges]
    for upper, lower, first, second in zip(edges[:-1], edges[1:], values[:-1], values[1:], strict=True):
        if first * second <= 0.0 and meant(found := float(brentq(function, lower, upper, xtol=1e-16))):
            return found
    raise ArithmeticError("no height of the asperities solves eq. S1 at this point")
