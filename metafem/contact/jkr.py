"""Adhesive contact of any elastic cap, by the theory of Johnson, Kendall and Roberts."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from scipy.optimize import elementwise

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.caps.shapes import Values
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import Contact, material_of, sizes_of
from metafem.errors import InvalidInput, refuse_if, shown
from metafem.material import Material

if TYPE_CHECKING:
    from metafem.surface import Surface


@dataclass(frozen=True)
class JKR(Contact):
    """Frictionless adhesive contact of an elastic cap and a rigid plane.

    Let d_cap(a) and P_cap(a) be indentation and load of the cap without adhesion, ``c = d d_cap/da`` and
    ``s = sqrt(2 pi w a/E*)``. Then ``d = d_cap - s``, ``A = pi a^2``, ``P/E* = P_cap/E* - 2 a s``, and
    ``dP/dd = 2 a E* (c - 3/2 s/a)/(c - 1/2 s/a)``. For a paraboloid without other contacts
    ``a^3 = 3 R/(4 E*) [P + 3 pi w R + sqrt(6 pi w R P + (3 pi w R)^2)]``. Under load control the contact
    breaks at `pull_off_radius`, where the load of a paraboloid is ``-3/2 pi w R``. Under displacement control
    the contact stays closed down to a smaller radius, where ``c = 1/2 s/a``. Lengths are in mm. The law is
    valid for soft, large contacts with short-range adhesion (Tabor parameter above about 5), and for profiles
    with increasing ``c sqrt(a)``. Johnson, Kendall and Roberts, Proc. R. Soc. A 324, 301 (1971),
    doi:10.1098/rspa.1971.0141; other profiles: Popov and Hess (2015), doi:10.1007/978-3-642-53876-6.

    Parameters
    ----------
    adhesion_energy : float
        w [N/mm], at least 0; 9 mJ/m^2 is 9e-6 N/mm.
    cap : Contact
        Elastic law without adhesion: `Hertz()` (default) or `Elastic()`.
    material : Material, optional
        Material of the surface; a model sets it by `for_material`.

    Raises
    ------
    InvalidInput
        If w is negative, or `cap` is not an elastic law without adhesion.

    Examples
    --------
    >>> law = JKR(9e-6).for_material(Material(1.36))
    >>> a = law.pull_off_radius(0.526)
    >>> a.round(6), law.load(a, 0.526).round(10)
    (np.float64(0.018635), np.float64(-1.64033e-05))
    >>> law.zero_load_radius(0.526).round(6), law.contact_radius(0.0, 0.526).round(6)
    (np.float64(0.029581), np.float64(0.022575))
    """

    adhesive: ClassVar[bool] = True

    adhesion_energy: float
    cap: Contact = PARABOLOID
    material: Material | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        check.member(self, "adhesion_energy", at_least=0.0)
        laws = "an elastic law without adhesion, such as metafem.Hertz() or metafem.Elastic()"
        check.instance("cap", self.cap, Contact, laws)
        refuse_if(self.cap.adhesive or self.cap.largest_order < 3, f"cap = {shown(self.cap)} must be {laws}")

    def __str__(self) -> str:
        energy = 1e6 * self.adhesion_energy  # in mJ/m^2
        return f"JKR, w = {energy:.4g} mJ/m^2{'' if self.cap == PARABOLOID else f', {self.cap}'}"

    @property
    def without_adhesion(self) -> Contact:
        """Law of the cap without adhesion."""
        return self.cap

    def for_material(self, material: Material) -> Contact:
        """Return the law with a material, unless it already has one; return the cap's law if w is 0."""
        if self.adhesion_energy == 0.0:
            return self.cap
        return self if self.material is not None else replace(self, material=material)

    def bound(self, surface: Surface) -> Contact:
        """Return the law for the material and the caps of a surface."""
        return replace(self, cap=self.cap.bound(surface)).for_material(surface.material)

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return what the methods take as `radius`: that of the law without adhesion."""
        return self.cap.summits(surface, radius)

    @property
    def length(self) -> float:
        """Length w/E* [mm]."""
        return self.adhesion_energy / material_of(self).composite_modulus

    def deficit(self, contact_radius: Values) -> FloatArray:
        """Return s = sqrt(2 pi w a/E*) [mm], by which adhesion reduces the cap's indentation."""
        return np.sqrt(2.0 * math.pi * self.length * np.asarray(contact_radius, dtype=np.float64))

    def profile_slope(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the slope c = d d_cap/da of the cap's indentation [-], for a > 0."""
        return self.cap.profile_slope(contact_radius, radius)

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Return the largest indentation [mm] for which the law is valid; infinite if there is no limit."""
        most = np.asarray(self.cap.largest_indentation(radius), dtype=np.float64)
        finite = np.isfinite(most)
        if not finite.any():
            return most[()]
        a = self.cap.contact_radius(np.where(finite, most, 0.0), radius)
        return np.where(finite, most - self.deficit(a), most)[()]

    def contact_radius(self, indentation: Values, radius: Values) -> FloatArray:
        """Return the contact radius a [mm] on the stable branch of loading; 0 for open contacts, d < 0.

        At d = 0 the asperity has jumped into contact. On unloading, the contact stays closed down to a
        negative indentation. The models follow this branch to find the contact radius.
        """
        if self.length == 0.0:
            return self.cap.contact_radius(indentation, radius)
        found = self._radius_where(self.cap.indentation, 1.0, radius, np.maximum(indentation, 0.0))
        return np.where(np.asarray(indentation) >= 0.0, found, 0.0)[()]

    def indentation(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the indentation d = d_cap - s [mm]."""
        return self.cap.indentation(contact_radius, radius) - self.deficit(contact_radius)

    def load(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the rescaled load P/E* = P_cap/E* - 2 a s [mm^2]."""
        a = np.asarray(contact_radius)
        return np.asarray(self.cap.load(a, radius) - 2.0 * a * self.deficit(a))[()]

    def stiffness(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return d(P/E*)/dd = 2 a (c - 3/2 s/a)/(c - 1/2 s/a) [mm]; 0 for an open contact."""
        a, slope, drop = self._rates(contact_radius, radius)
        return np.asarray(2.0 * a * (slope - 1.5 * drop) / (slope - 0.5 * drop))[()]

    def area_slope(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return dA/dd = 2 pi a/(c - 1/2 s/a) [mm]; 0 for an open contact."""
        a, slope, drop = self._rates(contact_radius, radius)
        return np.asarray(2.0 * math.pi * a / (slope - 0.5 * drop))[()]

    def entry_radius(self, radius: Values) -> FloatArray:
        """Return the contact radius [mm] after the jump into contact at d = 0."""
        return self.contact_radius(np.zeros(np.shape(radius)), radius)

    def pull_off_radius(self, radius: Values) -> FloatArray:
        """Return the contact radius [mm] at which the load has its (negative) minimum: c = 3/2 s/a."""
        return self._radius_where(self._edge, 1.5, radius)

    def break_radius(self, radius: Values) -> FloatArray:
        """Return the contact radius [mm] of smallest indentation, where the branch ends: c = 1/2 s/a."""
        return self._radius_where(self._edge, 0.5, radius)

    def zero_load_radius(self, radius: Values) -> FloatArray:
        """Return the radius [mm] of the stable contact at zero load: P_cap/(2 a E*) = s."""
        return self._radius_where(lambda a, cap: self.cap.load(a, cap) / (2.0 * a), 1.0, radius)

    def _edge(self, contact_radius: FloatArray, radius: Values) -> FloatArray:
        """Return a c [mm]."""
        return contact_radius * self.profile_slope(contact_radius, radius)

    def _rates(self, contact_radius: Values, radius: Values) -> tuple[FloatArray, ...]:
        """Return a [mm], c [-] and s/a [-]; for open contacts c = 1 and s/a = 0."""
        a = np.asarray(contact_radius, dtype=np.float64)
        with np.errstate(invalid="ignore", divide="ignore"):
            slope = np.where(a > 0.0, self.profile_slope(a, radius), 1.0)
            drop = np.where(a > 0.0, self.deficit(a) / a, 0.0)
        return a, slope, drop

    def _radius_where(
        self, value: Callable[..., FloatArray], share: float, radius: Values, depth: Values = 0.0
    ) -> FloatArray:
        """Return the contact radius a at which value(a, radius) is depth + share s, to rounding.

        The unknown is the logarithm of the cap's indentation, in which that of the ratio is almost linear.
        """
        summit, given = np.broadcast_arrays(radius, depth)
        args = [np.arange(summit.size).reshape(summit.shape), given]
        top = np.log(np.asarray(self.cap.largest_indentation(summit), dtype=np.float64))

        def at(x: FloatArray, which: IntArray, deep: FloatArray) -> FloatArray:
            own = summit.ravel()[which]
            a = self.cap.contact_radius(np.exp(x), own)
            return np.asarray(np.log(value(a, own) / (deep + share * self.deficit(a))))

        ends = np.isfinite(top)  # a cap without end has no bound
        if (ends & (at(np.where(ends, top, 0.0), *args) < 0.0)).any():
            raise InvalidInput(
                f"adhesion_energy = {self.adhesion_energy:g} N/mm pulls the contact beyond the range of "
                f"{self.cap!r}; use a smaller energy or a wider profile"
            )
        guess = np.minimum(np.log(given + np.cbrt(self.length**2 * sizes_of(summit))), top - 1.0)
        bracket = elementwise.bracket_root(at, guess, guess + 0.5, xmax=top, args=args).bracket
        x = elementwise.find_root(at, bracket, args=args).x
        return np.asarray(self.cap.contact_radius(np.exp(x), summit))[()]


def of_sizes(method: Callable[[JKR, FloatArray], FloatArray], law: JKR, radius: FloatArray) -> FloatArray:
    """Return contact radii [mm] for summit radii (n,), by a method of `JKR` such as `entry_radius`."""
    return _of_sizes(method, law, radius.tobytes(), radius.dtype)


# cached because a design repeats this root search for many heights
@lru_cache(maxsize=64)
def _of_sizes(
    method: Callable[[JKR, FloatArray], FloatArray], law: JKR, radius: bytes, kind: Any
) -> FloatArray:
    """Return the radii of `of_sizes`, computed once for each distinct summit radius."""
    sizes, which = np.unique(np.frombuffer(radius, kind), return_inverse=True)
    return np.asarray(method(law, sizes))[which]
