"""Handles of targets that consist of points."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.text.marks import COLUMNS, Handle, Numbers, Scene, members
from metafem.explorer.text.written import between

# Largest number of points that have handles. With more points, the marks would overlap on the plot, and
# moving a single point would make a spike in the law.
MOST = 200


class PointHandles(Scene):
    """Handles for operating points and samples. Each point moves freely between its neighbours."""

    @property
    def crowd(self) -> int:
        """The number of points of the target if it has too many points for handles, otherwise 0."""
        count = len(self.target.rescaled_load)
        return count if count > MOST else 0

    @property
    def points(self) -> tuple[list[float], list[float]]:
        """Rescaled loads and frictions of the target [mm^2]."""
        return self.target.rescaled_load.tolist(), self.target.rescaled_friction.tolist()

    def handles(self) -> tuple[Handle, ...]:
        """Return a handle for each point, or none for too many points."""
        loads, frictions = self.points
        count = len(loads)
        if self.crowd:
            return ()
        return tuple(
            Handle(f"point-{i}", load, friction, "xy", f"point {i + 1} of {count}")
            for i, (load, friction) in enumerate(zip(loads, frictions, strict=True))
        )

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return the points."""
        return self.target.rescaled_load, self.target.rescaled_friction

    def moved(self, handle: Handle, load: float, friction: float, resolution: float) -> tuple[Numbers, float]:
        """Return the points with one point moved, and the resolution of its values."""
        return self._placed(_index(handle.id), self._columns(), (load, friction), resolution)

    def added(self, load: float, friction: float, resolution: float) -> tuple[Numbers, float]:
        """Return the points with one more point, and the resolution of its values."""
        columns, count = self._columns(), len(self.points[0])
        i = sum(other <= load for other in self.points[0])
        for name, entries in columns.items():
            entries.insert(i, 1.0 if name == "weight" else entries[min(i, count - 1)])
        return self._placed(i, columns, (load, friction), resolution)

    def removed(self, id: str) -> Numbers:
        """Return the points without one of them."""
        columns = self._columns()
        if len(self.points[0]) == 1:
            raise InvalidInput("the last point cannot be removed; a target needs at least one")
        for entries in columns.values():
            del entries[_index(id)]
        return columns

    def _placed(
        self, i: int, columns: Numbers, at: tuple[float, float], resolution: float
    ) -> tuple[Numbers, float]:
        """Return the columns with point `i` moved between its neighbours, and the resolution."""
        finest = resolution
        for numbers, value in zip(columns.values(), at, strict=False):
            low, high = [0.0, *numbers][i], [*numbers, math.inf][i + 1]
            if low >= high:  # the friction of noisy samples may decrease
                low, high = 0.0, math.inf
            placed, fine = between(value, low, high, resolution)
            numbers[i] = placed or resolution * numbers[i]  # a single point must not reach 0
            finest = min(finest, fine)
        return columns, finest

    def _columns(self) -> Numbers:
        """Return loads and frictions, and the other columns that the text has."""
        optional = {"weight", "relative_error"} - self.section.keys()
        return members(self.target, [name for name in COLUMNS if name not in optional])


def _index(id: str) -> int:
    """Return the number of the point of a handle."""
    return int(id.removeprefix("point-"))


class BandCurves(Scene):
    """The two curves of a band, without handles; the values are edited in the text."""

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return the two curves, with a gap between them."""
        target = self.target
        load, gap = target.rescaled_load, [math.nan]
        return np.concatenate([load, gap, load]), np.concatenate([target.lowest, gap, target.highest])
