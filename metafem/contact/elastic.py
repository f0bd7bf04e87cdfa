"""Elastic contact of caps and a rigid plane without adhesion: Hertz's law, and caps by their own profiles."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.caps import Cap, Caps, Paraboloid, Power
from metafem.caps.shapes import Values
from metafem.contact.law import ROUNDING, SUMMIT, Contact, root
from metafem.errors import InvalidInput

if TYPE_CHECKING:
    from metafem.surface import Surface


class CapContact(Contact):
    """Frictionless, non-adhesive elastic contact of caps, from their integrals D, P and M.

    See `metafem.caps.Cap`: ``d = D(a)``, ``A = pi a^2``, ``P/E* = P(a)``, ``dP/dd = 2 a E*``, and the second
    moment of the pressure is ``M(a)``. `metafem._kernels.law` states what the neighbours change.
    """

    largest_order: ClassVar[int] = 3
    cap: Any  # of all asperities

    @property
    def similar(self) -> bool:  # type: ignore[override]
        """Whether the law is the same for all R when all lengths are divided by R."""
        return self.cap is not None and self.cap.scaled

    @property
    def power(self) -> float | None:
        """Exponent n of the profile of all caps; None if it is no power."""
        return getattr(self.cap, "exponent", None)

    def depth_at(self, distance: Values, radius: Any) -> FloatArray:
        """Return the depth f [mm] of the cap below its summit at a distance rho from the axis."""
        return self._each(lambda cap, scale, rho: cap.depth_at(rho, scale), radius, distance)

    def contact_radius(self, indentation: Values, radius: Any) -> FloatArray:
        """Return the contact radius a [mm], the root of D(a) = d; 0 where the contact is open."""
        return self._each(_contact_radius, radius, indentation)

    def indentation(self, contact_radius: Values, radius: Any) -> FloatArray:
        """Return the indentation d [mm]."""
        a = np.asarray(contact_radius, dtype=np.float64)
        return np.asarray(self._depth(a, radius)[0])[()]

    def load(self, contact_radius: Values, radius: Any) -> FloatArray:
        """Return the rescaled load P/E* [mm^2]."""
        a = np.asarray(contact_radius, dtype=np.float64)
        return np.asarray(self._sums(a, radius)[0])[()]

    def second_moment(self, contact_radius: Values, radius: Any) -> FloatArray:
        """Return the second moment of the pressure over E* [mm^4]."""
        a = np.asarray(contact_radius, dtype=np.float64)
        return np.asarray(self._sums(a, radius)[1])[()]

    def stiffness(self, contact_radius: Values, radius: Any) -> FloatArray:
        """Return d(P/E*)/dd = 2 a [mm]."""
        return np.multiply(2.0, contact_radius)

    def area_slope(self, contact_radius: Values, radius: Any) -> FloatArray:
        """Return dA/dd = 2 pi a/D' [mm]; 0 for an open contact."""
        a = np.asarray(contact_radius, dtype=np.float64)
        slope = np.where(a > 0.0, self._depth(a, radius)[1], 1.0)
        return np.asarray(2.0 * math.pi * a / slope)[()]

    def _depth(self, a: FloatArray, radius: Any) -> tuple[FloatArray, FloatArray]:
        def of(cap: Cap, scale: FloatArray, a: FloatArray) -> FloatArray:
            depth, slope = cap.unit_depth(_unit(cap, a, scale))
            return np.stack([scale * depth, slope])

        return tuple(self._each(of, radius, a, shape=(2,)))

    def _sums(self, a: FloatArray, radius: Any) -> tuple[FloatArray, FloatArray]:
        def of(cap: Cap, scale: FloatArray, a: FloatArray) -> FloatArray:
            load, moment = cap.unit_load(_unit(cap, a, scale))
            return np.stack([scale**2 * load, scale**4 * moment])

        return tuple(self._each(of, radius, a, shape=(2,)))

    def _each(
        self, function: Callable[..., FloatArray], radius: Any, *values: Values, shape: tuple[int, ...] = ()
    ) -> FloatArray:
        """Return a function of each cap, its scale [mm] and values, in the common shape of all arguments."""
        if self.cap is None:
            raise InvalidInput("Elastic() has no caps yet: use it in a model, or call bound(surface)")
        summit, *given = np.broadcast_arrays(radius, *values)
        if not isinstance(self.cap, Caps):
            size = self.cap.scale(np.asarray(summit, dtype=np.float64))
            return np.asarray(function(self.cap, size, *given))[()]
        found = np.zeros((*shape, *summit.shape))
        for k, cap in enumerate(self.cap.kinds):
            own = summit["cap"] == k
            some = (value[own] for value in given)
            found[..., own] = function(cap, cap.scale(summit["radius"][own]), *some)
        return found[()]


@dataclass(frozen=True)
class Hertz(CapContact):
    """Frictionless, non-adhesive elastic contact of a paraboloid of radius R and a rigid plane.

    With the contact radius a: ``d = a^2/R``, ``A = pi a^2``, ``P/E* = 4/3 a d``, ``dP/dd = 2 a E*``, and the
    second moment of the pressure is ``2/5 P a^2``. Lengths are in mm, P/E* in mm^2. The law is valid for
    a << R; with a fitted modulus its error is a few percent up to a/R = 0.5. Hertz, J. reine angew. Math. 92,
    156 (1882), doi:10.1515/crll.1882.92.156.

    Examples
    --------
    >>> d, R = np.array([-0.01, 0.0, 0.04]), np.array([0.5, 0.5, 1.0])
    >>> a = Hertz().contact_radius(d, R)
    >>> a, Hertz().load(a, R).round(6)
    (array([0. , 0. , 0.2]), array([0.      , 0.      , 0.010667]))
    """

    cap = Paraboloid()

    def contact_radius(self, indentation: Values, radius: Values) -> FloatArray:
        """Return the contact radius a = sqrt(R d) [mm]; 0 where the contact is open."""
        return np.sqrt(np.multiply(radius, np.maximum(indentation, 0.0)))

    def _depth(self, a: FloatArray, radius: Any) -> tuple[FloatArray, FloatArray]:
        return a**2 / radius, 2.0 * a / radius  # several times faster than from the cap, which JKR needs

    def _sums(self, a: FloatArray, radius: Any) -> tuple[FloatArray, FloatArray]:
        load = 4.0 / 3.0 * a * a**2 / radius  # a**3 is slow
        return load, 0.4 * a**2 * load

    def indentation_at_load(self, load: Values, radius: Values) -> FloatArray:
        """Return the indentation d = (3/4 P/E* / sqrt(R))^(2/3) [mm] of a contact without neighbours."""
        return np.asarray((0.75 * np.asarray(load) / np.sqrt(radius)) ** (2.0 / 3.0))


# Default contact law of all models.
PARABOLOID = Hertz()


@dataclass(frozen=True, repr=False)
class Elastic(CapContact):
    """Frictionless, non-adhesive elastic contact of each cap by its own profile.

    With the integrals D, P and M of the cap (`metafem.caps.Cap`), ``d = D(a)``, ``A = pi a^2``,
    ``P/E* = P(a)``, ``dP/dd = 2 a E*``, and the second moment of the pressure is ``M(a)``. Spheres,
    paraboloids and power laws have closed forms; other profiles are integrated once. The caps of a surface
    may differ. The law assumes small strain, f' << 1: at a/R = 0.5 the load of a sphere exceeds that of a
    soft sphere by about 10 %, and Hertz's law with a fitted modulus is more accurate. Popov and Hess, Method
    of Dimensionality Reduction in Contact Mechanics and Friction (2015), doi:10.1007/978-3-642-53876-6.

    Parameters
    ----------
    cap : Cap, optional
        Cap of all asperities; default: the caps of the surface.

    Examples
    --------
    >>> import metafem as mf
    >>> caps = [mf.Power(4), mf.Sphere()]
    >>> surface = mf.Surface([[0, 0], [2, 0]], [0.1, 0.1], 0.526, mf.Material(1.36), cap=caps)
    >>> mf.equilibrium(surface, mf.Independent(mf.Elastic()), approach=0.001).asperity_area.round(5)
    array([0.03282, 0.00165])
    """

    cap: Cap | None = None

    def __post_init__(self) -> None:
        check.instance("cap", self.cap, Cap, "a cap such as metafem.Sphere()", optional=True)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({'' if self.cap is None else repr(self.cap)})"

    def bound(self, surface: Surface) -> Contact:
        """Return the law of the caps of a surface: Hertz's law for paraboloids."""
        cap = surface.cap if self.cap is None else self.cap
        return PARABOLOID if cap in (Paraboloid(), Power(2.0)) else replace(self, cap=cap)

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return R of all asperities [mm], or records of R and the index of the cap if the caps differ."""
        sizes, cap = surface.radius if radius is None else radius, self.cap or surface.cap
        if not isinstance(cap, Caps):
            return sizes
        found = np.empty(np.shape(sizes), SUMMIT)
        found["radius"], found["cap"] = sizes, cap.index
        return found

    def largest_indentation(self, radius: Any) -> FloatArray:
        """Return the indentation [mm] at which the contact reaches the end of its cap; else infinity."""
        return self._each(
            lambda cap, scale: scale * (math.inf if math.isinf(cap.reach) else _most(cap)), radius
        )


def _most(cap: Cap) -> float:
    """Return the unit indentation at which a contact reaches the end of its cap."""
    return float(cap.unit_depth(np.array(cap.reach))[0])


def _unit(cap: Cap, a: FloatArray, scale: FloatArray) -> FloatArray:
    """Return unit contact radii; raise InvalidInput beyond the end of the cap."""
    x = np.asarray(a / scale)
    if (x > cap.reach * (1.0 + ROUNDING)).any():
        raise InvalidInput(
            f"contact_radius = {np.max(a):.4g} mm exceeds {np.max(cap.reach * scale):.4g} mm, where contacts "
            f"of {cap!r} end"
        )
    return np.minimum(x, cap.reach)


def _contact_radius(cap: Cap, scale: FloatArray, d: FloatArray) -> FloatArray:
    """Return the contact radii [mm] of one cap with the scales and indentations."""
    found, closed = np.zeros(d.shape), d > 0.0
    depth = d[closed] / scale[closed]
    if math.isfinite(cap.reach):
        most = _most(cap)
        deep = depth > most * (1.0 + ROUNDING)
        if deep.any():
            lengths = scale[closed][deep]
            raise InvalidInput(
                f"indentation = {(depth[deep] * lengths).max():.4g} mm exceeds "
                f"{(most * lengths).min():.4g} mm, where the contact reaches the end of {cap!r}, "
                f"{(cap.reach * lengths).min():.4g} mm from the axis; use lighter loads or a wider profile"
            )
        depth = np.minimum(depth, most)

    def parts(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        inside = np.minimum(x, cap.reach)
        own, slope = cap.unit_depth(inside)
        return own, inside * slope

    size = min(1.0, cap.reach)  # from the root of a power law through this contact radius
    share = depth / float(cap.unit_depth(np.array(size))[0])
    start = np.minimum(size * share ** (1.0 / getattr(cap, "exponent", 2.0)), cap.reach)
    found[closed] = scale[closed] * np.minimum(root(parts, depth, start), cap.reach)
    return found


def usual_law(surface: Surface) -> Contact:
    """Return Hertz's law if all summits have a finite curvature; otherwise, the law of the caps' profiles."""
    try:
        surface.cap.summit_radius(surface.radius)
    except InvalidInput:
        return Elastic()
    return PARABOLOID
