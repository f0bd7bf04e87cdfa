"""Contact laws with load and area as functions of the indentation: elastic-plastic spheres, and tables.

The formulas of elastic-plastic contacts were fitted to finite elements.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value, percent
from metafem.caps.shapes import Values
from metafem.contact.law import ROUNDING, Contact, Contacts, material_of, root
from metafem.errors import InvalidInput, refuse_if
from metafem.material import Material
from metafem.notes import Note, information

if TYPE_CHECKING:
    from scipy.interpolate import CubicHermiteSpline

    from metafem.surface import Surface

# Lowest ratio of yield strength to E* in the finite-element analyses of both sources: E/Y = 1000, nu = 0.3.
LEAST_STRAIN = 9e-4

# Hertz's law of Jackson and Green holds up to this multiple of the indentation at yield.
HERTZIAN = 1.9

# Largest ratio of yield strength to E* in the exponent B of Jackson and Green: three times the largest ratio
# in the finite-element analyses of the source. B has then doubled; at much larger ratios B would be
# unrealistic.
LARGEST_STRAIN = 0.03


class LawByIndentation(Contact):
    """Contact law with load P/E* and area A as functions of the indentation d; its coupling is of order 1.

    The contact radius is ``sqrt(A/pi)``.
    """

    @abstractmethod
    def _scales(self, radius: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the units of d [mm], P/E* [mm^2] and A [mm^2]."""

    @abstractmethod
    def _knots(self) -> FloatArray:
        """Return the increasing indentations, in units, between which load and area are smooth."""

    @abstractmethod
    def _logarithms(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return ln P and ln A, (2, ...), at x = ln d, and their derivatives; all in units."""

    def _pressed(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, ...]:
        """Return P/E* [mm^2], A [mm^2], and their derivatives [mm] at indentations depth > 0 [mm]."""
        length, *units = self._scales(radius)
        value, slope = self._logarithms(np.log(depth / length))
        load, area = (unit * part for unit, part in zip(units, np.exp(value), strict=True))
        return load, area, load * slope[0] / depth, area * slope[1] / depth

    def breaks(self, radius: float) -> FloatArray:
        """Return the contact radii [mm] between which load and area are smooth."""
        length = self._scales(radius)[0]
        area = self._pressed(length * self._knots(), np.array(radius))[1]
        return np.asarray(np.sqrt(area / math.pi))

    def contacts(self, indentation: FloatArray, radius: FloatArray) -> Contacts:
        """Return the contacts at indentations [mm], without an inversion of A(d)."""
        given = (np.asarray(value, dtype=np.float64) for value in (indentation, radius))
        d, size = np.broadcast_arrays(*given)
        most = self.largest_indentation(size)
        deep = d > most * (1.0 + ROUNDING)
        if deep.any():
            first = np.unravel_index(int(np.argmax(deep)), d.shape)
            raise InvalidInput(
                f"indentation = {d[first]:.4g} mm exceeds {most[first]:.4g} mm, the largest that {self} "
                "describes; use lighter loads or a law with a larger range"
            )
        closed = d > 0.0
        load, area, stiffness, _ = self._pressed(np.where(closed, d, size), size)
        values = load, area, stiffness, np.sqrt(area / math.pi)
        return Contacts(*(np.asarray(np.where(closed, value, 0.0))[()] for value in values))

    def contact_radius(self, indentation: Values, radius: Values) -> FloatArray:
        """Return the contact radius sqrt(A/pi) [mm]; 0 where the contact is open."""
        return self.contacts(np.asarray(indentation), np.asarray(radius)).contact_radius

    def indentation(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the indentation d [mm]; 0 for an open contact."""
        a, size = np.broadcast_arrays(contact_radius, radius)
        length, _, unit = self._scales(size)
        closed = a > 0.0
        area = math.pi * np.where(closed, a, 1.0) ** 2 / np.where(closed, unit, math.pi)
        knots = np.log(self._knots())

        def parts(d: FloatArray) -> tuple[FloatArray, FloatArray]:
            value, slope = self._logarithms(np.log(d))
            found = np.exp(value[1])
            return found, found * slope[1]

        start = np.exp(np.interp(np.log(area), self._logarithms(knots)[0][1], knots))
        return np.asarray(np.where(closed, length * root(parts, area, start), 0.0))[()]

    def load(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the rescaled load P/E* [mm^2]."""
        return self._of_closed(0, contact_radius, radius)

    def stiffness(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return d(P/E*)/dd [mm]; 0 for an open contact."""
        return self._of_closed(2, contact_radius, radius)

    def area_slope(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return dA/dd [mm]; 0 for an open contact."""
        return self._of_closed(3, contact_radius, radius)

    def _of_closed(self, which: int, contact_radius: Values, radius: Values) -> FloatArray:
        """Return one of the values of `_pressed` at contact radii [mm]; 0 for open contacts."""
        d, size = np.broadcast_arrays(self.indentation(contact_radius, radius), radius)
        closed = d > 0.0
        found = self._pressed(np.where(closed, d, size), size)[which]
        return np.asarray(np.where(closed, found, 0.0))[()]


class ElasticPlastic(LawByIndentation):
    """Contact law that relates P/P_c and A/A_c to w/w_c; w_c, P_c and A_c are Hertz's values at first yield.

    The law needs a material, which a model sets by `for_material`.
    """

    similar: ClassVar[bool] = True
    plastic: ClassVar[bool] = True
    material: Material | None

    strength_ratio: ClassVar[float] = 1.0  # strength parameter of the law over the yield strength

    def __post_init__(self) -> None:
        check.member(self, self._name, above=0.0)

    @property
    def _name(self) -> str:
        """Name of the strength parameter of the law, which is its first field."""
        return str(next(iter(self.__dataclass_fields__)))  # type: ignore[attr-defined]

    @property
    def _strength(self) -> float:
        """Strength parameter over E* [-]."""
        return float(getattr(self, self._name) / material_of(self).composite_modulus)

    @property
    def _strain(self) -> float:
        """Yield strength over E* [-]."""
        return self._strength / self.strength_ratio

    @property
    @abstractmethod
    def _factor(self) -> float:
        """Maximum pressure of Hertz's contact at yield, over the strength parameter [-]."""

    @cached_property
    def _yield(self) -> float:
        """Indentation at yield over the summit radius, w_c/R [-]."""
        return (0.5 * math.pi * self._factor * self._strength) ** 2

    @abstractmethod
    def _published(self, w: Any) -> tuple[FloatArray, FloatArray]:
        """Return P/P_c and A/A_c at w/w_c from the published formulas, which have jumps.

        The formulas are analytic between their jumps, so that w may have a small imaginary part.
        """

    @property
    @abstractmethod
    def _blends(self) -> list[tuple[float, float]]:
        """Ranges of w/w_c in which cubics replace the published formulas."""

    def _formula_logarithms(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return ln P/P_c and ln A/A_c of the published formulas at w/w_c, and d/d ln w by a complex step."""
        found = np.log(np.stack(self._published(w * (1.0 + 1e-30j))))
        return found.real, found.imag / 1e-30

    @cached_property
    def _cubics(self) -> list[Any]:
        """Cubics of ln P/P_c and ln A/A_c in ln w/w_c, one for each blend."""
        found = []
        for ends in np.array(self._blends):
            parts = (np.moveaxis(part, 0, -1) for part in self._formula_logarithms(ends))
            found.append(scipy.interpolate.CubicHermiteSpline(np.log(ends), *parts))
        return found

    def _logarithms(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        value, slope = self._formula_logarithms(np.exp(x))
        for cubic in self._cubics:
            blended = (x >= cubic.x[0]) & (x <= cubic.x[1])
            value[:, blended] = cubic(x[blended]).T
            slope[:, blended] = cubic(x[blended], 1).T
        return value, slope

    def _knots(self) -> FloatArray:
        return np.array(self._blends).ravel()

    def for_material(self, material: Material) -> Self:
        """Return the law with a material, unless it already has one."""
        if self.material is not None:
            return self
        bound: Self = replace(self, material=material)  # type: ignore[type-var]
        if bound._strain < LEAST_STRAIN:
            value, modulus = getattr(self, self._name), material.composite_modulus
            least = value * LEAST_STRAIN / bound._strain
            raise InvalidInput(
                f"{self._name} = {value:g} MPa is too low for E* = {modulus:g} MPa: it must be at least "
                f"{least:.4g} MPa, {least / modulus:.3g} E*, the softest material for which the law was "
                "computed; use a harder material or a smaller modulus"
            )
        return bound

    def blends(self) -> FloatArray:
        """Return w/w_c at the ends of each blend, and its largest relative changes of P and A, (m, 4)."""
        ends = np.array(self._blends)
        x = np.linspace(np.log(ends[:, 0]), np.log(ends[:, 1]), 201)  # enough for two digits of the change
        change = np.expm1(self._logarithms(x)[0] - self._formula_logarithms(np.exp(x))[0])
        return np.column_stack([ends, np.abs(change).max(axis=1).T])

    def notes(self, indentation: FloatArray, radius: FloatArray) -> tuple[Note, ...]:
        """Return a note on the number of plastic contacts and on the blends that they reach."""
        w = np.asarray(indentation) / self.yield_indentation(radius)
        plastic = int((w > 1.0).sum())
        if not plastic:
            return ()

        sizes = (
            f"P by up to {percent(load)} and A by up to {percent(area)} for w/w_c from {start:.3g} to "
            f"{end:.3g}"
            for start, end, load, area in self.blends()
            if start < w.max()
        )
        return (
            information(
                f"{plastic} of {w.size} contacts deform plastically, up to an indentation of "
                f"{float(w.max()):.3g} w_c, where w_c is that at yield; cubics that close the jumps of the "
                f"published formulas change {', '.join(sizes)}"
            ),
        )

    def yield_indentation(self, radius: Values) -> FloatArray:
        """Return the indentation w_c [mm] at which the material below the contact first yields."""
        return np.multiply(self._yield, radius)

    def _scales(self, radius: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        square = self._yield * radius**2
        return self._yield * radius, 4.0 / 3.0 * self._yield**0.5 * square, math.pi * square


@dataclass(frozen=True)
class KogutEtsion(ElasticPlastic):
    """Frictionless elastic-plastic contact of a sphere and a rigid plane, by Kogut and Etsion.

    With ``K = 0.454 + 0.41 nu`` the material yields at the indentation ``w_c = (pi K H/(2 E*))^2 R``. Up to
    w_c Hertz's law holds; P_c and A_c are its load and area at w_c. With w* = w/w_c,
    ``P = 1.03 P_c w*^1.425`` and ``A = 0.93 A_c w*^1.136`` up to w* = 6, and ``P = 1.40 P_c w*^1.263`` and
    ``A = 0.94 A_c w*^1.146`` up to w* = 110. Above 110 the contact is fully plastic: ``P = H A`` and
    ``A = 2 pi R w``.

    The formulas jump at w* = 1, 6 and 110: P by +3 %, +1.7 % and 3/(1.4 K) 110^-0.263 - 1 (+7.9 % at nu =
    0.3, -5.5 % at 0.5), and A by -7, +2.9 and +7.1 %. From w* = 1 to 2, 4.8 to 7.5 and 88 to 137.5, cubics of
    ln P and ln A in ln w replace the formulas, so that both curves and their slopes are continuous. The three
    cubics change A by at most 7.5, 1.5 and 4.2 %. The first two change P by at most 2.9 and 1.7 %; the change
    by the third depends on nu:

    ====================  ====  ====  ====  ====  ====  ====
    nu                    0     0.1   0.2   0.3   0.4   0.5
    third change of P, %  15.8  12.1  8.6   5.1   1.8   4.2
    ====================  ====  ====  ====  ====  ====  ====

    `blends` returns these changes for a material, and the notes of a state report those that apply. P and A
    increase with w for all nu. The law couples by order 1. The law is valid for H/E* >= 0.0025 and contact
    radii below R. Kogut and Etsion, J. Appl. Mech. 69, 657 (2002), doi:10.1115/1.1490373.

    Parameters
    ----------
    hardness : float
        H of the softer material [MPa], positive.
    material : Material, optional
        Material of the surface; a model sets it by `for_material`.

    Raises
    ------
    InvalidInput
        If the hardness is not positive, or too low for the modulus of the material.

    Examples
    --------
    >>> from metafem.material import Material
    >>> law = KogutEtsion(hardness=0.1).for_material(Material(1.36))
    >>> law.yield_indentation(0.526).round(6)
    np.float64(0.003047)
    >>> a = law.contact_radius(0.01, 0.526)
    >>> a.round(6), law.load(a, 0.526).round(6)
    (np.float64(0.075828), np.float64(0.000911))
    """

    hardness: float
    material: Material | None = field(default=None, repr=False)

    strength_ratio: ClassVar[float] = 2.8

    def __str__(self) -> str:
        return f"Kogut-Etsion, H = {self.hardness:.4g} MPa"

    @property
    def _factor(self) -> float:
        """Factor K [-]."""
        return 0.454 + 0.41 * material_of(self).poisson_ratio

    @property
    def _blends(self) -> list[tuple[float, float]]:
        # up to 2, the slope of ln P does not exceed Hertz's 1.5; around 6 and 110 it does, more so in
        # narrower blends, and wider ones change the load more
        return [(1.0, 2.0), *((w / 1.25, w * 1.25) for w in (6.0, 110.0))]

    def _published(self, w: Any) -> tuple[FloatArray, FloatArray]:
        # factors and exponents in the four regimes; in the last, H 2 pi R w/P_c = 3/K w*
        load = [(1.0, 1.5), (1.03, 1.425), (1.40, 1.263), (3.0 / self._factor, 1.0)]
        area = [(1.0, 1.0), (0.93, 1.136), (0.94, 1.146), (2.0, 1.0)]
        regime = np.searchsorted((1.0, 6.0, 110.0), w.real)
        (p, m), (q, n) = (np.array(part).T[:, regime] for part in (load, area))
        return p * w**m, q * w**n


@dataclass(frozen=True)
class JacksonGreen(ElasticPlastic):
    """Frictionless elastic-plastic contact of a sphere and a rigid plane, by Jackson and Green.

    With ``C = 1.295 exp(0.736 nu)`` the material yields at ``w_c = (pi C S_y/(2 E*))^2 R``. Up to 1.9 w_c
    Hertz's law holds. For larger indentations, with w* = w/w_c and ``B = 0.14 exp(23 S_y/E*)``,
    ``A = pi R w (w*/1.9)^B``, and with ``a = sqrt(A/pi)`` and ``H = 2.84 S_y (1 - exp(-0.82 (a/R)^-0.7))``,
    ``P/P_c = exp(-w*^(5/12)/4) w*^(3/2) + 4 H/(C S_y) (1 - exp(-w*^(5/9)/25)) w*``.

    At w* = 1.9 the published load jumps by +0.5 % for nu = 0.3 and by -3.4 % for nu = 0.5, and the slope of A
    jumps too. From w* = 1.9 to 3.8, cubics of ln P and ln A in ln w replace the formulas, so that both curves
    and their slopes are continuous. The cubics change A by at most
    1.5 % at S_y/E* = 0.0015 and 2.8 % at 0.03, and P by at most

    ===============================  ====  ====  ====  ====  ====  ====
    nu                               0     0.1   0.2   0.3   0.4   0.5
    change of P, S_y/E* = 0.0015, %  6.9   4.7   2.5   0.6   2.2   4.0
    change of P, S_y/E* = 0.03, %    6.6   4.3   2.1   1.0   2.9   4.8
    ===============================  ====  ====  ====  ====  ====  ====

    `blends` returns these changes for a material, and the notes of a state report them. The law couples by
    order 1. The law is valid for S_y/E* from 0.0009 to 0.03 and for contact radii below R. Above 0.03, the
    law uses the value of B at 0.03. Jackson and Green, J. Tribol. 127, 343 (2005), doi:10.1115/1.1866166.

    Parameters
    ----------
    yield_strength : float
        S_y of the softer material [MPa], positive.
    material : Material, optional
        Material of the surface; a model sets it by `for_material`.

    Raises
    ------
    InvalidInput
        If the yield strength is not positive, or too low for the modulus of the material.

    Examples
    --------
    >>> from metafem.material import Material
    >>> law = JacksonGreen(yield_strength=0.03).for_material(Material(1.36))
    >>> law.yield_indentation(0.526).round(6)
    np.float64(0.002211)
    >>> a = law.contact_radius(0.01, 0.526)
    >>> a.round(6), law.load(a, 0.526).round(6)
    (np.float64(0.080221), np.float64(0.000838))
    """

    yield_strength: float
    material: Material | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"Jackson-Green, S_y = {self.yield_strength:.4g} MPa"

    @property
    def _factor(self) -> float:
        """Factor C [-]."""
        return 1.295 * math.exp(0.736 * material_of(self).poisson_ratio)

    @cached_property
    def _exponent(self) -> float:
        """Exponent B [-]."""
        return 0.14 * math.exp(23.0 * min(self._strain, LARGEST_STRAIN))

    @property
    def _blends(self) -> list[tuple[float, float]]:
        return [(HERTZIAN, 2.0 * HERTZIAN)]  # as narrow as the slope of ln P allows

    def _published(self, w: Any) -> tuple[FloatArray, FloatArray]:
        plastic = w.real > HERTZIAN
        wide = (self._yield * w * (w / HERTZIAN) ** self._exponent) ** -0.35  # (a/R)^-0.7
        hardness = -2.84 * np.expm1(-0.82 * wide)
        elastic = np.exp(-0.25 * w ** (5.0 / 12.0)) * w**1.5
        load = elastic - 4.0 / self._factor * hardness * np.expm1(-(w ** (5.0 / 9.0)) / 25.0) * w
        area = w * (w / HERTZIAN) ** self._exponent
        return np.where(plastic, load, w**1.5), np.where(plastic, area, w)

    def notes(self, indentation: FloatArray, radius: FloatArray) -> tuple[Note, ...]:
        """Return `ElasticPlastic.notes`, and a warning if S_y/E* is too large for plastic contacts."""
        notes = super().notes(indentation, radius)
        if notes and self._strain > LARGEST_STRAIN:
            text = (
                f"S_y/E* = {self._strain:.3g} exceeds {LARGEST_STRAIN:g}, up to which the plastic part of "
                f"{self} holds: its loads and areas are an extrapolation; use KogutEtsion"
            )
            notes += (Note(text, quantity="S_y/E*", value=self._strain, bound=LARGEST_STRAIN),)
        return notes


@dataclass(frozen=True, eq=False, repr=False, init=False)
class TabulatedContact(Value, LawByIndentation):
    """Contact law of one asperity and a rigid plane, from a measured or computed table.

    The logarithms of load and area are monotone cubics (PCHIP) of the logarithm of the indentation. Load and
    area therefore increase and have continuous slopes, and power laws are exact. Below the first point, both
    are power laws through the first two points. All asperities have the same law, whatever their R, on
    loading and unloading. The law couples by order 1. Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 300
    (1984), doi:10.1137/0905021.

    Parameters
    ----------
    indentation : array_like, (m,)
        Indentation d [mm], increasing and positive; a first point (0, 0, 0) is dropped.
    load : array_like, (m,)
        Load P [N] of one asperity, increasing and positive.
    area : array_like, (m,)
        Real contact area A [mm^2] of one asperity, increasing and positive.
    material : Material, optional
        Material of the surface, whose E* divides the load; a model sets it by `for_material`.

    Raises
    ------
    InvalidInput
        For a table that does not increase, has fewer than 3 points or unequal lengths, and for indentations
        beyond the last of the table.

    Examples
    --------
    >>> from metafem.material import Material
    >>> d = np.array([0.0, 0.01, 0.02, 0.04])
    >>> law = TabulatedContact(d, 1.36 * 4 / 3 * 0.526**0.5 * d**1.5, np.pi * 0.526 * d)
    >>> bound = law.for_material(Material(1.36))
    >>> a = bound.contact_radius(0.015, 0.526)
    >>> a.round(9), bound.load(a, 0.526).round(9)  # as Hertz's
    (np.float64(0.088825672), np.float64(0.001776513))
    """

    table: FloatArray  # (3, m): indentation, load and area, without a first point of zeros
    material: Material | None

    def __init__(
        self, indentation: ArrayLike, load: ArrayLike, area: ArrayLike, *, material: Material | None = None
    ) -> None:
        given = {"indentation": indentation, "load": load, "area": area}
        count = np.size(check.array("indentation", indentation, shape=(None,)))
        table = np.array([check.array(name, row, shape=(count,)) for name, row in given.items()])
        zero = not table[:, 0].any()
        for name, row in zip(given, table, strict=True):
            check.increasing(name, row, zero=zero)
        table = table[:, int(zero) :]
        # the slope of the cubic at a point needs three points
        words = f"has {table.shape[1]} positive points; a table needs at least 3"
        refuse_if(table.shape[1] < 3, words, key="indentation")
        table.flags.writeable = False
        object.__setattr__(self, "table", table)
        object.__setattr__(self, "material", material)

    def __repr__(self) -> str:
        """Return text with the number of points and the last indentation of the table."""
        return f"TabulatedContact(<{self.table.shape[1]} points>, up to {self.table[0, -1]:g} mm)"

    def for_material(self, material: Material) -> TabulatedContact:
        """Return the law with a material, unless it already has one."""
        return self if self.material is not None else TabulatedContact(*self.table, material=material)

    @cached_property
    def _cubics(self) -> CubicHermiteSpline:
        """Monotone cubics of ln P/E* and ln A in ln d; the first slope is that of the first secant."""
        depth, load, area = np.log(self.table)
        value = np.stack([load - math.log(material_of(self).composite_modulus), area], axis=1)
        slope = scipy.interpolate.pchip_interpolate(depth, value, depth, der=1)
        secant = np.diff(value, axis=0) / np.diff(depth)[:, None]
        slope[0] = secant[0]
        slope[-1] = np.where(slope[-1] > 0.0, slope[-1], secant[-1])  # PCHIP may set 0 at the last point
        return scipy.interpolate.CubicHermiteSpline(depth, value, slope)

    def _logarithms(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        cubics = self._cubics
        inside = np.clip(x, cubics.x[0], cubics.x[-1])
        slope = np.moveaxis(cubics(inside, 1), -1, 0)
        return np.moveaxis(cubics(inside), -1, 0) + slope * (x - inside), slope

    def _knots(self) -> FloatArray:
        return np.asarray(self.table[0])

    def _scales(self, radius: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        one = np.ones_like(radius)
        return one, one, one

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return R of all asperities [mm], which the law does not use."""
        return surface.radius if radius is None else radius

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Return the last indentation of the table [mm]."""
        return np.full(np.shape(radius), self.table[0, -1])[()]
