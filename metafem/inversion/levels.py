"""Levels of equal asperities, each with one adjustment asperity, whose law passes through points (eq. S1).

At each point all earlier asperities are in contact, and n asperities are added at a level: the height of the
plane at the point before. For each indentation d of the level, the area of the point determines the
indentation e of the adjustment asperity, which is at the height of the level if e = d, and just touches if
e = 0. For the correct n, the difference between the load and that of the point changes sign between these two
cases; with Hertz contacts only one n is correct. All asperities are made by one tool.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.errors import Infeasible
from metafem.inversion.problem import Problem
from metafem.models import Independent

# A load within this relative distance of the load of the point counts as equal, so that rounding does not add
# an asperity; a height this far below the lowest one, relative to the largest, counts as rounding.
ROUNDING = 1e-10

# Relative tolerance of area and load in the search for an indentation: a few times the rounding of a sum.
SETTLED = 8.0 * np.finfo(float).eps

# Largest number of steps of Newton's method with bisection, and largest indentation in a search, relative to
# the contact radius of a contact with the total area.
MOST_STEPS, MOST_DEPTH = 100, 1e3

# More asperities than any surface has. If a search exceeds this number, the earlier levels already carry more
# than the load, and no number of asperities meets the point.
MOST_ASPERITIES = 1e12

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
    def heights(self) -> list[float]:
        """Heights of all asperities [mm]."""
        own = [self.height] * self.number
        return own + [self.height - self.depth + self.adjustment] * (self.adjustment > 0.0)


class Excess(NamedTuple):
    """Load and area of asperities minus those of a point, and their derivatives by the indentation, (k,)."""

    load: FloatArray  # [mm^2]
    area: FloatArray  # [mm^2]
    stiffness: FloatArray  # dP/dd [mm]
    growth: FloatArray  # dA/dd [mm]


@dataclass(frozen=True, eq=False)
class Step:
    """Search for the level that meets a point after earlier asperities, `above` (q,) the level [mm]."""

    law: Contact
    radius: float  # what the law takes as radius
    above: FloatArray
    load: float
    friction: float

    def excess(self, depth: FloatArray, number: FloatArray) -> Excess:
        """Return the excess over the point with new asperities (k,) at indentations of the level [mm]."""
        indentation = np.column_stack([self.above + depth[:, None], depth])
        count = np.column_stack([np.ones((len(depth), len(self.above))), number])
        found = self.law.contacts(indentation, np.full(indentation.shape, self.radius))
        growth = self.law.area_slope(found.contact_radius, self.radius)
        load, area, stiffness, growth = (
            (count * part).sum(axis=1) for part in (found.load, found.area, found.stiffness, growth)
        )
        return Excess(load - self.load, area - self.friction, stiffness, growth)  # eq. S1

    def depth(self, number: FloatArray) -> FloatArray:
        """Return the indentations of the level at which the area equals that of the point, (k,) [mm]."""
        deepest = self._deepest(math.sqrt(self.friction / math.pi))  # no contact exceeds the total area
        old = float(np.min(deepest - self.above, initial=np.inf))
        high = np.minimum(np.where(number > 0.0, deepest, np.inf), old)

        def area(depth: FloatArray) -> tuple[FloatArray, FloatArray]:
            found = self.excess(depth, number)
            return found.area, found.growth

        return _increasing_root(area, np.zeros(len(number)), high, SETTLED * self.friction, high)

    def _deepest(self, widest: float) -> float:
        """Return the indentation [mm] at a contact radius, at most the largest of the law."""
        most = float(np.minimum(self.law.largest_indentation(self.radius), MOST_DEPTH * widest))
        inside = min(widest, float(self.law.contact_radius(most, self.radius)))
        return min(float(self.law.indentation(inside, self.radius)), most)

    def friction_with(self, number: int) -> float:
        """Return the friction [mm^2] at the load of the point with `number` new asperities at the level."""
        height = np.concatenate([self.above, np.zeros(number)])
        curve = Independent(self.law).curve_of(
            height, np.full(len(height), self.radius), np.array([self.load])
        )
        return float(curve.area[0])

    def needed(self) -> float:
        """Return the smallest number of new asperities that meets the point; inf if there is none."""

        def excess(number: float) -> float:
            new = np.array([number])
            return float(self.excess(self.depth(new), new).load[0])

        low, high = 0.0 if self.above.size else 1.0, 1.0
        while excess(high) > 0.0:
            if high > MOST_ASPERITIES:
                return math.inf
            low, high = high, 2.0 * high
        return math.floor(brentq(excess, low, high)) + 1 if excess(low) > 0.0 else low

    def levels(self, height: float, left: int) -> Iterator[Level]:
        """Yield the levels at a height [mm] that meet the point with at most `left` asperities."""
        number = np.arange(0.0 if self.above.size else 1.0, left + 1.0)
        touching = self.law.contacts(self.above, np.full(len(self.above), self.radius)).area.sum()
        if touching >= self.friction or not number.size:
            return
        depth, both = self.depth(number), self.depth(number + 1.0)
        without, full = self.excess(depth, number).load, self.excess(both, number + 1.0).load
        met = np.abs(without) <= ROUNDING * self.load
        for i in np.flatnonzero(met | ((without * full <= 0.0) & (number < left))):
            if met[i]:
                yield Level(height, int(number[i]), float(depth[i]), 0.0)
            else:
                yield self._adjusted(height, number[i], (both[i], full[i]), (depth[i], without[i]))

    def _adjusted(
        self, height: float, number: float, low: tuple[float, float], high: tuple[float, float]
    ) -> Level:
        """Return the level that meets both the area and the load by its adjustment asperity.

        `low` and `high` are indentations [mm] with their excess loads [mm^2]. At the first, the adjustment
        asperity has the height of the level, and at the second, it just touches.
        """
        (shallow, first), (deep, last), count = low, high, np.array([number])
        sign = math.copysign(1.0, last)

        def adjustment(depth: FloatArray) -> float:
            missing = max(-float(self.excess(depth, count).area[0]), 0.0)
            return self._deepest(math.sqrt(missing / math.pi))

        def excess(depth: FloatArray) -> tuple[FloatArray, FloatArray]:
            level, own = self.excess(depth, count), np.array([adjustment(depth)])
            found = self.law.contacts(own, np.array([self.radius]))
            with np.errstate(divide="ignore", invalid="ignore"):  # an adjustment asperity that just touches
                # dP/dA of the adjustment asperity, whose area decreases as that of the others increases
                steepness = found.stiffness / self.law.area_slope(found.contact_radius, self.radius)
            return sign * (level.load + found.load), sign * (level.stiffness - steepness * level.growth)

        secant = np.array([(shallow * last - deep * first) / (last - first)])
        depth = _increasing_root(excess, np.array([shallow]), np.array([deep]), SETTLED * self.load, secant)
        return Level(height, int(number), float(depth[0]), adjustment(depth))


def levels_through(
    problem: Problem, load: FloatArray, friction: FloatArray, drop: float = 0.0
) -> list[Level] | Infeasible:
    """Return levels whose law passes through points (k,) [mm^2], or why the first point has none.

    drop: distance of a level below the plane at the previous point over the depth of the previous level [-].
    """
    (law, radius), limits, wording = problem.tools.laws[0], problem.limits, problem.target.wording
    found: list[Level] = []
    for i, point in enumerate(zip(load.tolist(), friction.tolist(), strict=True)):
        height = found[-1].height - (1.0 + drop) * found[-1].depth if found else limits.max_height
        earlier = np.array([each for level in found for each in level.heights])
        step = Step(law, radius, earlier - height, *point)
        left = problem.count - len(earlier)
        level = next(step.levels(height, left), None)
        if level is None:
            where = f"operating point {i + 1} (load {wording.loads(load[i])}, friction "
            reason = f"{where}{wording.frictions(friction[i])}) is not met: {_reason(step, left, problem)}"
            return Infeasible(reason, by_search=True)
        short = limits.min_height - min(level.heights, default=math.inf)
        if short > ROUNDING * limits.max_height:
            return Infeasible(
                f"operating point {i + 1} needs a summit at {min(level.heights):.6g} mm, below min_height = "
                f"{limits.min_height:g} mm; raise max_height = {limits.max_height:g} mm by {short:.3g} mm"
            )
        plane = limits.offset + height - level.depth
        if plane < 0.0:
            return Infeasible(
                f"at operating point {i + 1} the plane would reach the base plane; raise offset = "
                f"{limits.offset:g} mm or max_height by {-plane:.3g} mm"
            )
        found.append(level)
    return found


def _reason(step: Step, left: int, problem: Problem) -> str:
    """Return why no level meets a point, with the range of friction there."""
    wording, fewest = problem.target.wording, 0 if step.above.size else 1
    low = step.friction_with(fewest)
    high = max(low, step.friction_with(max(left, fewest)))
    if step.friction < low:
        cause = "the asperities that the earlier points need" if fewest == 0 else "a single asperity"
        reason = f"{cause} already {'have' if fewest == 0 else 'has'} more friction"
    else:
        needed = step.needed()
        total = f"{needed + len(step.above):.0f} asperities in all are needed, and there are"
        reason = f"{'more than can be made' if math.isinf(needed) else total} {problem.count} sites"
    return f"{reason}; the friction at this load can be from {wording.frictions(low, high)}"


def _increasing_root(
    function: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    low: FloatArray,
    high: FloatArray,
    settled: float,
    start: FloatArray,
) -> FloatArray:
    """Return the roots (k,) of an increasing function in brackets, by Newton's method with bisection.

    The function returns its values and slopes; values up to `settled` count as 0.
    """
    x = start
    for _ in range(MOST_STEPS):
        value, slope = function(x)
        low, high = np.where(value <= 0.0, x, low), np.where(value >= 0.0, x, high)
        if (np.abs(value) <= settled).all():
            break
        with np.errstate(divide="ignore", invalid="ignore"):  # without a slope the bracket is halved
            moved = x - value / slope
        x = np.where((moved > low) & (moved < high), moved, 0.5 * (low + high))
    return np.asarray(x)
