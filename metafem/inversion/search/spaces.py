"""Heights within absolute limits, of which some are given, as the unknowns of a search.

Each height is bounded by itself. A height at a limit stays there while a step down the gradient ``J' r``
would push it beyond (a projected gradient); its column of the Jacobian J counts as zero, like those of given
heights.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem.inversion.search.levenberg_marquardt import LateResidual, Residual, moved
from metafem.inversion.search.options import SearchOptions

# Heights this fraction of the span from a limit are at it: rounding.
AT_LIMIT = 1e-9

# Height of sites without an asperity below the lowest that is allowed, over the span: no contact is as deep.
ABSENT = 100.0


@dataclass(frozen=True, eq=False)
class Bounded:
    """Heights (n,) from `low` to `high` [mm], of which those of the indices `rows` have given values.

    A site without an asperity has the height `absent`, far below all contacts.
    """

    low: float
    high: float
    rows: IntArray
    values: FloatArray

    @property
    def absent(self) -> float:
        """The height of sites without an asperity [mm]."""
        return self.low - ABSENT * (self.high - self.low)

    def exists(self, height: FloatArray) -> NDArray[np.bool_]:
        """Whether there is an asperity at each site."""
        return np.asarray(height > self.absent)

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the nearest heights within the limits, with the given ones."""
        exists = self.exists(unknowns)
        height = np.where(exists, np.clip(unknowns, self.low, self.high), self.absent)
        height[self.rows] = self.values
        return height

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return that no height follows another: `held` holds those at a limit."""
        return 0, np.empty(0, dtype=np.int64)

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, options: SearchOptions) -> FloatArray:
        """Return heights moved at random by about their spacing, with a few added or removed."""
        height, on = unknowns.copy(), np.flatnonzero(self.exists(unknowns))
        height[on] = moved(unknowns[on], None, rng, options)[0]
        free = np.flatnonzero(~self.exists(unknowns))
        if free.size and rng.random() < options.adding:
            number = int(rng.integers(1, min(options.most_added, free.size) + 1))
            height[rng.choice(free, number, replace=False)] = rng.choice(height[on], number)
        elif rng.random() < options.removing:
            height[rng.choice(on)] = self.absent
        return self.project(height)

    def held(self, residual: Residual) -> Residual:
        """Return a residual without the derivatives by heights that stay."""
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
