"""Unknowns of a search: heights within a span or with separate limits, and their random changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray

# Relative differences (k,) [-] from a law, and a function that returns their Jacobian (k, n) [1/mm]. The
# Jacobian takes longer to compute than the differences, and most steps do not need it.
LateResidual = tuple[FloatArray, Callable[[], FloatArray]]

# Function that returns the differences and the function for their Jacobian at unknowns (n,) [mm].
Residual = Callable[[FloatArray], LateResidual]

# A height within this fraction of the span from a limit counts as at the limit, because of rounding.
AT_LIMIT = 1e-9

# Depth of sites without an asperity below the lowest allowed height, relative to the span. No contact is so
# deep.
ABSENT = 100.0

# Random changes: fractions of the heights that move, probability that asperities are added, probability that
# otherwise one asperity is removed, and maximum number of added asperities.
CHANGE_FRACTIONS = (0.2, 0.5, 1.0)
ADDING, REMOVING, MOST_ADDED = 0.5, 0.3, 5


@dataclass(frozen=True)
class Heights:
    """Unknowns of a search: heights (n,) that differ by at most `span` [mm].

    A random change may add a few asperities, up to `most` in total, or remove one. If `most` is None, the
    number of asperities is fixed.
    """

    span: float
    most: int | None = None

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the heights (n,) [mm]; heights more than `span` below the tallest are raised."""
        return np.asarray(np.maximum(unknowns, unknowns.max() - self.span))

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return the index of the tallest height, and the indices of the heights `span` below it, (m,)."""
        tallest = int(unknowns.argmax())
        return tallest, np.flatnonzero(unknowns <= unknowns[tallest] - self.span * (1.0 - AT_LIMIT))

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, sizes: tuple[float, ...]) -> FloatArray:
        """Return heights moved at random by about their spacing, with a few added or removed."""
        return moved(unknowns, self.most, rng, sizes, self.span)[0]

    def held(self, residual: Residual) -> Residual:
        """Return the residual unchanged, because there are no fixed heights."""
        return residual


@dataclass(frozen=True, eq=False)
class Bounded:
    """Heights (n,) from `low` to `high` [mm]; the heights with the indices `rows` have the fixed `values`.

    Each height is bounded separately. A height at a limit does not move if a step down the gradient ``J' r``
    would move it beyond the limit (a projected gradient). Its column of the Jacobian J is then set to zero,
    as for fixed heights. A site without an asperity has the height `absent`, far below all contacts.
    """

    low: float
    high: float
    rows: IntArray
    values: FloatArray

    @property
    def absent(self) -> float:
        """Height of sites without an asperity [mm]."""
        return self.low - ABSENT * (self.high - self.low)

    def exists(self, height: FloatArray) -> NDArray[np.bool_]:
        """Return whether there is an asperity at each site, (n,)."""
        return np.asarray(height > self.absent)

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the nearest heights within the limits, with the fixed heights, (n,) [mm]."""
        exists = self.exists(unknowns)
        height = np.where(exists, np.clip(unknowns, self.low, self.high), self.absent)
        height[self.rows] = self.values
        return height

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return index 0 and no indices of lowest heights, because `held` treats heights at a limit."""
        return 0, np.empty(0, dtype=np.int64)

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, sizes: tuple[float, ...]) -> FloatArray:
        """Return heights moved at random by about their spacing, with a few added or removed."""
        height, on = unknowns.copy(), np.flatnonzero(self.exists(unknowns))
        height[on] = moved(unknowns[on], None, rng, sizes, self.high - self.low)[0]
        free = np.flatnonzero(~self.exists(unknowns))
        if free.size and rng.random() < ADDING:
            number = int(rng.integers(1, min(MOST_ADDED, free.size) + 1))
            height[rng.choice(free, number, replace=False)] = rng.choice(height[on], number)
        elif rng.random() < REMOVING:
            height[rng.choice(on)] = self.absent
        return self.project(height)

    def held(self, residual: Residual) -> Residual:
        """Return the residual with zero derivatives with respect to fixed heights and heights at a limit."""
        near = AT_LIMIT * (self.high - self.low)

        def bounded(height: FloatArray) -> LateResidual:
            r, compute = residual(height)

            def jacobian() -> FloatArray:
                found = compute()
                slope = r @ found if np.isfinite(r).all() else np.zeros(len(height))
                stay = (height <= self.low + near) & (slope > 0.0)
                stay |= (height >= self.high - near) & (slope < 0.0)
                stay |= ~self.exists(height)
                stay[self.rows] = True
                return np.where(stay, 0.0, found)

            return r, jacobian

        return bounded


def moved(
    height: FloatArray, most: int | None, rng: np.random.Generator, sizes: tuple[float, ...], span: float
) -> tuple[FloatArray, IntArray]:
    """Return heights moved at random by about their spacing, and the original index of each height.

    The spacing of equal heights is that of as many heights over the span [mm].
    """
    n = len(height)
    every = np.arange(n)
    spacing = (float(np.ptp(height)) or span) / n * rng.choice(sizes)
    result = height + spacing * rng.standard_normal(n) * (rng.random(n) < rng.choice(CHANGE_FRACTIONS))
    if most is None:
        return result, every
    if n < most and rng.random() < ADDING:
        source = rng.integers(n, size=rng.integers(1, min(MOST_ADDED, most - n) + 1))
        new = height[source] + spacing * rng.standard_normal(len(source))
        return np.append(result, new), np.append(every, source)
    if n > 2 and rng.random() < REMOVING:
        removed = rng.integers(n)
        return np.delete(result, removed), np.delete(every, removed)
    return result, every
