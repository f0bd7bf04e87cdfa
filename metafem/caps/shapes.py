"""Caps with closed forms: spheres, paraboloids and power laws."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.caps.cap import RING_ARC, Cap, Values
from metafem.errors import InvalidInput

# Largest exponent of a power cap, which is then a nearly flat punch. With larger exponents (a/R)^n would
# underflow for small contacts.
STEEPEST = 32.0


def foot_radius(height: Values, radius: Values) -> FloatArray:
    """Return the foot radius of a sphere of height h <= R at the base plane, sqrt(h (2 R - h)) [mm]."""
    return np.asarray(np.sqrt(height * (2.0 * radius - height)))


def sphere_profile(r: FloatArray, radius: Values) -> FloatArray:
    """Return the depth R - sqrt(R^2 - r^2) [mm] below a sphere's summit at r <= R, without cancellation."""
    return np.asarray(r**2 / (radius + np.sqrt((radius - r) * (radius + r))))


@dataclass(frozen=True)
class Sphere(Cap):
    """Spherical caps: ``f(rho) = R - sqrt(R^2 - rho^2)``, at most R high.

    Examples
    --------
    >>> Sphere().foot_radius(np.array([0.12]), np.array([0.526])).round(4)
    array([0.3344])
    """

    @property
    def extent(self) -> float:
        """Distance from the axis over R at which the profile ends, 1."""
        return 1.0

    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth for R = 1; beyond the equator, 1."""
        return np.asarray(1.0 - np.sqrt(np.maximum(1.0 - rho**2, 0.0)))

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return R [mm]."""
        return radius

    def tallest(self, radius: FloatArray) -> FloatArray:
        """Return the largest possible heights of caps, R [mm], (n,)."""
        return radius

    def foot_radius(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the foot radii at the base plane [mm], (n,)."""
        return foot_radius(height, radius)

    def depth_at(self, distance: FloatArray, radius: float) -> FloatArray:
        """Return the depth below the summit [mm] at distances from the axis; beyond the equator, R."""
        return np.asarray(radius - np.sqrt(np.maximum(radius**2 - distance**2, 0.0)))

    def volume(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the volumes pi h^2 (3 R - h)/3 [mm^3], (n,)."""
        return np.asarray(math.pi * height**2 * (3.0 * radius - height) / 3.0)

    def largest_area(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the areas of the caps, 2 pi R h [mm^2], (n,)."""
        return np.asarray(2.0 * math.pi * radius * height)

    def ring_count(self, height: FloatArray, radius: FloatArray, chord_error: float) -> FloatArray:
        """Return how many rings, (n,), keep the triangles within the chord error [mm] of the spheres.

        Rings of 6, 12, 18, ... points lie at equal distances D along the meridian. Neighbouring points are at
        most pi/3 D apart along a ring. The circumradius of a triangle is therefore at most that of a right
        triangle with the sides D and pi/3 D, which lies up to ``(1 + (pi/3)^2) D^2 / (8 R)`` below the
        sphere.
        """
        step = np.sqrt(8.0 * chord_error / ((1.0 + RING_ARC**2) * radius))
        return np.asarray(self._opening(height, radius) / step)

    def rings(self, height: FloatArray, radius: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the distances of summit and rings from the axis, and their heights, (n, count + 1) [mm]."""
        polar = self._opening(height, radius)[:, None] * np.arange(count + 1) / count
        across = radius[:, None] * np.sin(polar)
        z = height[:, None] - 2.0 * radius[:, None] * np.sin(0.5 * polar) ** 2
        across[:, -1] = foot_radius(height, radius)
        z[:, -1] = 0.0
        return across, z

    def _opening(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the polar angles of the feet [rad], from ``h = R (1 - cos(angle)) = 2 R sin^2(angle/2)``."""
        return np.asarray(2.0 * np.arcsin(np.sqrt(0.5 * height / radius)))


SPHERE = Sphere()


@dataclass(frozen=True)
class Paraboloid(Cap):
    """Paraboloids of revolution: ``f(rho) = rho^2/(2 R)``.

    Examples
    --------
    >>> Paraboloid().foot_radius(np.array([0.12]), np.array([0.526])).round(4)
    array([0.3553])
    """

    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth for R = 1."""
        return np.asarray(0.5 * rho**2)

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return R [mm]."""
        return radius


@dataclass(frozen=True)
class Power(Cap):
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

    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth for R = 1."""
        return np.asarray(self.coefficient * rho**self.exponent)

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return R/(2 c) [mm] for n = 2; other powers have no curvature at the summit, or an infinite one."""
        if self.exponent != 2.0:
            words = (
                "has no finite curvature at its summit, which this contact law needs; use contact = Elastic()"
            )
            raise InvalidInput(words, key="cap", value=repr(self))
        return radius / (2.0 * self.coefficient)
