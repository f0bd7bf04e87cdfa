"""Caps with any increasing profile, from a function or a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import scipy

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.caps.shapes import NO_CURVATURE, Cap
from metafem.errors import InvalidInput, refuse_if, shown

if TYPE_CHECKING:
    from scipy.interpolate import BSpline, PchipInterpolator


@dataclass(frozen=True, eq=False, repr=False)
class Profile(Value, Cap):
    """Caps with any profile f(rho); all asperities have the same profile, whatever their R.

    Between the points of a table, f is a monotone cubic in rho^2: 30 points of a sphere up to a/R = 0.66 give
    the indentation of a contact within 6e-5, and 100 points within 3e-6. With
    ``F(a) = int_0^a f(sqrt(a^2 - w^2)) dw`` and ``G(a) = int_0^a w^2 f(sqrt(a^2 - w^2)) dw``, ``D = F'``,
    ``P/E* = 2 (a D - F)`` and ``M/E* = 4/3 (a^3 D - 3 a^2 F + 6 G)``. F and G are computed once by
    quadrature; their logarithms are splines of ln a.

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
        If the profile does not increase, as that of a hollow cap, or a function has no extent.

    Examples
    --------
    >>> cap = Profile([[0.0, 0.1, 0.2, 0.3], [0.0, 0.01, 0.04, 0.09]])
    >>> cap.foot_radius(np.array([0.04]), np.array([0.5])), cap.summit_radius(np.array([0.5])).round(3)
    (array([0.2]), array([0.5]))
    """

    scaled: ClassVar[bool] = False

    profile: Callable | FloatArray  # type: ignore[type-arg]
    extent: float | None = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if callable(self.profile):
            refuse_if(
                self.extent is None, "extent must be given with a function: the largest contact radius [mm]"
            )
            check.member(self, "extent", above=0.0)
            return
        table = check.array("profile", self.profile, shape=(2, None))
        for name, row in zip(("rho", "f"), table, strict=True):
            if len(row) < 3 or row[0] != 0.0 or not (np.diff(row) > 0.0).all():
                words = "must begin with 0 and increase over at least 3 points"
                raise InvalidInput(words, key=name, value=shown(row.tolist(), 80))
        refuse_if(
            self.extent is not None and self.extent != table[0, -1],
            f"extent = {self.extent} must be the last rho of the table, {table[0, -1]:g}",
        )
        object.__setattr__(self, "profile", table)
        object.__setattr__(self, "extent", float(table[0, -1]))

    def __repr__(self) -> str:
        """Return the call of the constructor, with the function's name or the number of points of a table."""
        if callable(self.profile):
            shape = getattr(self.profile, "__name__", type(self.profile).__name__)
        else:
            shape = f"<{self.profile.shape[1]} points>"
        return f"Profile({shape}, extent={self.extent:g})"

    @property
    def reach(self) -> float:
        """Largest contact radius [mm]: the extent."""
        return float(self.extent)  # type: ignore[arg-type]

    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth [mm] at distances up to the extent."""
        if callable(self.profile):
            return np.asarray(self.profile(rho), dtype=np.float64)
        return np.asarray(self.cubic(np.square(rho)))

    @cached_property
    def cubic(self) -> PchipInterpolator:
        """Monotone cubic of rho^2 through the points of a table."""
        rho, depth = np.asarray(self.profile)
        return scipy.interpolate.PchipInterpolator(rho**2, depth, extrapolate=True)

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return 1/f''(0) [mm]; raise InvalidInput if f'' has no finite, positive limit at the summit."""
        rho = np.array([2e-3, 1e-3]) * self.reach  # near enough to the axis for 0.1 %, far enough for digits
        far, near = 2.0 * self.unit_profile(rho) / rho**2
        if not callable(self.profile):
            near = far = 2.0 * float(self.cubic(0.0, 1))
        if not (near > 0.0 and abs(far / near - 1.0) < 1e-3):
            raise InvalidInput(NO_CURVATURE, key="cap", value=repr(self))
        return np.full_like(radius, 1.0 / near)

    def unit_foot(self, height: FloatArray) -> FloatArray:
        """Return the distances [mm] at which the depth is the height, to rounding."""
        most = float(self.unit_profile(np.array(self.reach)))
        refuse_if(
            (height > most).any(),
            f"cap.profile: the profile ends {most:.4g} mm below the summit, at its extent of "
            f"{self.extent:g} mm; a cap of the height {height.max():.4g} mm needs a wider profile",
        )
        ends = np.zeros_like(height), np.full_like(height, self.reach)
        # loaded by no surface whose caps have a closed form
        found = scipy.optimize.elementwise.find_root(
            lambda x, h: self.unit_profile(x) - h, ends, args=(height,)
        )
        return np.asarray(found.x)

    @cached_property
    def integrals(self) -> tuple[BSpline, BSpline]:
        """Splines of ln F and ln G over ln a."""
        # 64 radii in each of 30 factors of 2 below the extent, to its last bit. The spacing falls to a tenth
        # in the last quarter, where splines are less accurate. D is within 1e-11 up to a/R = 0.9 of spheres.
        octave = np.arange(-64 * 30, 1) / 64
        a = self.reach * 2.0 ** (octave * octave / (octave - 0.25))
        x, (rho, w, weight) = np.log(a), self._nodes(a[:, None])
        depth = self.unit_profile(rho)
        if callable(self.profile):
            good = depth.shape == rho.shape and np.isfinite(depth).all() and (np.diff(depth) > 0.0).all()
            words = "profile: the function must return increasing, finite numbers for arrays of rho"
            refuse_if(not good, words)
        y = np.log([(weight * depth).sum(axis=1), (weight * w**2 * depth).sum(axis=1)])
        first, second = (scipy.interpolate.make_interp_spline(x, part, k=5) for part in y)
        coarse = scipy.interpolate.make_interp_spline(x[::2], y[0, ::2], k=5)
        refuse_if(
            # a smooth function differs by less from the spline through every other radius
            callable(self.profile) and (np.abs(coarse(x) - y[0]) > 1e-9).any(),
            "profile: the function is not smooth up to the extent; use a smaller one, or give it as a table "
            "(rho, f)",
        )
        power = first(x, 1)
        refuse_if(
            not (first(x, 2) + power**2 - power > 0.0).all(),
            "profile: the contact radius does not grow with the indentation",
        )
        return first, second

    def _nodes(self, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return rho, w and weights (m, nodes) of the quadrature over w at contact radii (m, 1) [mm]."""
        if callable(self.profile):
            # fractional powers at the summit are smooth in the cube root of the angle
            node, weight = np.polynomial.legendre.leggauss(96)
            cube = 0.5 * (node + 1.0)
            angle = 0.5 * np.pi * cube**3
            return a * np.sin(angle), a * np.cos(angle), a * np.sin(angle) * 0.75 * np.pi * cube**2 * weight
        # between the points of the table, w^2 f is a polynomial of degree 8 in w: 5 Gauss nodes are exact
        node, weight = np.polynomial.legendre.leggauss(5)
        ends = np.sqrt(np.maximum(a**2 - self.profile[0] ** 2, 0.0))
        half = 0.5 * (ends[:, :-1] - ends[:, 1:])[..., None]
        w = (ends[:, 1:, None] + half * (node + 1.0)).reshape(len(a), -1)
        return np.sqrt(np.maximum(a**2 - w**2, 0.0)), w, (half * weight).reshape(len(a), -1)

    def _at(self, a: FloatArray) -> tuple[FloatArray, ...]:
        """Return a [mm], F [mm^2], d ln F/d ln a, d^2 ln F/(d ln a)^2 and G [mm^4] at contact radii [mm].

        Below the smallest contact radius of the splines, F and G are powers.
        """
        first, second = self.integrals
        a = np.maximum(a, 1e-200 * self.reach)  # 0 has no logarithm
        x = np.log(a)
        inside = np.clip(x, first.t[0], first.t[-1])
        power, below = first(inside, 1), x - inside
        value, other = first(inside) + power * below, second(inside) + second(inside, 1) * below
        return a, np.exp(value), power, first(inside, 2), np.exp(other)

    def unit_depth(self, a: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return D [mm] and D' [-] at contact radii [mm]."""
        a, value, power, bend, _ = self._at(a)
        depth = value * power / a
        return depth, depth / a * (bend / power + power - 1.0)

    def unit_load(self, a: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return P/E* [mm^2] and M/E* [mm^4] at contact radii [mm]."""
        a, value, power, _, other = self._at(a)
        return 2.0 * value * (power - 1.0), 4.0 / 3.0 * (a**2 * value * (power - 3.0) + 6.0 * other)
