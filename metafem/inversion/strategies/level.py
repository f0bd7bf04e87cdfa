"""Level of equal asperities, with one adjustment asperity, that meets one operating point (eq. S1).

All earlier asperities are in contact, and n asperities of radius R are added at the level. For each
indentation d of the level, the area of the point determines the indentation e of the adjustment asperity of
radius R'. The adjustment asperity is at the height of the level if e = d, and just touches if e = 0. For the
correct n, the difference between the load and that of the point changes sign between these two cases. With
one radius and Hertz contacts, only one n is correct.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.law import contacts
from metafem.models import Independent

# A load within this relative distance of the load of the point counts as equal, so that rounding does not add
# an asperity.
ROUNDING = 1e-10

# Relative tolerance of area and load in the search for an indentation: a few times the rounding of a sum.
SETTLED = 8.0 * np.finfo(float).eps

# Maximum number of steps of Newton's method with bisection, and largest indentation in a search, relative to
# the contact radius of a contact with the total area.
MOST_STEPS, MOST_DEPTH = 100, 1e3

# More asperities than any surface has. If a search exceeds this number, the earlier levels already carry more
# than the load, and no number of asperities meets the point.
MOST_ASPERITIES = 1e12


@dataclass(frozen=True)
class Level:
    """Asperities of `radius` at `height`, and adjustment asperities of the radius `other`.

    `depth` and `adjustment` are their indentations at the point [mm]. If `adjustment` is zero, there is no
    adjustment asperity. Only adhesive levels have more than one, see
    `GroupStep`.
    """

    height: float
    number: int
    radius: float
    other: float
    depth: float
    adjustment: float
    others: int = 1

    @property
    def kinds(self) -> list[tuple[float, float, int]]:
        """Height [mm], radius [mm] and number of the asperities of each kind."""
        kinds = [(self.height, self.radius, self.number)]
        if self.adjustment > 0.0:
            kinds.append((self.height - self.depth + self.adjustment, self.other, self.others))
        return kinds

    @property
    def count(self) -> int:
        """Number of asperities."""
        return sum(number for _, _, number in self.kinds)


class Excess(NamedTuple):
    """Load and area of asperities minus those of a point, and their derivatives by the indentation, (k,)."""

    load: FloatArray  # [mm^2]
    area: FloatArray  # [mm^2]
    stiffness: FloatArray  # dP/dd [mm]
    growth: FloatArray  # dA/dd [mm]


def kinds_of(levels: tuple[Level, ...]) -> FloatArray:
    """Return the heights, radii and numbers of the asperities of each kind, (3, q)."""
    return np.array([kind for level in levels for kind in level.kinds]).reshape(-1, 3).T


def asperities(levels: tuple[Level, ...]) -> tuple[FloatArray, FloatArray]:
    """Return the heights and the radii of all asperities on levels, (n,) each [mm]."""
    height, radius, number = kinds_of(levels)
    each = np.repeat(np.arange(len(number)), number.astype(np.int64))
    return height[each], radius[each]


class Step:
    """Search for levels that meet one operating point after earlier levels.

    `above` (q,) holds the heights [mm] of each kind of earlier asperities above the new level.
    """

    def __init__(
        self, law: Contact, done: tuple[Level, ...], height: float, load: float, friction: float
    ) -> None:
        self.law, self.height, self.load, self.friction = law, height, load, friction
        top, self.radius, self.number = kinds_of(done)
        self.above = top - height
        # eq. S1, area: friction of the point minus the area when the plane reaches the level [mm^2]
        self.missing = friction - float(contacts(law, self.above, self.radius).area @ self.number)
        self.fewest, self.used = 0 if done else 1, {level.radius for level in done}

    def with_new(self, number: FloatArray, radius: FloatArray) -> Callable[[FloatArray], Excess]:
        """Return the excess over the point as a function of the indentations of the level, (k,) [mm].

        The level has `number` (k, q) new asperities with the radii `radius` (q,) [mm].
        """
        above = np.concatenate([self.above, np.zeros(len(radius))])
        size = np.concatenate([self.radius, radius])
        old = np.broadcast_to(self.number, (len(number), len(self.number)))
        every = np.concatenate([old, number], axis=1)

        def at(depth: FloatArray) -> Excess:
            found = contacts(self.law, above + depth[:, None], size)
            growth = self.law.area_slope(found.contact_radius, size)
            parts = (found.load, found.area, found.stiffness, growth)
            load, area, stiffness, growth = ((every * part).sum(axis=1) for part in parts)
            return Excess(load - self.load, area - self.friction, stiffness, growth)  # eq. S1

        return at

    def depth(self, number: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the indentations of the level at which the area equals that of the point, (k,) [mm]."""
        # no contact area exceeds the total area
        widest = math.sqrt(self.friction / math.pi)
        old, new = (self._deepest(widest, each) for each in (self.radius, radius))
        high = np.where(number > 0.0, new, np.inf).min(axis=1)
        high = np.minimum(high, np.min(old - self.above, initial=np.inf))
        at = self.with_new(number, radius)

        def area(depth: FloatArray) -> tuple[FloatArray, FloatArray]:
            found = at(depth)
            return found.area, found.growth

        return _increasing_root(area, np.zeros(len(number)), high, SETTLED * self.friction, high)

    def _deepest(self, widest: float, radius: FloatArray) -> FloatArray:
        """Return the indentations at a contact radius, at most the largest of the law, (q,) [mm]."""
        most = np.minimum(self.law.largest_indentation(radius), MOST_DEPTH * widest)
        inside = np.minimum(widest, self.law.contact_radius(most, radius))
        return np.asarray(np.minimum(self.law.indentation(inside, radius), most))

    def friction_with(self, number: int, radius: float) -> float:
        """Return the friction [mm^2] at the load of the point with `number` new asperities at the level."""
        times = self.number.astype(np.int64)
        height = np.concatenate([np.repeat(self.above, times), np.zeros(number)])
        radii = np.concatenate([np.repeat(self.radius, times), np.full(number, radius)])
        model = Independent(contact=self.law)
        return float(model.curve_of(height, radii, np.array([self.load])).area[0])

    def needed(self, radius: float) -> float:
        """Return the smallest number of new asperities that meets the point; inf if there is none.

        The number includes an adjustment asperity.
        """

        def excess(number: float) -> float:
            new = np.array([[number]]), np.array([radius])
            return float(self.with_new(*new)(self.depth(*new)).load[0])

        low, high = float(self.fewest), 1.0
        while excess(high) > 0.0:
            if high > MOST_ASPERITIES:
                return math.inf
            low, high = high, 2.0 * high
        return math.floor(brentq(excess, low, high)) + 1 if excess(low) > 0.0 else low

    def levels(self, tools: tuple[float, ...], left: int) -> Iterator[Level]:
        """Yield the levels that meet the point with at most `left` asperities.

        Those with a radius of earlier levels come first, and then those with fewest asperities.
        """
        found = self._levels(tools, left)
        return iter(sorted(found, key=lambda level: (level.radius not in self.used, level.count)))

    def _levels(self, tools: tuple[float, ...], left: int) -> Iterator[Level]:
        number = np.arange(self.fewest, left + 1.0)
        if self.missing <= 0.0 or not number.size:
            return
        for radius in tools:
            new = number[:, None], np.array([radius])
            depth = self.depth(*new)
            without = self.with_new(*new)(depth).load
            met = np.abs(without) <= ROUNDING * self.load
            for n, d in zip(number[met], depth[met], strict=True):
                yield Level(self.height, int(n), radius, radius, float(d), 0.0)
            for other in tools:
                new = np.stack([number, np.ones(len(number))], axis=1), np.array([radius, other])
                level = self.depth(*new)
                both = self.with_new(*new)(level).load
                for i in np.flatnonzero((without * both <= 0.0) & ~met & (number < left)):
                    low, high = (level[i], both[i]), (depth[i], without[i])
                    yield self._adjusted(int(number[i]), radius, other, low, high)

    def _adjusted(
        self, number: int, radius: float, other: float, low: tuple[Any, Any], high: tuple[Any, Any]
    ) -> Level:
        """Return the level that meets both the area and the load by its adjustment asperity.

        `low` and `high` are indentations [mm] with their excess loads [mm^2]. At the first, the adjustment
        asperity has the height of the level, and at the second, it just touches.
        """
        at = self.with_new(np.array([[float(number)]]), np.array([radius]))
        size, (shallow, first), (deep, last) = np.array([other]), low, high
        sign = math.copysign(1.0, last)

        def adjusted(depth: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
            """Return the indentation [mm] of the adjustment asperity, and excess load [mm^2] with slope."""
            level = at(depth)
            widest = math.sqrt(max(-float(level.area[0]), 0.0) / math.pi)
            own = self._deepest(widest, size)
            found = contacts(self.law, own, size)
            with np.errstate(divide="ignore", invalid="ignore"):  # an adjustment asperity that just touches
                # dP/dA of the adjustment asperity, whose area decreases as that of the others increases
                steepness = found.stiffness / self.law.area_slope(found.contact_radius, size)
            return own, level.load + found.load, level.stiffness - steepness * level.growth

        def excess(depth: FloatArray) -> tuple[FloatArray, FloatArray]:
            _, load, slope = adjusted(depth)
            return sign * load, sign * slope

        ends = np.array([shallow]), np.array([deep])
        secant = np.array([(shallow * last - deep * first) / (last - first)])
        depth = _increasing_root(excess, *ends, SETTLED * self.load, secant)
        return Level(self.height, number, radius, other, float(depth[0]), float(adjusted(depth)[0][0]))


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
