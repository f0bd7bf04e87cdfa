"""Initial guess for any law: the number of asperities that enter the contact between its samples.

From each sample to the next, the earlier asperities and a real number of new ones, whose summits are level
with the plane at the first sample, have exactly the area and load of the second (eq. S1, as for operating
points). Where the earlier asperities alone have more friction, none enter. The numbers are then spread over
the heights between the levels.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

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
    plane = -depth
    for p, f, new in zip(load[1:], friction[1:], radius[1:], strict=True):
        above, kind = np.array(levels) - plane, np.array(kinds)
        per_depth = math.pi * kind * np.array(numbers)
        per_root = Hertz().load_at_indentation(1.0, kind) * np.array(numbers)
        total = float(per_depth.sum())
        deepest = (f - float(per_depth @ above)) / total
        if deepest > 0.0 and _load(deepest, above, per_root) > p:
            low, pressure = options.shallowest * deepest, _pressure(new)
            arguments = (above, per_root, total, deepest, pressure, p)
            depth = low
            if _excess(low, *arguments) < 0.0:
                depth = float(brentq(_excess, low, deepest, arguments, xtol=1e-12 * low, rtol=1e-12))
            levels.append(plane)
            numbers.append((deepest - depth) * total / (math.pi * new * depth))
            kinds.append(new)
        else:
            depth = _depth_at(partial(_load, above=above, per_root=per_root), p, float(radius.max()))
        plane -= depth
    return _spread(np.array(levels), np.array(numbers), np.array(kinds), plane, count)


def _load(depth: float, above: FloatArray, per_root: FloatArray) -> float:
    """Return the load of the earlier asperities at a depth of the plane below the new level [mm^2]."""
    return float(per_root @ (above + depth) ** 1.5)


def _excess(
    depth: float,
    above: FloatArray,
    per_root: FloatArray,
    per_depth: float,
    deepest: float,
    pressure: float,
    load: float,
) -> float:
    """Return the load, with as many new asperities as the area needs, minus that of the sample (eq. S1)."""
    area = deepest * per_depth - depth * per_depth
    return _load(depth, above, per_root) + area * pressure * math.sqrt(depth) - load


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


def _depth_at(carried: Callable[[float], float], load: float, radius: float) -> float:
    """Return the depth at which the asperities carry a load; 0 where they already carry more."""
    if carried(0.0) >= load:
        return 0.0
    high = radius
    while carried(high) < load:
        high *= 2.0
    return float(brentq(lambda depth: carried(depth) - load, 0.0, high, xtol=1e-12 * high, rtol=1e-12))


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
