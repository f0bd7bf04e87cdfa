"""Shapes of caps: surfaces of revolution with any increasing profile, one for all asperities or one each."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, NoReturn

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.errors import InvalidInput, refuse_if

Values = FloatArray | float

# Number of points along a meridian at which its length and curvature are computed, and number of ring
# spacings for which the chord error is computed: the lengths are then exact to 1e-7, the errors to 0.1 %.
POINTS, SPACINGS = 4097, 129


class Cap(ABC):
    """Shape of the caps of a surface: a profile f(rho) below the summit, which increases with rho.

    If `scaled` is true, all lengths are proportional to the radius R of the asperity; otherwise all caps have
    the same profile, whatever R is. Lengths over this scale are called unit lengths. In the elastic contact
    of a cap with a rigid plane, ``D(s) = s int_0^s f'(rho)/sqrt(s^2 - rho^2) drho`` is the indentation at the
    contact radius s, ``P(a) = 2 int_0^a s D' ds`` the load and ``M(a) = 4/3 int_0^a s^3 D' ds`` the second
    moment of the pressure, both over E*. Popov and Hess, Method of Dimensionality Reduction in Contact
    Mechanics and Friction (2015), doi:10.1007/978-3-642-53876-6.
    """

    scaled: ClassVar[bool] = True

    @property
    def extent(self) -> float:
        """Unit distance from the axis at which the profile ends; infinite if it has no end."""
        return math.inf

    @property
    def reach(self) -> float:
        """Largest contact radius, a unit length."""
        return self.extent

    @abstractmethod
    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return the radii of curvature of summits [mm]; raise InvalidInput if a summit has none."""

    @abstractmethod
    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth f at distances rho from the axis."""

    @abstractmethod
    def unit_foot(self, height: FloatArray) -> FloatArray:
        """Return the distances from the axis at which the depth is the height."""

    @abstractmethod
    def unit_depth(self, a: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return D and D' at contact radii."""

    @abstractmethod
    def unit_load(self, a: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return P and M at contact radii."""

    def at(self, some: Any) -> Cap:
        """Return the caps of some asperities, given by indices or by a mask: here the cap itself."""
        return self

    def one(self, i: int) -> Cap:
        """Return the cap of asperity i: here the cap itself."""
        return self

    def scale(self, radius: Values) -> FloatArray:
        """Return the lengths [mm] of which unit lengths are multiples."""
        return np.asarray(radius) if self.scaled else np.ones_like(radius)

    def tallest(self, radius: FloatArray) -> FloatArray:
        """Return the largest possible heights of caps [mm], (n,): the depth at the extent."""
        if math.isinf(self.extent):
            return np.full_like(radius, math.inf)
        return np.asarray(self.scale(radius) * float(self.unit_profile(np.array(self.extent))))

    def foot_radius(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the distances [mm] at which the depth is the height, if these are within the extent."""
        scale = self.scale(radius)
        return np.asarray(scale * self.unit_foot(np.asarray(height / scale)))

    def depth_at(self, distance: Values, radius: Values) -> FloatArray:
        """Return the depth below the summit [mm] at distances from the axis.

        Beyond the largest contact radius the profile continues along its tangent, because resolved contacts
        also have cells there.
        """
        scale = self.scale(radius)
        rho = np.asarray(distance / scale)
        if math.isinf(self.reach):
            return np.asarray(scale * self.unit_profile(rho))
        before = (1.0 - 1e-8) * self.reach  # a difference over the square root of machine precision
        low, high = self.unit_profile(np.array([before, self.reach]))
        inside = np.minimum(rho, self.reach)
        slope = (high - low) / (self.reach - before)
        return np.asarray(scale * (self.unit_profile(inside) + slope * (rho - inside)))

    def ring_count(self, height: FloatArray, radius: FloatArray, chord_error: float) -> FloatArray:
        """Return how many rings, (n,), keep the triangles within the chord error [mm] of the caps.

        Rings of 6, 12, 18, ... points lie at equal distances D along the meridian; neighbouring points are at
        most pi/3 D apart along a ring. A triangle lies within ``D^2/8 (k1 + (pi/3)^2 k2)`` of the cap, where
        k1 is the curvature along the meridian and k2 the curvature across it. The curvature may be infinite
        at the summit: k1 is its largest value beyond the arc length D/4, and k2 that beyond the first ring.
        """
        scale = self.scale(radius)
        across, along, foot = self._meridian(height / scale)
        angle = np.arctan(np.gradient(self.unit_profile(across), across))
        k1 = np.abs(np.gradient(angle, along))
        k2 = np.abs(np.sin(angle)) / np.maximum(across, across[1])
        most1, most2 = (np.maximum.accumulate(k[::-1])[::-1] for k in (k1, k2))
        spacing = along[-1] * np.geomspace(4.0 / POINTS, 1.0, SPACINGS)
        at_summit, outside = np.searchsorted(along, 0.25 * spacing), np.searchsorted(along, spacing)
        bend = most1[at_summit] + (math.pi / 3.0) ** 2 * most2[np.minimum(outside, POINTS - 1)]
        error = np.maximum.accumulate(spacing**2 / 8.0 * bend)
        wanted = np.log(chord_error / scale)
        found = np.interp(wanted, np.log(error), np.log(spacing))
        found += np.minimum(wanted - math.log(error[0]), 0.0)  # finer: the error falls at least linearly
        return np.asarray(np.interp(foot, across, along) / np.exp(found))

    def rings(self, height: FloatArray, radius: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the distances of summit and rings from the axis, and their heights, (n, count + 1) [mm]."""
        scale = self.scale(radius)[:, None]
        across, along, foot = self._meridian(height / scale[:, 0])
        length = np.interp(foot, across, along)
        x = np.interp(length[:, None] * np.arange(count + 1) / count, along, across)
        x[:, -1] = foot
        z = height[:, None] - scale * self.unit_profile(x)
        z[:, -1] = 0.0
        return np.asarray(scale * x), np.asarray(z)

    def _meridian(self, height: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return distances from the axis and arc lengths along a meridian, and the foot radii of all caps.

        The meridian ends at the foot of the tallest cap.
        """
        foot = self.unit_foot(height)
        across = foot.max() * np.linspace(0.0, 1.0, POINTS)
        steps = np.hypot(np.diff(across), np.diff(self.unit_profile(across)))
        return across, np.concatenate([[0.0], np.cumsum(steps)]), foot


def _of_each(name: str) -> Callable[..., FloatArray]:
    """Return a method of caps that differ: that of the cap of each asperity, which are the last axis."""

    def method(self: Caps, *values: Any) -> FloatArray:
        values = np.broadcast_arrays(*values)
        found = np.empty(values[0].shape)
        for k, kind in enumerate(self.kinds):
            own = self.index == k
            found[..., own] = getattr(kind, name)(*(value[..., own] for value in values))
        return found

    return method


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

    def _no_common_one(self, *arguments: Any) -> NoReturn:
        """Raise TypeError: the profiles differ."""
        raise TypeError("caps that differ have no common profile")

    unit_profile = unit_foot = unit_depth = unit_load = depth_at = _no_common_one  # type: ignore[assignment]

    summit_radius, tallest = _of_each("summit_radius"), _of_each("tallest")
    foot_radius, ring_count = _of_each("foot_radius"), _of_each("ring_count")

    def rings(self, height: FloatArray, radius: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the distances of summit and rings from the axis, and their heights, (n, count + 1) [mm]."""
        across, z = (np.empty((len(height), count + 1)) for _ in range(2))
        for k, kind in enumerate(self.kinds):
            own = self.index == k
            across[own], z[own] = kind.rings(height[own], radius[own], count)
        return across, z


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
