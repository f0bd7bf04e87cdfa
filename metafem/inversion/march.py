"""A first guess for any law: asperities that enter in the right numbers, load by load.

Between two samples the asperities that are there and a real number of new ones, level with the plane at
the first sample, carry the second one exactly, as S1 has it for operating points; where they already
give more friction, none enter. The numbers are then spread over the heights between the levels.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray

# An indentation this much smaller than where no asperity enters means numbers beyond any surface.
SHALLOWEST = 1e-9


def march(load: FloatArray, friction: FloatArray, radius: float, count: int) -> FloatArray:
    """Return heights [mm], at most `count`, tallest first at 0, whose law is near the samples."""
    root = 4.0 / 3.0 * math.sqrt(radius)
    depth = (math.pi * radius * load[0] / (root * friction[0])) ** 2
    levels, numbers = [0.0], [friction[0] / (math.pi * radius * depth)]
    plane = -depth
    for p, f in zip(load[1:], friction[1:], strict=True):
        lead, number = np.array(levels) - plane, np.array(numbers)
        spent = math.pi * radius * float(number @ lead)

        def carried(depth: float, lead: FloatArray = lead, number: FloatArray = number) -> float:
            return float(root * (number @ (lead + depth) ** 1.5))

        deepest = (f - spent) / (math.pi * radius * float(number.sum()))
        if deepest > 0.0 and carried(deepest) > p:
            whole = float(number.sum())

            def excess(depth: float, p: float = p, deepest: float = deepest, whole: float = whole) -> float:
                new = (deepest - depth) * whole / depth
                return carried(depth) + new * root * math.sqrt(depth) * depth - p

            low = SHALLOWEST * deepest
            depth = float(brentq(excess, low, deepest, rtol=1e-12)) if excess(low) < 0.0 else low
            levels.append(plane)
            numbers.append((deepest - depth) * whole / depth)
        else:
            depth = _depth_at(carried, p, radius)
        plane -= depth
    return _spread(np.array(levels), np.array(numbers), plane, count)


def _depth_at(carried: Callable[[float], float], load: float, radius: float) -> float:
    """Return the depth at which the asperities carry a load; 0 where they already carry more."""
    if carried(0.0) >= load:
        return 0.0
    high = radius
    while carried(high) < load:
        high *= 2.0
    return float(brentq(lambda depth: carried(depth) - load, 0.0, high, rtol=1e-12))


def _spread(levels: FloatArray, numbers: FloatArray, plane: float, count: int) -> FloatArray:
    """Deal whole asperities evenly over the levels, each spread half-way to its neighbours."""
    ends = np.append(np.insert(0.5 * (levels[1:] + levels[:-1]), 0, levels[0]), 0.5 * (levels[-1] + plane))
    total = np.insert(np.cumsum(numbers), 0, 0.0)
    whole = min(count, max(1, math.ceil(total[-1])))
    return np.asarray(np.interp((np.arange(whole) + 0.5) / whole * total[-1], total, ends))
