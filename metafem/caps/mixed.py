"""Caps that differ from asperity to asperity."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.caps.cap import Cap
from metafem.errors import InvalidInput, refuse_if


@dataclass(frozen=True, eq=False, repr=False)
class Caps(Value, Cap):
    """One cap for each asperity: the different caps and, for each asperity, the index of its cap."""

    scaled: ClassVar[bool] = False

    kinds: tuple[Cap, ...]
    index: IntArray  # (n,), indices in `kinds`

    @classmethod
    def of(cls, caps: Iterable[Cap]) -> Cap:
        """Return the caps of asperities, or the cap itself if all are equal."""
        kinds: dict[Cap, int] = {}
        index = np.array([kinds.setdefault(cap, len(kinds)) for cap in caps], dtype=np.int64)
        return cls(tuple(kinds), index).simplest()

    def simplest(self) -> Cap:
        """Return the caps with only the kinds in use, in the order of first use; one cap if all are equal."""
        used, first, inverse = np.unique(self.index, return_index=True, return_inverse=True)
        order = np.argsort(first)
        if len(used) == 1:
            return self.kinds[int(used[0])]
        index = np.argsort(order)[inverse]
        index.flags.writeable = False
        return Caps(tuple(self.kinds[k] for k in used[order]), index)

    def __repr__(self) -> str:
        counts = np.bincount(self.index)
        return ", ".join(f"{count} of {kind!r}" for kind, count in zip(self.kinds, counts, strict=True))

    def __len__(self) -> int:
        return len(self.index)

    def at(self, some: Any) -> Cap:
        """Return the caps of some asperities, given by indices or by a mask."""
        return Caps(self.kinds, self.index[some]).simplest()

    def one(self, i: int) -> Cap:
        """Return the cap of asperity i."""
        return self.kinds[int(self.index[i])]

    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Raise TypeError: the profiles differ."""
        raise TypeError("caps that differ have no common profile")

    def depth_at(self, distance: FloatArray, radius: float) -> FloatArray:
        """Raise TypeError: the profiles differ."""
        return self.unit_profile(distance)

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return the radii of curvature of the summits [mm], (..., n)."""
        return self._each(lambda cap, size: cap.summit_radius(size), radius)

    def tallest(self, radius: FloatArray) -> FloatArray:
        """Return the largest possible heights of caps [mm], (n,)."""
        return self._each(lambda cap, size: cap.tallest(size), radius)

    def foot_radius(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the foot radii at the base plane [mm], (n,)."""
        return self._each(lambda cap, h, size: cap.foot_radius(h, size), height, radius)

    def volume(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the volumes [mm^3], (n,)."""
        return self._each(lambda cap, h, size: cap.volume(h, size), height, radius)

    def largest_area(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return upper bounds of the areas [mm^2], (n,)."""
        return self._each(lambda cap, h, size: cap.largest_area(h, size), height, radius)

    def ring_count(self, height: FloatArray, radius: FloatArray, chord_error: float) -> FloatArray:
        """Return how many rings, (n,), keep the triangles within the chord error [mm] of the caps."""
        return self._each(lambda cap, h, size: cap.ring_count(h, size, chord_error), height, radius)

    def rings(self, height: FloatArray, radius: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the distances of summit and rings from the axis, and their heights, (n, count + 1) [mm]."""
        across, z = (np.empty((len(height), count + 1)) for _ in range(2))
        for k, kind in enumerate(self.kinds):
            own = self.index == k
            across[own], z[own] = kind.rings(height[own], radius[own], count)
        return across, z

    def _each(self, method: Callable[..., FloatArray], *values: FloatArray) -> FloatArray:
        """Return the values (..., n) of a method of each cap; the last axis is that of the asperities."""
        found = np.empty(np.broadcast_shapes(*map(np.shape, values)))
        for k, kind in enumerate(self.kinds):
            own = self.index == k
            found[..., own] = method(kind, *(value[..., own] for value in values))
        return found


def caps_of(cap: Any, count: int) -> Cap:
    """Return the caps of asperities, from one cap for all or a sequence of one for each."""
    words = "must be a cap such as metafem.Sphere() or metafem.Power(4), or one for each asperity"
    if isinstance(cap, type) or not isinstance(cap, (Cap, list, tuple, np.ndarray)):
        raise InvalidInput(words, key="cap", value=repr(cap))
    if isinstance(cap, Cap) and not isinstance(cap, Caps):
        return cap
    given = [cap.one(i) for i in range(len(cap))] if isinstance(cap, Caps) else list(cap)
    for i, one in enumerate(given):
        if isinstance(one, Caps) or not isinstance(one, Cap):
            raise InvalidInput(words, key=f"cap[{i}]", value=repr(one))
    refuse_if(len(given) != count, f"has {len(given)} caps for {count} asperities", key="cap")
    return cap if isinstance(cap, Caps) else Caps.of(given)
