"""One level of asperities, and one adjustment asperity, that meet one operating point (eq. S1).

All earlier asperities are in contact, and n of radius R are new at the level. For each indentation d of the
level the area, linear in the indentations, fixes the indentation e of the adjustment asperity of radius R'.
It is at the level where e = d and just touches where e = 0. For the right n the load minus that of the point
changes its sign between the two. With one radius that n is unique.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray
from metafem.contact import Hertz
from metafem.inversion.height_density import TIGHTEST
from metafem.models import Independent

# A friction this close to a bound counts as the bound: rounding must not add an asperity.
ROUNDING = 1e-12


@dataclass(frozen=True)
class Level:
    """Asperities of `radius` at a height, and one of another radius if its indentation is not zero."""

    height: float
    number: int
    radius: float
    other: float
    depth: float
    adjustment: float

    @property
    def kinds(self) -> list[tuple[float, float, int]]:
        """Height, radius and number of the asperities of each kind."""
        kinds = [(self.height, self.radius, self.number)]
        if self.adjustment > 0.0:
            kinds.append((self.height - self.depth + self.adjustment, self.other, 1))
        return kinds

    @property
    def count(self) -> int:
        """Number of asperities."""
        return sum(number for _, _, number in self.kinds)


class Step:
    """One operating point: the earlier asperities, by kinds, are `above` the new level [mm]."""

    def __init__(self, done: tuple[Level, ...], height: float, load: float, friction: float) -> None:
        self.height, self.load, self.friction = height, load, friction
        kinds = [kind for level in done for kind in level.kinds]
        top, self.radius, self.number = np.array(kinds).reshape(-1, 3).T
        self.above = top - height
        # eq. S1, area: sum R_i d_i missing as the plane meets the level [mm^2]; its derivative by the depth
        self.missing = friction / math.pi - float(self.number @ (self.radius * self.above))
        self.growth = float(self.number @ self.radius)
        self.fewest = 0 if done else 1

    def excess(self, depth: FloatArray, number: FloatArray | float, radius: float) -> FloatArray:
        """Load minus that of the point at indentations of the level, (k,) [mm^2]."""
        # eq. S1, load
        earlier = Hertz().load_at_indentation(self.above + depth[:, None], self.radius) @ self.number
        return np.asarray(earlier + number * Hertz().load_at_indentation(depth, radius) - self.load)

    def friction_with(self, number: int, radius: float) -> float:
        """Friction at the load of the point with `number` new asperities at the level [mm^2]."""
        times = self.number.astype(np.int64)
        height = np.concatenate([np.repeat(self.above, times), np.zeros(number)])
        radii = np.concatenate([np.repeat(self.radius, times), np.full(number, radius)])
        return float(Independent().curve_of(height, radii, np.array([self.load])).area[0])

    def needed(self, radius: float) -> float:
        """Least number of new asperities, the adjustment asperity included, that meets the point."""

        def excess(number: float) -> float:
            depth = self.missing / (self.growth + number * radius)
            return float(self.excess(np.array([depth]), number, radius)[0])

        low, high = float(self.fewest), 1.0
        while excess(high) > 0.0:
            low, high = high, 2.0 * high
        return math.floor(brentq(excess, low, high)) + 1 if excess(low) > 0.0 else low

    def levels(self, tools: tuple[float, ...], left: int) -> Iterator[Level]:
        """Yield the levels that meet the point with at most `left` asperities."""
        number = np.arange(self.fewest, left + 1.0)
        if self.missing <= 0.0 or not number.size:
            return
        for radius in tools:
            growth = self.growth + number * radius
            alone = self.excess(self.missing / growth, number, radius)
            for n in number[np.abs(alone) <= ROUNDING * self.load]:
                depth = self.missing / (self.growth + n * radius)
                yield Level(self.height, int(n), radius, radius, depth, 0.0)
            for other in tools:
                depth = self.missing / (growth + other)
                both = self.excess(depth, number, radius) + Hertz().load_at_indentation(depth, other)
                for n in number[(alone * both <= 0.0) & (np.abs(alone) > ROUNDING * self.load)]:
                    if n < left:
                        yield self._adjusted(int(n), radius, other)

    def _adjusted(self, number: int, radius: float, other: float) -> Level:
        """Return the level whose adjustment asperity meets both the area and the load."""
        growth = self.growth + number * radius

        def adjustment(depth: float) -> float:
            return max(0.0, float(self.missing - growth * depth) / other)

        def excess(depth: float) -> float:
            adjusted = float(Hertz().load_at_indentation(np.array(adjustment(depth)), other))
            return float(self.excess(np.array([depth]), number, radius)[0]) + adjusted

        depth = _root(excess, self.missing / (growth + other), self.missing / growth)
        return Level(self.height, number, radius, other, depth, adjustment(depth))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root of a function in a bracket; an end of it where rounding hides the change of sign."""
    first, last = function(low), function(high)
    if first == 0.0 or (first > 0.0) == (last > 0.0):
        return low if abs(first) <= abs(last) else high
    return float(brentq(function, low, high, xtol=TIGHTEST * low, rtol=TIGHTEST))
