"""Elastic contact of axisymmetric caps without adhesion, by the method of dimensionality reduction."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from scipy.special import digamma, gammaln

from metafem._validate import FloatArray
from metafem.caps.shapes import sphere_profile
from metafem.contact.law import Contact, Values

if TYPE_CHECKING:
    from metafem.surface import Surface

# Newton's method in the logarithm reaches rounding in 4 to 8 steps; this limit also allows for halved steps.
MAX_STEPS = 60

# Below a/R = SERIES_LIMIT the closed forms of the sphere suffer from cancellation, so series are used. Their
# relative truncation error is about 0.3^40.
SERIES_LIMIT, SERIES_TERMS = 0.3, 20

# Distance from the axis over R beyond which the profile of a sphere continues along its tangent, to stay
# finite.
STEEP = 0.999


class ElasticCap(Contact):
    """Contact law of an elastic cap with the profile f(rho), without adhesion.

    With ``D(s) = s int_0^s f'(rho)/sqrt(s^2 - rho^2) drho`` and an extra curvature k, ``d = D(a) + k a^2``,
    ``P/E* = 2 int_0^a s (D' + 2 k s) ds`` and the second moment of the pressure over E* is
    ``4/3 int_0^a s^3 (D' + 2 k s) ds``. It follows that dP/dd = 2 a E*. Popov and Hess, Method of
    Dimensionality Reduction in Contact Mechanics and Friction (2015), doi:10.1007/978-3-642-53876-6.
    """

    largest_order: ClassVar[int] = 3
    similar: ClassVar[bool] = True

    @abstractmethod
    def depth_at(self, distance: Values, radius: Values) -> FloatArray:
        """Return the depth f [mm] of the cap below its summit at a distance rho [mm] from the axis.

        Beyond the end of a cap the profile continues along its tangent, because resolved contacts also have
        cells there.
        """

    @abstractmethod
    def _depth(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        """Return D(a) [mm]."""

    @abstractmethod
    def _slope(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        """Return D'(a) [-]."""

    @abstractmethod
    def _load(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        """Return 2 int_0^a s D' ds [mm^2]."""

    @abstractmethod
    def _moment(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        """Return 4/3 int_0^a s^3 D' ds [mm^4]."""

    @abstractmethod
    def _closed_radius(self, depth: FloatArray, radius: FloatArray, curvature: FloatArray) -> FloatArray:
        """Return the contact radius [mm] of closed contacts with the indentation depth > 0 [mm]."""

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return R of all asperities [mm]: the law has a profile of its own."""
        return surface.radius if radius is None else radius

    def contact_radius(self, indentation: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the contact radius a [mm], the root of D(a) + k a^2 = d; 0 where the contact is open.

        D(a) + k a^2 must increase with a, as it does for k >= 0.
        """
        given = (np.asarray(value, dtype=np.float64) for value in (indentation, radius, curvature))
        d, size, extra = np.broadcast_arrays(*given)
        found = np.zeros(d.shape)
        closed = d > 0.0
        found[closed] = self._closed_radius(d[closed], size[closed], extra[closed])
        return found[()]

    def indentation(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the indentation d = D(a) + k a^2 [mm]."""
        a, size = np.asarray(contact_radius), np.asarray(radius)
        return np.asarray(self._depth(a, size) + curvature * a**2)[()]

    def load(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the rescaled load P/E* = 2 int_0^a s D' ds + 4/3 k a^3 [mm^2]."""
        a, size = np.asarray(contact_radius), np.asarray(radius)
        return np.asarray(self._load(a, size) + 4.0 / 3.0 * curvature * a**3)[()]

    def second_moment(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the second moment of the pressure over E*, 4/3 int_0^a s^3 D' ds + 8/15 k a^5 [mm^4]."""
        a, size = np.asarray(contact_radius), np.asarray(radius)
        return np.asarray(self._moment(a, size) + 8.0 / 15.0 * curvature * a**5)[()]

    def stiffness(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return d(P/E*)/dd = 2 a [mm]."""
        return np.multiply(2.0, contact_radius)

    def area_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return dA/dd = 2 pi a/(D' + 2 k a) [mm]; 0 for an open contact."""
        a, size = np.asarray(contact_radius, dtype=np.float64), np.asarray(radius)
        closed = a > 0.0
        slope = np.asarray(self._slope(a, size) + 2.0 * curvature * a)
        return np.asarray(2.0 * math.pi * a / np.where(closed, slope, 1.0))[()]


@dataclass(frozen=True)
class PowerCap(ElasticCap):
    """Frictionless, non-adhesive elastic contact of a rigid plane and a cap with a power-law profile.

    ``f(rho) = c R (rho/R)^n``. With the contact radius a, ``d = c R K (a/R)^n``, where
    ``K = sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2)``, ``A = pi a^2``, ``P/E* = 2 n/(n + 1) a d``, and the
    second moment of the pressure is ``2 (n + 1)/(3 (n + 3)) P a^2``. An extra curvature k adds the terms of a
    paraboloid. Lengths are in mm, P/E* in mm^2. The law assumes small strain: the profile must be flat,
    f' << 1. R only scales the profile. ``PowerCap(2, 0.5)`` is `Hertz`, and ``PowerCap(1, c)`` is a cone.
    Galin (1946) and Sneddon, Int. J. Eng. Sci. 3, 47 (1965), doi:10.1016/0020-7225(65)90019-4.

    Parameters
    ----------
    exponent : float
        n [-], from 1 to 32.
    coefficient : float
        c [-], greater than 0; default: 0.5.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> quartic = PowerCap(4, 0.5)
    >>> a = quartic.contact_radius(0.001, 0.526)
    >>> a.round(6), quartic.load(a, 0.526).round(9)
    (np.float64(0.102213), np.float64(0.00016354))
    """

    exponent: float
    coefficient: float = 0.5

    def depth_at(self, distance: Values, radius: Values) -> FloatArray:
        """Return the depth c R (rho/R)^n [mm] of the cap below its summit at a distance from the axis."""
        return np.asarray(self.coefficient * radius * np.divide(distance, radius) ** self.exponent)[()]

    @property
    def power(self) -> float:
        """Exponent n of the profile [-]."""
        return self.exponent

    def _factor(self) -> float:
        """Return c K [-]."""
        n = self.exponent
        return self.coefficient * math.sqrt(math.pi) * math.gamma(0.5 * n + 1.0) / math.gamma(0.5 * (n + 1.0))

    def _depth(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return np.asarray(self._factor() * radius * (a / radius) ** self.exponent)

    def _slope(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return np.asarray(self.exponent * self._factor() * (a / radius) ** (self.exponent - 1.0))

    def _load(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return np.asarray(2.0 * self.exponent / (self.exponent + 1.0) * a * self._depth(a, radius))

    def _moment(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return np.asarray(4.0 / 3.0 * self.exponent / (self.exponent + 3.0) * a**3 * self._depth(a, radius))

    def _closed_radius(self, depth: FloatArray, radius: FloatArray, curvature: FloatArray) -> FloatArray:
        alone = radius * (depth / (self._factor() * radius)) ** (1.0 / self.exponent)
        if not curvature.any():
            return alone
        # each term without the other gives too large a radius; for k <= 0 start from the radius without k
        with np.errstate(divide="ignore", invalid="ignore"):
            start = np.where(curvature > 0.0, np.minimum(alone, np.sqrt(depth / curvature)), alone)

        def parts(a: FloatArray) -> tuple[FloatArray, FloatArray]:
            own, extra = self._depth(a, radius), curvature * a**2
            return own + extra, self.exponent * own + 2.0 * extra

        return root(parts, depth, start)


@dataclass(frozen=True)
class SphericalCap(ElasticCap):
    """Frictionless, non-adhesive elastic contact of a sphere of radius R and a rigid plane.

    The profile is ``f(rho) = R - sqrt(R^2 - rho^2)``. With the contact radius a < R and
    ``L = ln((R + a)/(R - a))/2``, ``d = a L``, ``A = pi a^2``, ``P/E* = (a^2 + R^2) L - a R``, and the second
    moment of the pressure over E* is ``((a^4 + 3 R^4) L - a^3 R - 3 a R^3)/3``. An extra curvature adds the
    terms of a paraboloid. Lengths are in mm, P/E* in mm^2. The law assumes small strain. At large a/R its
    load exceeds that of a soft sphere, and Hertz's law with a fitted modulus is more accurate. At a/R = 0.5
    the two laws differ by about 10 %. Sneddon, Int. J. Eng. Sci. 3, 47 (1965),
    doi:10.1016/0020-7225(65)90019-4.

    Examples
    --------
    >>> sphere = SphericalCap()
    >>> a = sphere.contact_radius(0.1, 0.526)
    >>> a.round(6), sphere.load(a, 0.526).round(6)
    (np.float64(0.222061), np.float64(0.029997))
    """

    def depth_at(self, distance: Values, radius: Values) -> FloatArray:
        """Return the depth R - sqrt(R^2 - rho^2) [mm] below the summit at a distance rho from the axis.

        Beyond 0.999 R, where the slope is 22, the profile continues along its tangent.
        """
        rho, size = np.asarray(distance, dtype=np.float64), np.asarray(radius, dtype=np.float64)
        inside = np.minimum(rho, STEEP * size)
        slope = STEEP / math.sqrt(1.0 - STEEP**2)
        return np.asarray(sphere_profile(inside, size) + slope * (rho - inside))[()]

    def _depth(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return np.asarray(a * np.arctanh(a / radius))

    def _slope(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return np.asarray(np.arctanh(a / radius) + a * radius / ((radius - a) * (radius + a)))

    def _load(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        x = a / radius
        k = np.arange(1, SERIES_TERMS + 1)
        series = x**3 * _polynomial(4 * k / (4.0 * k**2 - 1.0), x**2)
        closed = (1.0 + x**2) * np.arctanh(x) - x
        return np.asarray(radius**2 * np.where(x < SERIES_LIMIT, series, closed))

    def _moment(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        x = a / radius
        k = np.arange(1, SERIES_TERMS + 1)
        series = 4.0 * x**5 * _polynomial(2 * k / ((2 * k - 1.0) * (2 * k + 3.0)), x**2)
        closed = (x**4 + 3.0) * np.arctanh(x) - x**3 - 3.0 * x
        return np.asarray(radius**4 * np.where(x < SERIES_LIMIT, series, closed) / 3.0)

    def _closed_radius(self, depth: FloatArray, radius: FloatArray, curvature: FloatArray) -> FloatArray:
        # with a = R tanh t, d/R = t tanh t + k R tanh^2 t: quadratic in t for small t, and linear for large t
        ratio, bend = depth / radius, curvature * radius

        def parts(t: FloatArray) -> tuple[FloatArray, FloatArray]:
            x = np.tanh(t)
            return t * x + bend * x**2, t * (x + (t + 2.0 * bend * x) * (1.0 - x**2))

        # the start solves t^2/(1 + t) = d/R; it exceeds the root for k = 0, because t tanh t >= t^2/(1 + t)
        t = root(parts, ratio, 0.5 * (ratio + np.sqrt(ratio * (ratio + 4.0))))
        return np.asarray(np.minimum(radius * np.tanh(t), np.nextafter(radius, 0.0)))


def _polynomial(coefficient: FloatArray, x: FloatArray) -> FloatArray:
    """Return the sum of coefficient[k] x^k over k."""
    total = np.zeros_like(x)
    for c in coefficient[::-1]:
        total = total * x + c
    return total


def root(
    parts: Callable[[FloatArray], tuple[FloatArray, FloatArray]], target: FloatArray, start: FloatArray
) -> FloatArray:
    """Return the x > 0 at which the first value of parts(x) equals the target.

    The second value of parts(x) is the derivative of the first with respect to ln x. Newton's method uses the
    logarithms of x and of the value, in which power laws are straight lines. A step changes x by at most a
    factor of 10. The search ends when x changes by rounding only.
    """
    x = start
    for _ in range(MAX_STEPS):
        value, slope = parts(x)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(value > 0.0, np.log(value / target) * value / slope, -1.0)
        new = x * np.exp(-np.clip(np.where(slope > 0.0, step, -1.0), -2.3, 2.3))
        if (np.abs(new - x) <= 2.0 * np.finfo(np.float64).eps * x).all():
            return np.asarray(new)
        x = new
    return np.asarray(x)


def power_logarithms(
    exponent: FloatArray, coefficient: float, radius: float
) -> tuple[FloatArray, FloatArray]:
    """Return ln b of the contact radii ``a = b d^(1/n)`` of power caps, and its derivative with respect to n.

    With K as in `PowerCap`, ``b = R (c K R)^(-1/n)``.
    """
    n = exponent
    depth = math.log(coefficient * radius * math.sqrt(math.pi)) + gammaln(0.5 * n + 1.0)
    depth -= gammaln(0.5 * (n + 1.0))  # ln(c K R)
    turn = 0.5 * (digamma(0.5 * n + 1.0) - digamma(0.5 * (n + 1.0)))  # K'/K
    return math.log(radius) - depth / n, (depth / n - turn) / n
