"""Heights whose law passes through given points: one level and one adjustment asperity a point (S1).

With all earlier asperities in contact, both sums of S1 are functions of the indentation d of the new
level alone: the area is linear in d, and the load is taken at the d that gives the wanted area.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray
from metafem.errors import Infeasible
from metafem.inversion.blueprint import Blueprint
from metafem.inversion.limits import Limits
from metafem.inversion.target import OperatingPoints
from metafem.inversion.wanted import Wanted
from metafem.models import Independent

# brentq's tightest tolerance, so that the points are met to rounding.
TIGHTEST = 4.0 * np.finfo(float).eps

# A friction this close to a bound counts as the bound: rounding must not ask for one asperity more.
ROUNDING = 1e-12


def invert(
    target: OperatingPoints, radius: float, count: int, limits: Limits, rng: np.random.Generator
) -> Blueprint:
    """Return the heights that lead the independent law through all points, or raise Infeasible."""
    stand: list[float] = []  # heights above the foot plane of `limits`, tallest first
    counts: list[int] = []
    levels: list[float] = []
    adjustments: list[float] = []
    level = limits.max_height
    for i, (load, friction) in enumerate(zip(target.rescaled_load, target.rescaled_friction, strict=True)):
        step = _Step(np.array(stand) - level, radius, load, friction)
        left = count - len(stand)
        lowest = step.friction_with(0 if stand else 1)
        if friction < lowest * (1.0 - ROUNDING):
            raise _unreachable(target, i, (lowest, step.friction_with(left)), left)
        number = step.level_count()
        depth, adjustment = step.adjustment(number)
        new = [level] * number + ([level - depth + adjustment] if adjustment > 0.0 else [])
        if len(new) > left:
            raise _unreachable(target, i, (lowest, step.friction_with(left)), left, len(new))
        _refuse_too_low(i, min(new, default=level), level - depth, limits)
        stand += new
        counts.append(number)
        levels.append(limits.offset + level)
        adjustments.append(limits.offset + level - depth + adjustment)
        level -= depth
    parameters = {
        "counts": np.array(counts),
        "levels": np.array(levels),
        "adjustment_heights": np.array(adjustments),
    }
    wanted = Wanted.exactly(target.rescaled_load, target.rescaled_friction)
    return Blueprint(limits.offset + np.array(stand), parameters, wanted)


class _Step:
    """One point: the earlier asperities stand `lead` above the new level [mm]."""

    def __init__(self, lead: FloatArray, radius: float, load: float, friction: float) -> None:
        self.lead, self.radius, self.load, self.friction = lead, radius, load, friction
        self.spent = math.pi * radius * float(lead.sum())  # earlier area as the plane meets the level
        self.per_depth = math.pi * radius  # area of one asperity per indentation

    def earlier_load(self, depth: float) -> float:
        """Load of the earlier asperities [mm^2]."""
        return 4.0 / 3.0 * math.sqrt(self.radius) * float(((self.lead + depth) ** 1.5).sum())

    def single_load(self, depth: float) -> float:
        """Load of one asperity at an indentation [mm^2]."""
        return 4.0 / 3.0 * math.sqrt(self.radius * depth) * depth

    def friction_with(self, number: int) -> float:
        """Friction at the load with `number` new asperities at the level [mm^2]."""
        height = np.concatenate([self.lead, np.zeros(number)])
        _, _, area, _ = Independent().curves(height, self.radius, [self.load])
        return float(area[0, 0])

    def real_count(self) -> float:
        """Number of level asperities that would meet the point, as a real number."""
        wanted = self.friction - self.spent
        if not self.lead.size:
            depth = (3.0 * math.pi * math.sqrt(self.radius) * self.load / (4.0 * self.friction)) ** 2
            return wanted / (self.per_depth * depth)

        def excess(depth: float) -> float:
            number = (wanted - self.per_depth * self.lead.size * depth) / (self.per_depth * depth)
            return self.earlier_load(depth) + number * self.single_load(depth) - self.load

        end = wanted / (self.per_depth * self.lead.size)  # the earlier ones alone give the friction
        depth = _root(excess, end * np.finfo(float).eps, end)
        return wanted / (self.per_depth * depth) - self.lead.size

    def level_count(self) -> int:
        """Whole number of asperities at the level that approaches the point from below."""
        fewest = 0 if self.lead.size else 1
        return max(fewest, math.floor(self.real_count() * (1.0 - ROUNDING)))

    def adjustment(self, number: int) -> tuple[float, float]:
        """Indentations of the level and of the adjustment asperity at the point [mm].

        The friction fixes the adjustment's indentation for any depth of the level; the load grows with
        the depth between the ends at which the adjustment has the level's height, and just touches.
        """
        wanted = (self.friction - self.spent) / self.per_depth
        held = self.lead.size + number

        def rest(depth: float) -> float:
            return max(0.0, wanted - held * depth)

        def excess(depth: float) -> float:
            carried = self.earlier_load(depth) + number * self.single_load(depth)
            return carried + self.single_load(rest(depth)) - self.load

        depth = _root(excess, wanted / (held + 1), wanted / held)
        touching = rest(depth) <= ROUNDING * depth
        return depth, 0.0 if touching else rest(depth)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root of a function that rises through zero in a bracket; an end where rounding hides the sign."""
    if function(low) >= 0.0:
        return low
    if function(high) <= 0.0:
        return high
    return float(brentq(function, low, high, xtol=TIGHTEST * low, rtol=TIGHTEST))


def _unreachable(
    target: OperatingPoints, i: int, reachable: tuple[float, float], left: int, needed: int | None = None
) -> Infeasible:
    low, high = reachable[0], max(reachable)
    if needed is None:
        cause = "the asperities that the earlier points need" if i else "a single asperity"
        reason = f"{cause} already give{'' if i else 's'} more ({left} asperities are left, none is needed)"
        nearest = low
    else:
        reason = f"at least {needed} more asperities are needed, {left} are left"
        nearest = high * (1.0 - 1e-9)  # so far inside that rounding asks for no further asperity
    load, friction = target.rescaled_load[i], target.rescaled_friction[i]
    return Infeasible(
        f"operating point {i + 1} (load {load:g}, friction {friction:g} mm^2) cannot be reached: {reason}. "
        f"Given the earlier points, the friction at this load can be from {low:.6g} to {high:.6g} mm^2",
        OperatingPoints(target.rescaled_load[: i + 1], [*target.rescaled_friction[:i], nearest]),
    )


def _refuse_too_low(i: int, lowest: float, plane: float, limits: Limits) -> None:
    """Refuse summits below the workshop's lowest, and a plane that reaches the base plane."""
    short = limits.min_height - lowest
    if short > 0.0:
        raise Infeasible(
            f"operating point {i + 1} needs a summit at {lowest:.6g} mm, below min_height = "
            f"{limits.min_height:g} mm; raise max_height = {limits.max_height:g} mm by {short:.3g} mm"
        )
    if limits.offset + plane < 0.0:
        raise Infeasible(
            f"at operating point {i + 1} the plane would reach the base plane; raise offset = "
            f"{limits.offset:g} mm or max_height by {-limits.offset - plane:.3g} mm"
        )
