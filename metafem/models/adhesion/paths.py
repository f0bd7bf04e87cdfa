"""Loading and unloading paths of adhesive asperities that do not interact.

All quantities are functions of the approach x. On loading, an asperity is in contact from the approach at
which its gap closes. On unloading, it remains in contact until the end of its branch, where ``d = d_end``.
Between two approaches where contacts form or break, the load is a convex function of x. The state at a load
is the first point of the path with this load; see `loading`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact import JKR
from metafem.contact.adhesion import of_sizes
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import sizes_of
from metafem.errors import InvalidInput
from metafem.models.adhesion.notes import Jump

# Maximum number of Newton steps or halvings, sufficient to converge to rounding. The end of a branch is a
# double root, where each Newton step only halves the error.
MOST_STEPS = 80
ROUNDING = 4.0 * np.finfo(np.float64).eps

# Tolerance for the approach of the smallest load, relative to the length of the piece; the load is stationary
# there.
LOWEST = 1e-9

# Maximum number of doublings of the step in the approach until a load is reached.
MOST_DOUBLINGS = 200


class Sums(NamedTuple):
    """Sums over the contacts at approaches (k,)."""

    load: FloatArray  # [mm^2]
    area: FloatArray  # [mm^2]
    stiffness: FloatArray  # dP/dx [mm]
    contact_radius: FloatArray  # (k, n) [mm], 0 for open asperities


@dataclass(frozen=True)
class Asperities:
    """Adhesive asperities (n,)."""

    law: JKR  # for a material
    radius: FloatArray
    gap: FloatArray

    @cached_property
    def entry_radius(self) -> FloatArray:
        """Contact radius (n,) [mm] after the jump into contact, at d = 0."""
        return of_sizes(JKR.entry_radius, self.law, self.radius)

    @cached_property
    def end_radius(self) -> FloatArray:
        """Contact radius (n,) [mm] at the end of the branch, where a contact breaks at fixed approach."""
        return of_sizes(JKR.break_radius, self.law, self.radius)

    @cached_property
    def end(self) -> FloatArray:
        """Indentation (n,) [mm] at the end of the branch; it is negative."""
        return np.asarray(self.law.indentation(self.end_radius, self.radius))

    def held_radius(self, indentation: FloatArray, closed: np.ndarray) -> FloatArray:
        """Return contact radii (k, n) [mm] at indentations (k, n) [mm]; 0 for open asperities.

        Newton's method is used at radii above the minimum of the convex function d(a).
        """
        law, cap = self.law, self.law.cap
        d = np.where(closed, indentation, 0.0)
        radius = np.broadcast_to(self.radius, d.shape)
        most = np.broadcast_to(cap.largest_indentation(self.radius), d.shape)
        if (d > law.largest_indentation(self.radius)).any():
            cap.contact_radius(np.full(d.shape, np.where(np.isfinite(most), 2.0 * most, 0.0)), radius)
        if cap == PARABOLOID and (d >= 0.0).all():
            return np.where(closed, law.contact_radius(d, radius), 0.0)
        a = np.maximum(self.entry_radius, cap.contact_radius(np.maximum(d, 0.0), radius))
        top = cap.contact_radius(np.minimum(1e3 * (sizes_of(radius) + np.maximum(d, 0.0)), most), radius)
        for _ in range(MOST_STEPS):
            s = law.deficit(a)
            slope = law.profile_slope(a, radius) - 0.5 * s / a
            with np.errstate(divide="ignore", invalid="ignore"):
                step = (cap.indentation(a, radius) - s - d) / slope
            new = np.clip(np.where(slope > 0.0, a - step, self.end_radius), self.end_radius, top)
            done = np.abs(new - a) <= ROUNDING * a
            a = new
            if done.all():
                break
        return np.where(closed, a, 0.0)

    def sums(self, approach: FloatArray, closed: np.ndarray) -> Sums:
        """Return the sums at approaches (k,) [mm]; `closed` (k, n) tells which asperities are in contact."""
        a = self.held_radius(approach[:, None] - self.gap, closed)
        one = np.where(closed, a, self.entry_radius)
        with np.errstate(divide="ignore"):  # -inf at the end of a branch
            stiffness = np.where(closed, self.law.stiffness(one, self.radius), 0.0)
        return Sums(self.loads(a).sum(axis=1), np.pi * (a**2).sum(axis=1), stiffness.sum(axis=1), a)

    def loads(self, contact_radius: FloatArray) -> FloatArray:
        """Return the loads (..., n) [mm^2] at contact radii; 0 for open contacts."""
        closed = contact_radius > 0.0
        a = np.where(closed, contact_radius, self.entry_radius)
        return np.where(closed, self.law.load(a, self.radius), 0.0)

    def loading(self, most: float) -> Path:
        """Return the loading path up to the load `most`."""
        start = np.unique(self.gap)
        closed = self.gap <= start[:, None]
        stop = np.append(start[1:], np.inf)
        last = np.empty(len(start))
        inner = np.isfinite(stop)
        if inner.any():
            last[inner] = self.sums(stop[inner], closed[inner]).load
        last[-1] = np.inf
        if most <= last[:-1].max(initial=-np.inf):
            stop[-1] = start[-1]
        else:
            stop[-1] = self._beyond(start[-1], most)
        best = np.maximum.accumulate(last)
        return Path(self, closed, start, stop, best, forward=True)

    def _beyond(self, x: float, goal: float) -> float:
        """Return an approach beyond x at which the load `goal` is exceeded with all asperities in contact."""
        every = np.ones((1, len(self.gap)), dtype=bool)
        most = float((self.gap + self.law.largest_indentation(self.radius)).min())
        width = (
            float(self.law.indentation(2.0 * self.entry_radius, self.radius).max()) if most == np.inf else 0.0
        )
        width = width or 0.01 * most
        for _ in range(MOST_DOUBLINGS):
            x = min(x + width, most)
            if self.sums(np.array([x]), every).load[0] >= goal:
                return x
            if x >= most:
                break
            width *= 2.0
        raise InvalidInput(
            f"the load {goal:.4g} mm^2 needs an approach beyond {most:.4g} mm, up to which {self.law!r} "
            "describes all contacts; use lighter loads or a law with a larger range"
        )

    def unloading(self, largest: float) -> Path:
        """Return the unloading path from the approach `largest` [mm]."""
        held = self.gap <= largest
        ends = np.unique((self.gap + self.end)[held])[::-1]
        start = np.append(largest, ends[:-1])
        closed = held & (self.gap + self.end <= ends[:, None])
        lowest = self._lowest(start, ends, closed)
        best = np.minimum.accumulate(self.sums(lowest, closed).load)
        return Path(self, closed, start, lowest, best, forward=False)

    def _lowest(self, start: FloatArray, stop: FloatArray, closed: np.ndarray) -> FloatArray:
        """Return approaches (k,) between start and stop at which the convex load is smallest."""
        low, high = stop.copy(), start.copy()
        for _ in range(MOST_STEPS):
            middle = 0.5 * (low + high)
            rising = self.sums(middle, closed).stiffness > 0.0
            low, high = np.where(rising, low, middle), np.where(rising, middle, high)
            if (high - low <= LOWEST * (start - stop)).all():
                break
        return high


@dataclass(frozen=True)
class Path:
    """A path in m pieces, in order; the contacts of a piece do not change.

    `best` is the largest load that the path has reached at the end of each piece; on unloading, the smallest.
    """

    asperities: Asperities
    closed: np.ndarray  # (m, n)
    start: FloatArray  # approach at the start of each piece [mm]
    stop: FloatArray  # approach at its end [mm]
    best: FloatArray
    forward: bool

    def piece(self, goal: FloatArray) -> IntArray:
        """Return the index (k,) of the piece in which each load is first reached; m if it is not reached."""
        sign = 1.0 if self.forward else -1.0
        return np.searchsorted(sign * self.best, sign * goal)

    def approach(self, goal: FloatArray, piece: IntArray | None = None) -> tuple[FloatArray, np.ndarray]:
        """Return the approaches x (k,) [mm] at the goals, and the closed contacts (k, n).

        piece: index of the piece of each goal; default: the first piece in which the goal is reached.
        """
        if piece is None:
            piece = self.piece(goal)
        closed = self.closed[piece]
        # bracket of the approach; the goal is reached at `high`
        low, high = (self.start, self.stop) if self.forward else (self.stop, self.start)
        low, high = low[piece], high[piece]
        x = high
        for _ in range(MOST_STEPS):
            found = self.asperities.sums(x, closed)
            excess = found.load - goal
            low, high = np.where(excess < 0.0, x, low), np.where(excess >= 0.0, x, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                new = x - excess / found.stiffness
            unit = ROUNDING * np.maximum(np.abs(x), np.abs(self.stop - self.start)[piece])
            inside = (new >= low) & (new <= high) & np.isfinite(new)
            # a rounded excess can point out of a bracket that is as narrow as the rounding error
            done = ((np.abs(new - x) <= unit) & inside) | (high - low <= unit)
            new = np.where(inside, new, 0.5 * (low + high))
            x = new
            if done.all():
                break
        return x, closed

    def jumps(self, goal: float) -> list[Jump]:
        """Return the jumps up to `goal`, the largest load on loading or the smallest on unloading."""
        sums = self.asperities.sums
        if self.forward:
            sign, best = 1.0, np.maximum.accumulate(np.append(0.0, self.best[:-1]))
        else:
            sign, best = -1.0, self.best
        fresh = np.flatnonzero(np.append(True, np.diff(sign * best) > 0.0) & (sign * best <= sign * goal))
        level, before, after = best[fresh], np.zeros(len(fresh)), np.zeros(len(fresh))
        # a jump begins at the end of a piece; on loading, the first jump begins without contacts
        last = fresh - 1 if self.forward else fresh
        some = last >= 0
        before[some] = sums(self.stop[last[some]], self.closed[last[some]]).area
        piece = np.searchsorted(sign * self.best, sign * level, side="right")
        held = piece < len(self.best)
        after[held] = sums(*self.approach(level[held], piece[held])).area
        return [Jump(*map(float, each)) for each in zip(level, before, after, strict=True)]
