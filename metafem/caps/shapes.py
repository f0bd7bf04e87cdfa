"""Caps with closed forms: spheres, paraboloids and power laws."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import hyp2f1

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.caps.cap import Cap, Values
from metafem.errors import InvalidInput

# Largest exponent of a power cap, which is then a nearly flat punch. With larger exponents (a/R)^n would
# underflow for small contacts.
STEEPEST = 32.0

NO_CURVATURE = "has no finite curvature at its summit, which this contact law needs; use contact = Elastic()"


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

    @property
    def extent(self) -> float:
        """Distance from the axis over R at which the profile ends, 1."""
        return 1.0

    @property
    def reach(self) -> float:
        """Largest contact radius over R, at which the slope of the profile is 29."""
        return 0.9994

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
