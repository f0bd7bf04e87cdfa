"""Elastic contact of caps by their own profiles, which may differ from asperity to asperity."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

import numpy as np

from metafem._validate import FloatArray
from metafem.caps import Cap, Caps, Paraboloid, Power, Profile, Sphere
from metafem.contact.caps import PowerCap, SphericalCap
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import SUMMIT, Contact, Values
from metafem.contact.profile import AxisymmetricCap
from metafem.errors import InvalidInput

if TYPE_CHECKING:
    from metafem.surface import Surface

# Number of cached laws; that of a profile takes milliseconds to compute and 40 kB.
KEPT = 64

# Contact law of each kind of cap.
LAWS: dict[type[Cap], Callable[[Any], Contact]] = {
    Sphere: lambda cap: SphericalCap(),
    Paraboloid: lambda cap: PARABOLOID,
    Power: lambda cap: PARABOLOID if cap == Power(2.0) else PowerCap(cap.exponent, cap.coefficient),
    Profile: lambda cap: AxisymmetricCap(cap.profile, cap.extent),
}


@dataclass(frozen=True)
class Elastic(Contact):
    """Frictionless, non-adhesive elastic contact of each cap by its own profile.

    With the profile f(rho) of the cap and ``D(s) = s int_0^s f'(rho)/sqrt(s^2 - rho^2) drho``, the
    indentation at the contact radius a is ``d = D(a)``, the area ``pi a^2``, and ``P/E* = 2 int_0^a s D'
    ds``. Spheres, paraboloids and power laws have closed forms, see `metafem.contact.caps`. The caps of a
    surface may differ. The law assumes small strain, f' << 1. Popov and Hess, Method of Dimensionality
    Reduction in Contact Mechanics and Friction (2015), doi:10.1007/978-3-642-53876-6.

    Examples
    --------
    >>> import metafem as mf
    >>> caps = [mf.Power(4), mf.Sphere()]
    >>> surface = mf.Surface([[0, 0], [2, 0]], [0.1, 0.1], 0.526, mf.Material(1.36), cap=caps)
    >>> mf.equilibrium(surface, mf.Independent(mf.Elastic()), approach=0.001).asperity_area.round(5)
    array([0.03282, 0.00165])
    """

    largest_order: ClassVar[int] = 3

    def bound(self, surface: Surface) -> Contact:
        """Return the law of the caps of a surface."""
        if isinstance(surface.cap, Caps):
            return MixedCaps(tuple(map(law_of, surface.cap.kinds)))
        return law_of(surface.cap)

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return R of all asperities [mm], or records of R and the index of the cap if the caps differ."""
        sizes = surface.radius if radius is None else radius
        if not isinstance(surface.cap, Caps):
            return sizes
        found = np.empty(np.shape(sizes), SUMMIT)
        found["radius"], found["cap"] = sizes, surface.cap.index
        return found

    def _without_caps(self, *arguments: Any) -> NoReturn:
        """Raise InvalidInput: the law needs the caps of a surface."""
        raise InvalidInput("Elastic() has no caps yet: use it in a model, or call bound(surface)")

    contact_radius = indentation = load = second_moment = _without_caps  # type: ignore[assignment]
    stiffness = area_slope = largest_indentation = depth_at = _without_caps  # type: ignore[assignment]


@lru_cache(maxsize=KEPT)
def law_of(cap: Cap) -> Contact:
    """Return the elastic law of one kind of cap; that of a profile is computed by quadrature and cached."""
    return LAWS[type(cap)](cap)


def usual_law(surface: Surface) -> Contact:
    """Return Hertz's law if all summits have a finite curvature; otherwise, the law of the caps' profiles."""
    try:
        surface.cap.summit_radius(surface.radius)
    except InvalidInput:
        return Elastic()
    return PARABOLOID


@dataclass(frozen=True)
class MixedCaps(Contact):
    """Elastic law of caps that differ: in all methods, `radius` is an array of `SUMMIT` records."""

    largest_order: ClassVar[int] = 3

    laws: tuple[Any, ...]

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return records of R and the index of the cap, (..., n)."""
        return Elastic().summits(surface, radius)

    def depth_at(self, distance: Values, radius: Any) -> FloatArray:
        """Return the depths f [mm] of the caps below their summits at distances from the axis."""
        return self._each(lambda law, rho, size, _: law.depth_at(rho, size), distance, radius)

    def largest_indentation(self, radius: Any) -> FloatArray:
        """Return the largest indentations [mm] for which the laws are valid."""
        return self._each(lambda law, _, size, __: law.largest_indentation(size), 0.0, radius)

    def contact_radius(self, indentation: Values, radius: Any, curvature: Values = 0.0) -> FloatArray:
        """Return the contact radii a [mm]; 0 for open contacts."""
        return self._each(lambda law, *given: law.contact_radius(*given), indentation, radius, curvature)

    def indentation(self, contact_radius: Values, radius: Any, curvature: Values = 0.0) -> FloatArray:
        """Return the indentations d [mm]."""
        return self._each(lambda law, *given: law.indentation(*given), contact_radius, radius, curvature)

    def load(self, contact_radius: Values, radius: Any, curvature: Values = 0.0) -> FloatArray:
        """Return the rescaled loads P/E* [mm^2]."""
        return self._each(lambda law, *given: law.load(*given), contact_radius, radius, curvature)

    def second_moment(self, contact_radius: Values, radius: Any, curvature: Values = 0.0) -> FloatArray:
        """Return the second moments of the pressure over E* [mm^4]."""
        return self._each(lambda law, *given: law.second_moment(*given), contact_radius, radius, curvature)

    def stiffness(self, contact_radius: Values, radius: Any, curvature: Values = 0.0) -> FloatArray:
        """Return d(P/E*)/dd [mm]."""
        return self._each(lambda law, *given: law.stiffness(*given), contact_radius, radius, curvature)

    def area_slope(self, contact_radius: Values, radius: Any, curvature: Values = 0.0) -> FloatArray:
        """Return dA/dd [mm]; 0 for an open contact."""
        return self._each(lambda law, *given: law.area_slope(*given), contact_radius, radius, curvature)

    def _each(
        self, method: Callable[..., FloatArray], value: Values, radius: Any, curvature: Values = 0.0
    ) -> FloatArray:
        """Return the values of a method of the law of each cap, in the common shape of all arguments."""
        given, summit, extra = np.broadcast_arrays(value, radius, curvature)
        found = np.zeros(given.shape)
        for k, law in enumerate(self.laws):
            own = summit["cap"] == k
            if own.any():
                found[own] = method(law, given[own], summit["radius"][own], extra[own])
        return found[()]
