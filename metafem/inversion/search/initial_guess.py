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
    plane = -depth
    for p, f, new_radius in zip(load[1:], friction[1:], radius[1:], strict=True):
        lead, kind = np.array(levels) - plane, np.array(kinds)
        per_depth = math.pi * kind * np.array(numbers)
        per_root = Hertz().load_at_indentation(1.0, kind) * np.array(numbers)
        whole = float(per_depth.sum())

        def carried(depth: float, lead: FloatArray = lead, per_root: FloatArray = per_root) -> float:
            return float(per_root @ (lead + depth) ** 1.5)

        deepest = (f - float(per_depth @ lead)) / whole
        if deepest > 0.0 and carried(deepest) > p:
            share = _pressure(new_radius)

            def excess(
                depth: float, p: float = p, area: float = deepest * whole, whole: float = whole,
                share: float = share,
            ) -> float:  # fmt: skip
                return carried(depth) + (area - depth * whole) * share * math.sqrt(depth) - p  # eq. S1

            low = options.shallowest * deepest
            depth = (
                float(brentq(excess, low, deepest, xtol=1e-12 * low, rtol=1e-12))
                if excess(low) < 0.0
                else low
            )
            levels.append(plane)
            numbers.append((deepest - depth) * whole / (math.pi * new_radius * depth))
            kinds.append(new_radius)
        else:
            depth = _depth_at(carried, p, float(radius.max()))
        plane -= depth
    return _spread(np.array(levels), np.array(numbers), np.array(kinds), plane, count)


def slowest_law(load: float, friction: float, radii: Radii, count: int) -> tuple[FloatArray, FloatArray]:
    """Return at most `count` heights, and radii [mm], of the law of least slope at a point."""
    k, s = math.sqrt(radii.low / radii.high), relative_depth(radii)
    small = 1.0 / (k * s) ** 3  # small caps for each large one
    # sums of a^3/R and of a^2 for one large cap with a/R = 1 and its small caps
    cubes, squares = (radii.high**2 * (1.0 + small * k**4 * s**power) for power in (6.0, 4.0))
    ratio = (
        float(Hertz().load(1.0, 1.0)) * cubes / (math.pi * squares)
    )  # P/A0 where the large caps have a/R = 1
    share = load / friction / ratio  # a/R of the large caps
    large = friction / (math.pi * squares * share**2)
    large *= min(1.0, count / (large * (1.0 + small)))
    numbers = max(1, round(large)), max(1, round(large * small))
    deeper = radii.high * share**2 - radii.low * (share * s * s) ** 2
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
    whole = min(count, max(1, math.ceil(total[-1])))
    place = (np.arange(whole) + 0.5) / whole * total[-1]
    level = np.minimum(np.searchsorted(total[1:], place), len(kinds) - 1)
    return np.interp(place, total, ends), kinds[level]
