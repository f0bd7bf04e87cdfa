"""Levels of equal asperities, each with one adjustment asperity, whose law passes through points (eq. S1).

At each point all earlier asperities are in contact, and n asperities are added at a level: the height of the
plane at the point before. Load and area of the point determine n and the indentation d of the level, where n
need not be an integer. With the integer below n, an adjustment asperity has the rest of the area and of the
load: at the height of the level the load would be too small, and just touching it would be too large. All
asperities are made by one tool.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.inversion.problem import Candidate, Parameter, Problem
from metafem.models.model import has_paraboloids

# A number of asperities this far below an integer counts as the integer.
ROUNDING = 1e-9

# Smallest and largest indentation at which a number of asperities is tried, relative to that without any.
SHALLOWEST, DEEPEST = 1e-9, 1.0 + 1e-10

# Levels this much too low, relative to the largest height, count as within the limits.
TOO_LOW = 1e-10

# Tolerances of roots: a few times the rounding of a sum.
SETTLED = {"xtol": 1e-18, "rtol": 8.0 * np.finfo(float).eps}

# Distance of a level below the plane at the previous point, relative to the indentation of the previous
# level. With it no level touches the plane at the previous point, as contact laws need whose kinks at new
# contacts are sharper than those of Hertz's law.
LEVEL_DROP = 0.05


@dataclass(frozen=True)
class Level:
    """Asperities at `height`, and an adjustment asperity unless `adjustment` is 0.

    `depth` and `adjustment` are their indentations at the point [mm].
    """

    height: float
    number: int
    depth: float
    adjustment: float

    @property
    def adjustment_height(self) -> float:
        """Height of the adjustment asperity [mm]."""
        return self.height - self.depth + self.adjustment

    @property
    def heights(self) -> list[float]:
        """Heights of all asperities [mm]."""
        return [self.height] * self.number + [self.adjustment_height] * (self.adjustment > 0.0)


def on_levels(problem: Problem, rng: np.random.Generator) -> Candidate | None:
    """Return asperities on the levels of one tool through all points, with the fewest asperities, or None."""
    law, limits, best, which = problem.law, problem.limits, None, 0
    for tool in problem.tools.tried.tolist():
        path = levels_through(problem.alone(tool), law.load, law.lower)
        if path is None or missing_height(problem, path) > TOO_LOW * limits.max_height:
            continue
        if best is None or len(_heights(path)) < len(_heights(best)):
            best, which = path, tool
    if best is None:
        return None
    height = _heights(best)
    parameters: dict[str, Parameter] = {
        "counts": np.array([level.number for level in best]),
        "levels": limits.offset + np.array([level.height for level in best]),
        "adjustment_heights": limits.offset + np.array([level.adjustment_height for level in best]),
    }
    at = problem.placed(height - height.max(), np.full(len(height), which), rng)
    return Candidate(at, law, parameters)


def missing_height(problem: Problem, path: list[Level]) -> float:
    """Return by how much levels are too low [mm]: for the limits, or as the plane reaches the base plane."""
    limits, plane = problem.limits, path[-1].height - path[-1].depth
    return max(limits.min_height - float(_heights(path).min()), -limits.offset - plane)


def _heights(path: list[Level]) -> FloatArray:
    """Return the heights of all asperities of levels [mm]."""
    return np.array([each for level in path for each in level.heights])


def levels_through(problem: Problem, load: FloatArray, friction: FloatArray) -> list[Level] | None:
    """Return levels of the first tool whose law passes through points (k,) [mm^2]; None if there are none.

    They may be lower than the limits allow.
    """
    (law, radius), found = problem.tools.laws[0], list[Level]()
    drop = 1.0 if has_paraboloids(problem.model) else 1.0 + LEVEL_DROP
    for point in zip(load.tolist(), friction.tolist(), strict=True):
        height = found[-1].height - drop * found[-1].depth if found else problem.limits.max_height
        above = _heights(found) - height
        try:
            found.append(_level(law, radius, height, above, *point))
        except ValueError:  # load and area have no root
            return None
        if len(_heights(found)) > problem.count:
            return None
    return found


def _level(
    law: Contact, radius: float, height: float, above: FloatArray, load: float, friction: float
) -> Level:
    """Return the level at a height that meets a point after earlier asperities, `above` (q,) the level [mm].

    Raises ValueError if there is none.
    """

    def sums(depth: float) -> tuple[float, float, float, float]:
        """Return the load and area [mm^2] of the earlier asperities, and of one at the level."""
        found = law.contacts(np.append(above + depth, depth), np.full(len(above) + 1, radius))
        return found.load[:-1].sum(), found.area[:-1].sum(), found.load[-1], found.area[-1]

    def root(excess: Callable[[float], float], low: float, high: float) -> float:
        return float(brentq(excess, low, high, **SETTLED))

    def depth_of(number: int) -> float:
        """Return the depth at which a number of new asperities has the rest of the area [mm]."""

        def excess(depth: float) -> float:
            _, area, _, one = sums(depth)
            return float(area + number * one - friction)

        return root(excess, 0.0, deepest if number else last)

    def number_at(depth: float) -> float:
        _, area, _, one = sums(depth)
        return float((friction - area) / one)

    def load_excess(depth: float) -> float:
        carried, _, one, _ = sums(depth)
        return float(carried + number_at(depth) * one - load)

    def adjustment(depth: float) -> float:
        """Return the indentation of the adjustment asperity that has the area that is missing [mm]."""
        _, area, _, one = sums(depth)
        size = math.sqrt(max(friction - area - number * one, 0.0) / math.pi)
        return float(law.indentation(size, radius)) if size else 0.0

    def adjusted_excess(depth: float) -> float:
        carried, _, one, _ = sums(depth)
        own = law.contacts(np.array([adjustment(depth)]), np.array([radius])).load[0]
        return float(carried + number * one + own - load)

    # no contact exceeds the total area
    last = DEEPEST * float(law.indentation(math.sqrt(friction / math.pi), radius))
    last = min(last, float((law.largest_indentation(radius) - np.append(above, 0.0)).min()))
    deepest = last
    if above.size:
        deepest = DEEPEST * depth_of(0)
    exact = root(load_excess, SHALLOWEST * deepest, deepest)
    number = math.floor(number_at(exact) + ROUNDING)
    if not number and not above.size:
        raise ValueError("a single asperity already has more friction")
    touching = depth_of(number)
    ends = depth_of(number + 1), touching
    if np.sign(adjusted_excess(ends[0])) == np.sign(adjusted_excess(touching)):
        return Level(height, number, touching, 0.0)  # up to rounding
    depth = root(adjusted_excess, *ends)
    return Level(height, number, depth, adjustment(depth))
