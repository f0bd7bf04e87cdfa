"""Elastic contact of a cap with any profile, from a function or a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.caps import Profile
from metafem.contact.caps import ElasticCap, root
from metafem.contact.law import Values
from metafem.errors import InvalidInput, refuse_if

# Degree of the polynomial that represents the integral of D in each panel of contact radii, panels per octave
# (a factor of 2 in the contact radius), and octaves. The relative error is 12^-15 for a power-law profile,
# and 5e-14 for a sphere up to a/R = 0.7. With more panels or a higher degree, the derivatives lose more
# digits.
DEGREE, PER_OCTAVE, OCTAVES = 14, 2, 40

# Number of nodes of the quadrature over a profile. The variable of integration is the cube root of the angle,
# in which fractional powers at the summit are smooth.
NODES = 96

# A profile is smooth if the last two polynomial coefficients, relative to the first, are below this bound.
SMOOTH = 1e-10

# Relative excess over the largest indentation that is treated as rounding.
ROUNDING = 1e-12


class Panels(NamedTuple):
    """Piecewise polynomials for F(a) = int_0^a D ds, its derivatives and the integral of s F."""

    edge: FloatArray  # (m + 1,) [mm]
    value: FloatArray  # (DEGREE + 1, m), Chebyshev coefficients of F [mm^2]
    slope: FloatArray  # (DEGREE + 1, m), coefficients of D [mm]
    bend: FloatArray  # (DEGREE + 1, m), coefficients of D' [-]
    moment: FloatArray  # (DEGREE + 3, m), coefficients of int_0^a s F ds [mm^4]
    depth: FloatArray  # (m + 1,), D at the edges [mm]
    power: float  # exponent of a in F below the first panel


@dataclass(frozen=True, eq=False, repr=False)
class AxisymmetricCap(Value, ElasticCap):
    """Frictionless, non-adhesive elastic contact of a cap with any profile and a rigid plane.

    With ``F(a) = int_0^a f(sqrt(a^2 - w^2)) dw`` and D = F', ``d = D(a)``, ``A = pi a^2``,
    ``P/E* = 2 (a D - F)``, and the second moment of the pressure over E* is
    ``4/3 (a^3 D - 3 a^2 F + 6 int_0^a s F ds)``. An extra curvature adds the terms of a paraboloid. F is
    computed once by quadrature and then interpolated. If the profile is a function, the relative errors of d
    and P are below 1e-12. Between the points of a table, f is a monotone cubic in rho^2: 30 points of a
    sphere up to a/R = 0.66 give d within 6e-5, and 100 points within 3e-6. Lengths are in mm, P/E* in mm^2.
    The law assumes small strain: the profile must be flat, f' << 1. All asperities have the same profile,
    whatever their R. Popov and Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction
    (2015), doi:10.1007/978-3-642-53876-6.

    Parameters
    ----------
    profile : callable or array_like, (2, m)
        Depth f [mm] below the summit at the distance rho [mm] from the axis: a smooth, vectorised function,
        or a table with the rows rho and f that begins with (0, 0). f must increase with rho.
    extent : float, optional
        Largest rho at which the profile is used [mm], which is also the largest contact radius. It is
        required for a function; default for a table: the last rho.

    Raises
    ------
    InvalidInput
        If the profile does not increase or is not smooth, or an indentation exceeds that at the extent.

    Examples
    --------
    >>> cap = AxisymmetricCap(lambda rho: rho**4 / (2 * 0.526**3), extent=0.3)
    >>> a = cap.contact_radius(0.001, 0.526)
    >>> a.round(6), cap.load(a, 0.526).round(9)
    (np.float64(0.102213), np.float64(0.00016354))
    """

    similar: ClassVar[bool] = False

    profile: Callable | FloatArray  # type: ignore[type-arg]
    extent: float | None = None

    def __post_init__(self) -> None:
        cap = self._cap  # checks the profile, and completes the extent
        object.__setattr__(self, "profile", cap.profile)
        object.__setattr__(self, "extent", cap.extent)
        found = self._panels
        refuse_if(
            not (np.diff(found.depth) > 0.0).all(),
            "profile: the contact radius does not grow with the indentation",
        )

    def __repr__(self) -> str:
        """Return the call of the constructor, with the function's name or the number of points of a table."""
        return repr(self._cap).replace("Profile", type(self).__name__, 1)

    @cached_property
    def _cap(self) -> Profile:
        """Shape of the caps."""
        return Profile(self.profile, self.extent)

    def depth_at(self, distance: Values, radius: Values) -> FloatArray:
        """Return the depth f [mm] of the cap below its summit at a distance from the axis, for any radius.

        Beyond the extent the profile continues along its tangent.
        """
        found = self._cap.unit_profile(np.asarray(distance))
        return np.asarray(np.broadcast_to(found, np.broadcast_shapes(found.shape, np.shape(radius))))[()]

    @cached_property
    def _panels(self) -> Panels:
        """Interpolated integral of D, computed at first use."""
        if callable(self.profile):
            edge = np.float64(self.extent) * 2.0 ** (-np.arange(PER_OCTAVE * OCTAVES, -1, -1) / PER_OCTAVE)
        else:
            rho = self.profile[0, 1:]
            edge = np.concatenate([rho[0] * 2.0 ** -np.arange(OCTAVES, 0.0, -1.0), rho])
        half, middle = 0.5 * np.diff(edge), 0.5 * (edge[1:] + edge[:-1])
        x = np.cos(np.pi * np.arange(DEGREE, -1, -1) / DEGREE)
        vandermonde = chebyshev.chebvander(x, DEGREE)
        given = self._integral(middle + half * x[:, None])
        value: FloatArray = np.asarray(np.linalg.solve(vandermonde, given), dtype=np.float64)
        refuse_if(
            callable(self.profile) and (np.abs(value[-2:]) > SMOOTH * value[0]).any(),
            "profile: the function is not smooth up to the extent; use a smaller one, or give it as a "
            "table (rho, f)",
        )
        slope: FloatArray = np.asarray(chebyshev.chebder(value) / half)
        bend: FloatArray = np.asarray(chebyshev.chebder(slope) / half)
        product = np.zeros((DEGREE + 2, len(half)))  # s F = middle F + half x F
        product[:-1] = middle * value
        product[1] += half * value[0]
        product[2:] += 0.5 * half * value[1:]
        product[:-2] += 0.5 * half * value[1:]
        moment: FloatArray = np.multiply(chebyshev.chebint(product, lbnd=-1.0), half)
        first, first_depth = (float(chebyshev.chebval(-1.0, part[:, 0])) for part in (value, slope))
        power = float(edge[0] * first_depth / first)
        steps = np.concatenate([[first * edge[0] ** 2 / (power + 2.0)], moment.sum(axis=0)[:-1]])
        moment[0] += np.cumsum(steps)  # Chebyshev polynomials are 1 at the upper edge of a panel
        depth = np.concatenate([[first_depth], slope.sum(axis=0)])
        return Panels(edge, value, slope, bend, moment, depth, power)

    def _integral(self, a: FloatArray) -> FloatArray:
        """Return F(a) [mm^2] at an array of contact radii [mm], by quadrature."""
        if callable(self.profile):
            node, weight = np.polynomial.legendre.leggauss(NODES)
            node, weight = 0.5 * (node + 1.0), 0.5 * weight
            sine = np.sin(0.5 * np.pi * node**3)
            depth = np.asarray(self.profile(a[..., None] * sine), dtype=np.float64)
            if (
                depth.shape != (*a.shape, NODES)
                or not np.isfinite(depth).all()
                or not (np.diff(depth) > 0.0).all()
            ):
                raise InvalidInput(
                    "profile: the function must return increasing, finite numbers for arrays of rho"
                )
            return np.asarray(a * (depth @ (1.5 * np.pi * node**2 * weight * sine)))
        square = self.profile[0] ** 2
        # between the points of the table, f is a polynomial of degree 6 in w: 4 Gauss nodes are exact
        node, weight = np.polynomial.legendre.leggauss(4)
        w = np.sqrt(np.maximum(a[..., None] ** 2 - square, 0.0))
        half, middle = 0.5 * (w[..., :-1] - w[..., 1:]), 0.5 * (w[..., :-1] + w[..., 1:])
        inside = middle[..., None] + half[..., None] * node
        depth = self._cap.cubic(np.maximum(a[..., None, None] ** 2 - inside**2, 0.0))
        return np.asarray(((depth @ weight) * half).sum(axis=-1))

    def breaks(self, radius: float) -> FloatArray:
        """Return the contact radii [mm] between which the law is smooth: rho at the points of a table."""
        return np.empty(0) if callable(self.profile) else self.profile[0, 1:]

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Return the indentation [mm] at which the contact reaches the extent of the profile."""
        return np.full(np.shape(radius), self._panels.depth[-1])[()]

    def _at(self, name: str, a: FloatArray) -> FloatArray:
        """Return the function `name` of the panels at contact radii [mm]."""
        found, size = self._panels, np.asarray(a, dtype=np.float64)
        if (size > found.edge[-1] * (1.0 + ROUNDING)).any():
            raise InvalidInput(
                f"contact_radius = {size.max():.4g} mm exceeds {found.edge[-1]:.4g} mm, the extent"
            )
        size = np.minimum(size, found.edge[-1])
        panel = np.clip(np.searchsorted(found.edge, size, side="right") - 1, 0, len(found.edge) - 2)
        low, high = found.edge[panel], found.edge[panel + 1]
        inside = np.maximum(size, found.edge[0])
        value = chebyshev.chebval(
            (2.0 * inside - low - high) / (high - low), getattr(found, name)[:, panel], tensor=False
        )
        # below the first panel all functions are powers of a
        order = {"value": 0.0, "slope": -1.0, "bend": -2.0, "moment": 2.0}[name]
        with np.errstate(divide="ignore"):
            return np.asarray(value * (size / inside) ** (found.power + order))

    def _depth(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return self._at("slope", a)

    def _slope(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return self._at("bend", a)

    def _load(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        return np.asarray(2.0 * (a * self._at("slope", a) - self._at("value", a)))

    def _moment(self, a: FloatArray, radius: FloatArray) -> FloatArray:
        parts = a**3 * self._at("slope", a) - 3.0 * a**2 * self._at("value", a) + 6.0 * self._at("moment", a)
        return np.asarray(4.0 / 3.0 * parts)

    def _closed_radius(self, depth: FloatArray, radius: FloatArray, curvature: FloatArray) -> FloatArray:
        found, extent = self._panels, self._panels.edge[-1]
        largest = found.depth[-1] + curvature * extent**2
        deep = depth > largest * (1.0 + ROUNDING)
        if deep.any():
            raise InvalidInput(
                f"indentation = {depth[deep].max():.4g} mm exceeds {largest[deep].min():.4g} mm, where the "
                f"contact reaches the extent of the profile, {extent:g} mm; give a wider profile"
            )

        def parts(a: FloatArray) -> tuple[FloatArray, FloatArray]:
            inside = np.minimum(a, extent)
            extra = curvature * inside**2
            return self._depth(inside, radius) + extra, inside * self._slope(inside, radius) + 2.0 * extra

        start = np.exp(np.interp(np.log(depth), np.log(found.depth), np.log(found.edge)))
        return np.asarray(np.minimum(root(parts, depth, start), extent))
