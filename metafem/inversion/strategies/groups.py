"""Groups of equal asperities that meet operating points; each group has a free height (eq. S1).

Levels with one adjustment asperity, as in `level`, do not exist for adhesive asperities, and they can need a
larger range of heights than other surfaces. An adhesive asperity jumps into contact where its gap closes. It
then has the contact radius a_0 with ``d(a_0) = 0``, the area ``pi a_0^2`` and the load ``P(a_0) < 0``, so
that an adjustment asperity cannot have a smaller area. Instead, m asperities with a free height are added for
each point. Let x_k be the approach at point k, with the load P_k and friction F_k, and let the earlier
asperities together have the load L(x) and the area S(x). If the new asperities have the contact radius a,
their gap is ``g = x_k - d(a)``, and

    S(x_k) + m pi a^2 = F_k,    L(x_k) + m P(a) = P_k                        (eq. S1 for a law with d, P(a))

with ``a >= a_0``, so that they are in contact, and ``g > x_(k-1)``, so that they do not change the earlier
points; without adhesion a_0 is 0. The first equation determines a as a function of x_k, and one equation for
x_k remains for each m. With x_k the area of the earlier asperities increases, and that of the new ones
decreases. The load of the same total area increases with their difference, because P is a convex function of
the area. Each m therefore has at most one solution, and consecutive m have overlapping ranges of friction
unless the jumps are large.

The state of a surface at the load P_k is the first state on loading with this load. The earlier asperities
alone must therefore have less load where the new ones come into contact: ``L(g) < P_k``. With adhesion the
load then falls by ``m |P(a_0)|`` and rises again. For the first point the earlier asperities are n equal ones
of the largest height, with ``x_0 = 0`` and ``n A(P_1/n) < F_1``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.law import contacts
from metafem.inversion.height_density import TIGHTEST
from metafem.inversion.strategies.level import MOST_DEPTH, Level, Step

# Number of approaches at which the equation for x_k is evaluated to bracket its roots.
GRID = 129

# Relative rounding error of a load or friction that earlier asperities alone meet.
MET = 1e-10

# Maximum number of doublings of an approach until the earlier asperities have the friction of a point.
MOST_DOUBLINGS = 60


class GroupStep(Step):
    """Search for a group of equal asperities that meets one operating point after earlier groups.

    `deepest` [mm] is the largest gap of a group below `height` within the limits.
    """

    def __init__(
        self,
        law: Contact,
        done: tuple[Level, ...],
        height: float,
        load: float,
        friction: float,
        *,
        deepest: float,
    ) -> None:
        super().__init__(law, done, height, load, friction)
        self.deepest = deepest

    def levels(self, tools: tuple[float, ...], left: int) -> Iterator[Level]:
        """Yield the groups, as levels, that meet the point with at most `left` asperities, fewest first.

        The first group consists of asperities at the largest height and adjustment asperities of one height.
        """
        if self.number.size:
            found = self._after(_Earlier(self.law, self.radius, -self.above, self.number), tools, left)
            for number, radius, gap, x in found:
                yield Level(self.height - gap, number, radius, radius, x - gap, 0.0)
            return
        for radius in tools:
            for number in range(self._most_tops(radius, left), 0, -1):
                tops = _Earlier(self.law, np.array([radius]), np.zeros(1), np.array([float(number)]))
                for others, other, gap, x in self._after(tops, tools, left - number):
                    adjustment = x - gap if others else 0.0
                    yield Level(self.height, number, radius, other, x, adjustment, max(others, 1))

    def _most_tops(self, radius: float, left: int) -> int:
        """Return the largest number of equal asperities whose friction at the load is not above the point."""
        number = np.arange(1, left + 1)
        a = np.sqrt(self.friction / (math.pi * number))
        a = np.minimum(a, self._widest(radius))
        load = number * self.law.load(a, np.full(left, radius))
        return int((load >= self.load * (1.0 - MET)).sum())

    def _widest(self, radius: float) -> float:
        """Return the largest contact radius [mm] that the law describes, or one that exceeds all contacts."""
        total = math.sqrt(self.friction / math.pi)
        most = np.minimum(self.law.largest_indentation(radius), MOST_DEPTH * total)
        return min(float(self.law.contact_radius(most, np.array(radius))), 2.0 * total)

    def _after(
        self, earlier: _Earlier, tools: tuple[float, ...], left: int
    ) -> Iterator[tuple[int, float, float, float]]:
        """Yield number, radius, gap and approach x_k [mm] of new asperities; gaps are relative to `height`.

        The number is 0 if the earlier asperities meet the point.
        """
        end = earlier.approach_at(self.friction)
        if end is None:
            return
        load, area = earlier.at(np.array([end]))
        if (
            abs(load[0] - self.load) <= MET * self.load
            and abs(area[0] - self.friction) <= MET * self.friction
        ):
            yield 0, float(earlier.radius[0]), 0.0, end
            return
        if left < 1:
            return
        number, x = np.arange(1.0, left + 1.0), end * np.linspace(0.0, 1.0, GRID)
        load, area = earlier.at(x)
        for radius in tools:
            _, gap, excess = self._new(x[:, None], load[:, None], area[:, None], number, radius)
            inside = gap > 0.0
            changes = inside[1:] & inside[:-1] & (excess[1:] * excess[:-1] <= 0.0)
            rows, columns = np.nonzero(changes)
            # groups below the lowest height only state that the limits exclude them
            deep = gap[rows, columns] > self.deepest
            order = np.lexsort((columns, deep))
            for row, column in zip(rows[order], columns[order], strict=True):
                found = self._solved(earlier, int(number[column]), radius, x[row], x[row + 1])
                if found is not None:
                    yield int(number[column]), radius, *found
                    if found[0] > self.deepest:
                        break

    def _new(
        self, x: FloatArray, load: FloatArray, area: FloatArray, number: FloatArray, radius: float
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return contact radius and gap [mm] of new asperities with the missing area, and the excess load.

        Without such asperities the gap is nan.
        """
        with np.errstate(invalid="ignore"):
            a = np.sqrt((self.friction - area) / (math.pi * number))
        entry, widest = float(self.law.contact_radius(np.array(0.0), np.array(radius))), self._widest(radius)
        given = (a > entry) & (a < widest)
        a, size = np.where(given, a, 0.5 * (entry + widest)), np.full(a.shape, radius)
        gap = np.where(given, x - self.law.indentation(a, size), np.nan)
        return a, gap, load + number * self.law.load(a, size) - self.load

    def _solved(
        self, earlier: _Earlier, number: int, radius: float, low: float, high: float
    ) -> tuple[float, float] | None:
        """Return the gap and the approach [mm] in a bracket, or None if the load was reached before."""

        def at(x: float) -> tuple[float, float]:
            every = np.array([x])
            _, gap, excess = self._new(every, *earlier.at(every), np.array([float(number)]), radius)
            return float(gap[0]), float(excess[0])

        x = float(brentq(lambda x: at(x)[1], low, high, xtol=TIGHTEST * high, rtol=TIGHTEST))
        gap, _ = at(x)
        before = float(earlier.at(np.array([gap]))[0][0])
        return (gap, x) if gap > 0.0 and before < self.load else None


@dataclass(frozen=True)
class _Earlier:
    """Kinds of asperities in contact: radii, gaps [mm] and numbers, (q,) each."""

    law: Contact
    radius: FloatArray
    gap: FloatArray
    number: FloatArray

    def at(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return load and area [mm^2] at approaches (k,) [mm]."""
        depth = x[:, None] - self.gap
        found = contacts(self.law, depth, np.broadcast_to(self.radius, depth.shape))
        return found.load @ self.number, found.area @ self.number

    def approach_at(self, friction: float) -> float | None:
        """Return the approach [mm] from 0 on at which the area is `friction` [mm^2], or None."""

        def excess(x: float) -> float:
            return float(self.at(np.array([x]))[1][0]) - friction

        if excess(0.0) > 0.0:
            return None
        most = float((self.gap + self.law.largest_indentation(self.radius)).min())
        high = friction / float(self.radius.max())
        for _ in range(MOST_DOUBLINGS):
            high = min(high, most)
            if excess(high) >= 0.0:
                return float(brentq(excess, 0.0, high, xtol=TIGHTEST * high, rtol=TIGHTEST))
            if high == most:
                return None
            high *= 2.0
        return None
