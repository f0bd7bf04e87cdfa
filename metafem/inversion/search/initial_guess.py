"""Initial guess for any law: the number of asperities that enter the contact between its samples.

From each sample to the next, the earlier asperities and a real number of new ones, whose summits are level
with the plane at the first sample, have exactly the area and load of the second (eq. S1, as for operating
points). Where the earlier asperities alone have more friction, none enter. The numbers are then spread over
the heights between the levels.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray
from metafem.contact import Hertz
from metafem.inversion.feasibility import relative_depth
from metafem.inversion.radii import Radii
from metafem.inversion.search.options import DEFAULTS, SearchOptions


def initial_heights(
    load: FloatArray, friction: FloatArray, radius: FloatArray, count: int, options: SearchOptions = DEFAULTS
) -> tuple[FloatArray, FloatArray]:
    """Return at most `count` heights, tallest first at 0, whose law is near the samples, and radii [mm].

    Asperities that enter at sample k have the k-th radius.
    """
    # for equal contacts P/A0 is proportional to the square root of the indentation
    depth = (load[0] / friction[0] / _pressure(radius[0])) ** 2
    levels, numbers, kinds = [0.0], [friction[0] / (math.pi * radius[0] * depth)], [radius[0]]
    plane, widest = -depth, float(radius.max())
    for p, f, new in zip(load[1:], friction[1:], radius[1:], strict=True):
        earlier = np.array(levels) - plane, np.array(kinds), np.array(numbers)
        depth, number = _entering(*earlier, p, f, new, widest, options.shallowest)
        if number > 0.0:
            levels.append(plane)
            numbers.append(number)
            kinds.append(new)
        plane -= depth
    return _spread(np.array(levels), np.array(numbers), np.array(kinds), plane, count)


def _entering(
    above: FloatArray, kind: FloatArray, number: FloatArray, load: float, friction: float, radius: float,
    widest: float, shallowest: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the depth of the plane below the new level, and the number of asperities that enter there.

    The earlier asperities, `number` of each radius `kind`, are `above` the new level.
    """
    per_depth = math.pi * kind * number
    per_root = Hertz().load_at_indentation(1.0, kind) * number
    total = float(per_depth.sum())
    deepest = (friction - float(per_depth @ above)) / total

    def carried(depth: float) -> float:
        return float(per_root @ (above + depth) ** 1.5)

    if deepest > 0.0 and carried(deepest) > load:
        pressure, low, area = _pressure(radius), shallowest * deepest, deepest * total

        def excess(depth: float) -> float:  # eq. S1: load, with as many new asperities as the area needs
            return carried(depth) + (area - depth * total) * pressure * math.sqrt(depth) - load

        depth = _root(excess, low, deepest, low) if excess(low) < 0.0 else low
        return depth, (deepest - depth) * total / (math.pi * radius * depth)
    if carried(0.0) >= load:
        return 0.0, 0.0
    high = widest
    while carried(high) < load:
        high *= 2.0
    return _root(lambda depth: carried(depth) - load, 0.0, high, high), 0.0


def _root(function: Callable[[float], float], low: float, high: float, scale: float) -> float:
    return float(brentq(function, low, high, xtol=1e-12 * scale, rtol=1e-12))


def slowest_law(load: float, friction: float, radii: Radii, count: int) -> tuple[FloatArray, FloatArray]:
    """Return at most `count` heights, and radii [mm], of the law of least slope at a point."""
    k, s = math.sqrt(radii.low / radii.high), relative_depth(radii)
    small = 1.0 / (k * s) ** 3  # small caps for each large one
    # sums of a^3/R and of a^2 for one large cap with a/R = 1 and its small caps
    cubes, squares = (radii.high**2 * (1.0 + small * k**4 * s**power) for power in (6.0, 4.0))
    # P/A0 where the large caps have a/R = 1, and their a/R
    ratio = float(Hertz().load(1.0, 1.0)) * cubes / (math.pi * squares)
    slope = load / friction / ratio
    large = friction / (math.pi * squares * slope**2)
    large *= min(1.0, count / (large * (1.0 + small)))
    numbers = max(1, round(large)), max(1, round(large * small))
    deeper = radii.high * slope**2 - radii.low * (slope * s * s) ** 2
    height = np.repeat([0.0, -deeper], numbers)
    radius = np.repeat([radii.high, radii.low], numbers)
    return height[:count], radius[:count]


def _pressure(radius: float) -> float:
    """Return P/E* over A0 of a contact at unit indentation [1/mm^(1/2)]."""
    law = Hertz()
    return float(law.load_at_indentation(1.0, radius) / law.area(law.contact_radius(1.0, radius)))


def _spread(
    levels: FloatArray, numbers: FloatArray, kinds: FloatArray, plane: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return a whole number of asperities, spread evenly from each level half-way to its neighbours."""
    ends = np.append(np.insert(0.5 * (levels[1:] + levels[:-1]), 0, levels[0]), 0.5 * (levels[-1] + plane))
    total = np.insert(np.cumsum(numbers), 0, 0.0)
    most = min(count, max(1, math.ceil(total[-1])))
    middle = (np.arange(most) + 0.5) / most * total[-1]
    level = np.minimum(np.searchsorted(total[1:], middle), len(kinds) - 1)
    return np.interp(middle, total, ends), kinds[level]
