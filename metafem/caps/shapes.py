"""Shapes of caps: spheres, paraboloids and power laws, one for all asperities or one each."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, NoReturn

import numpy as np
from scipy.special import hyp2f1

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.errors import InvalidInput, refuse_if

Values = FloatArray | float

# Largest exponent of a power cap, which is then a nearly flat punch. With larger exponents (a/R)^n would
# underflow for small contacts.
STEEPEST = 32.0

# Refusal of Hertz's law for caps such as those of power 4.
NO_CURVATURE = "has no finite curvature at its summit, which this contact law needs; use contact = Elastic()"


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
    extent: float = math.inf  # unit distance from the axis at which the profile ends

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
        spacing = along[-1] * np.geomspace(1e-3, 1.0, 129)  # the errors between are then exact to 0.1 %
        at_summit, outside = (np.searchsorted(along, part * spacing * (1.0 - 1e-12)) for part in (0.25, 1.0))
        error = np.maximum.accumulate(
            spacing**2 / 8.0 * (most1[at_summit] + (math.pi / 3.0) ** 2 * most2[outside])
        )
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
        across = foot.max() * np.linspace(0.0, 1.0, 4097)  # its length is then exact to 1e-7
        steps = np.hypot(np.diff(across), np.diff(self.unit_profile(across)))
        return across, np.concatenate([[0.0], np.cumsum(steps)]), foot


def foot_radius(height: Values, radius: Values) -> FloatArray:
    """Return the foot radius of a sphere of height h <= R at the base plane, sqrt(h (2 R - h)) [mm]."""
    return np.asarray(np.sqrt(height * (2.0 * radius - height)))


def sphere_profile(r: FloatArray, radius: Values) -> FloatArray:
    """Return the depth R - sqrt(R^2 - r^2) [mm] below a sphere's summit at r <= R, without cancellation."""
    return np.asarray(r**2 / (radius + np.sqrt((radius - r) * (radius + r))))


@dataclass(frozen=True)
class Sphere(Cap):
    """Spherical caps: ``f(rho) = R - sqrt(R^2 - rho^2)``, at most R high.

    With ``L = artanh(a/R)``, ``D = a L``, ``P/E* = (a^2 + R^2) L - a R`` and
    ``M/E* = ((a^4 + 3 R^4) L - a^3 R - 3 a R^3)/3``. Load and indentation grow without limit towards the
    equator, so contacts end at a = 0.9994 R, where D = 4.05 R. Sneddon, Int. J. Eng. Sci. 3, 47 (1965),
    doi:10.1016/0020-7225(65)90019-4.

    Examples
    --------
    >>> Sphere().foot_radius(np.array([0.12]), np.array([0.526])).round(4)
    array([0.3344])
    """

    extent = 1.0
    reach = 0.9994  # where the slope of the profile is 29

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return R [mm]."""
        return radius

    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth for R = 1; beyond the equator, 1."""
        return sphere_profile(np.minimum(rho, 1.0), 1.0)

    def unit_foot(self, height: FloatArray) -> FloatArray:
        """Return the foot radii for R = 1."""
        return foot_radius(height, 1.0)

    def unit_depth(self, a: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return D and D' for R = 1."""
        angle = np.arctanh(a)
        return a * angle, angle + a / ((1.0 - a) * (1.0 + a))

    def unit_load(self, a: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return P and M for R = 1: L - a and L - a - a^3/3 as series that do not cancel."""
        angle, square = np.arctanh(a), a**2
        second = a**3 / 3.0 * hyp2f1(1.0, 1.5, 2.5, square)
        fourth = a**5 / 5.0 * hyp2f1(1.0, 2.5, 3.5, square)
        return square * angle + second, square**2 * angle / 3.0 + fourth


# Default cap of surfaces.
SPHERE = Sphere()


class PowerLaw(Cap):
    """Caps with the profile ``f(rho) = c R (rho/R)^n``.

    With ``K = sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2)``, ``D = c R K (a/R)^n``, ``P/E* = 2 n/(n + 1) a D``
    and ``M = 2 (n + 1)/(3 (n + 3)) P a^2``. Galin (1946); Sneddon (1965).
    """

    exponent: float
    coefficient: float

    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth for R = 1."""
        return np.asarray(self.coefficient * rho**self.exponent)

    def unit_foot(self, height: FloatArray) -> FloatArray:
        """Return the foot radii for R = 1."""
        return np.asarray((height / self.coefficient) ** (1.0 / self.exponent))

    def unit_depth(self, a: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return D and D' for R = 1."""
        n = self.exponent
        ratio = math.sqrt(math.pi) * math.gamma(0.5 * n + 1.0) / math.gamma(0.5 * (n + 1.0))
        slope = n * self.coefficient * ratio * a ** (n - 1.0)
        return a * slope / n, slope

    def unit_load(self, a: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return P and M for R = 1."""
        n, depth = self.exponent, self.unit_depth(a)[0]
        return 2.0 * n / (n + 1.0) * a * depth, 4.0 / 3.0 * n / (n + 3.0) * a**3 * depth


@dataclass(frozen=True)
class Paraboloid(PowerLaw):
    """Paraboloids of revolution: ``f(rho) = rho^2/(2 R)``.

    Examples
    --------
    >>> Paraboloid().foot_radius(np.array([0.12]), np.array([0.526])).round(4)
    array([0.3553])
    """

    exponent = 2.0
    coefficient = 0.5

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return R [mm]."""
        return radius


@dataclass(frozen=True)
class Power(PowerLaw):
    """Caps with a power-law profile: ``f(rho) = c R (rho/R)^n``.

    R only scales the profile. ``Power(2, 0.5)`` is `Paraboloid`.

    Parameters
    ----------
    exponent : float
        n [-], greater than 1 and at most 32.
    coefficient : float
        c [-], greater than 0; default: 0.5.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> Power(4).foot_radius(np.array([0.12]), np.array([0.526])).round(4)
    array([0.4323])
    """

    exponent: float
    coefficient: float = 0.5

    def __post_init__(self) -> None:
        check.member(self, "exponent", above=1.0, at_most=STEEPEST)
        check.member(self, "coefficient", above=0.0)

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return R/(2 c) [mm] for n = 2; other powers have no curvature at the summit, or an infinite one."""
        if self.exponent != 2.0:
            raise InvalidInput(NO_CURVATURE, key="cap", value=repr(self))
        return radius / (2.0 * self.coefficient)


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
