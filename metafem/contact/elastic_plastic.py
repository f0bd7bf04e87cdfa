"""Elastic-plastic contact of a sphere and a rigid plane, by formulas fitted to finite elements."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, NamedTuple, Self

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.contact.by_indentation import LawByIndentation
from metafem.contact.flattened import FlattenedContact
from metafem.contact.law import Values
from metafem.contact.log_cubic import LogCubic
from metafem.errors import InvalidInput
from metafem.material import Material
from metafem.notes import Note, information

# Yield strength over E* of the softest metal in the finite elements of both sources: E/Y = 1000, nu = 0.3.
LEAST_STRAIN = 9e-4

# Hardness over yield strength, with which Kogut and Etsion write their formulas.
HARDNESS_RATIO = 2.8

# The blend after first yield ends at this multiple of the indentation at which it begins: the largest slope
# of ln P is then that of Hertz's law.
AFTER_YIELD = 2.0

# The other blends reach from the break over this number to the break times this number. With wider ones the
# load changes more, with narrower ones the slope of ln P exceeds 1.5 by more.
AROUND = 1.25

# Indentations of a blend at which its size is evaluated, and decimals of the size: the rest is rounding.
SAMPLES, DIGITS = 201, 9

# Nodes of the quadrature of the work between two ends of blends.
NODES = 40


class Blend(NamedTuple):
    """A cubic that closes the jump of published formulas, and by how much it changes them."""

    start: float  # w/w_c
    end: float  # w/w_c
    load_change: tuple[float, float]  # lowest and highest relative change of P
    area_change: tuple[float, float]  # lowest and highest relative change of A


class ElasticPlastic(LawByIndentation):
    """A law in the indentation w over that at yield, w_c, with loads over P_c and areas over A_c of Hertz.

    A law belongs to a material, which a model sets by `for_material`.
    """

    similar: ClassVar[bool] = True
    plastic: ClassVar[bool] = True
    material: Material | None

    @property
    @abstractmethod
    def _strain(self) -> float:
        """Yield strength over E* [-]."""

    @property
    @abstractmethod
    def _yield(self) -> float:
        """Indentation at yield over the summit radius, w_c/R [-]."""

    @property
    @abstractmethod
    def _load(self) -> LogCubic:
        """P/P_c over w/w_c, up to the end of the last blend."""

    @property
    @abstractmethod
    def _area(self) -> LogCubic:
        """A/A_c over w/w_c."""

    @abstractmethod
    def _published(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """P/P_c and A/A_c over w/w_c by the published formulas, with their jumps."""

    def _scaled_load(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return P/P_c over w/w_c, and d ln P/d ln w."""
        return self._load.at(w)

    def for_material(self, material: Material) -> Self:
        """Return the law for E* and nu of a material; the law itself if it has a material."""
        if self.material is not None:
            return self
        bound: Self = replace(self, material=material)  # type: ignore[type-var]
        if bound._strain < LEAST_STRAIN:
            name = next(iter(self.__dataclass_fields__))  # type: ignore[attr-defined]
            value, modulus = getattr(self, name), material.composite_modulus
            least = value * LEAST_STRAIN / bound._strain
            raise InvalidInput(
                f"{name} = {value:g} MPa is too low for E* = {modulus:g} MPa: it must be at least "
                f"{least:.4g} MPa, {least / modulus:.3g} E*, the softest material for which the law was "
                "computed; use a harder material or a smaller modulus"
            )
        return bound

    def blends(self) -> tuple[Blend, ...]:
        """Return the blends, and the change of the published load and area by each."""
        found = []
        for start, end in np.exp(self._area.x).reshape(-1, 2):
            w = np.geomspace(start, end, SAMPLES)
            load, area = self._published(w)
            change = [self._scaled_load(w)[0] / load - 1.0, self._area.at(w)[0] / area - 1.0]
            ranges = [(float(c.min().round(DIGITS)), float(c.max().round(DIGITS))) for c in change]
            found.append(Blend(float(start), float(end), ranges[0], ranges[1]))
        return tuple(found)

    def notes(self, indentation: FloatArray, radius: FloatArray) -> tuple[Note, ...]:
        """Return how many contacts are plastic, and the sizes of the blends that they reach."""
        w = np.asarray(indentation) / self.yield_indentation(radius)
        plastic = int((w > 1.0).sum())
        if not plastic:
            return ()

        def most(change: tuple[float, float]) -> str:
            return percent(max(map(abs, change)))

        sizes = (
            f"P by up to {most(one.load_change)} and A by up to {most(one.area_change)} for w/w_c from "
            f"{one.start:.3g} to {one.end:.3g}"
            for one in self.blends()
            if one.start < w.max()
        )
        return (
            information(
                f"{plastic} of {w.size} contacts deform plastically, up to an indentation of "
                f"{float(w.max()):.3g} w_c, where w_c is that at yield; cubics that close the jumps of the "
                f"published formulas change {', '.join(sizes)}"
            ),
        )

    def yield_indentation(self, radius: Values) -> FloatArray:
        """Indentation w_c at which the material yields below the contact [mm]."""
        return np.multiply(self._yield, radius)

    def breaks(self, radius: float) -> FloatArray:
        """Contact radii [mm] at the ends of the blends."""
        return np.asarray(radius * np.sqrt(self._yield * np.exp(self._area.y)))

    def unloaded(self, indentation: FloatArray, radius: FloatArray) -> tuple[FlattenedContact, FloatArray]:
        """Return the elastic law of flattened asperities (n,), and their loss of height [mm].

        With the largest indentation w_m and w* = w_m/w_c > 1, the loss of height is
        ``w_r = w_m (1 - w*^-0.28) (1 - w*^-0.69)``, the load ``P_m ((w - w_r)/(w_m - w_r))^n`` with
        ``n = 1.5 w*^-0.0331`` and the area ``A_m ((w - w_r)/(w_m - w_r))^m`` with ``m = w*^-0.12``. Etsion,
        Kligerman and Kadin, Int. J. Solids Struct. 42, 3716 (2005), doi:10.1016/j.ijsolstr.2004.12.006, for
        w* up to 170 and Kogut and Etsion's law. Jackson and Green's law uses them with its own w_c, where
        the same material yields. The formulas were not compared with the printed paper. n is raised where a
        contact would otherwise return more energy than its loading took, by less than 0.1 %, for w* < 1.1.
        """
        w = np.asarray(indentation) / self.yield_indentation(radius)
        flattened = w > 1.0
        star = np.where(flattened, w, 2.0)
        deepest = star * self.yield_indentation(radius)
        lost = (1.0 - star**-0.28) * (1.0 - star**-0.69)
        # the work of unloading is P_m (w_m - w_r)/(n + 1)
        least = self._scaled_load(star)[0] * star * (1.0 - lost) / self._work(star) - 1.0
        residual = np.where(flattened, lost * deepest, 0.0)
        law = FlattenedContact(
            self,
            residual,
            depth=np.where(flattened, deepest - residual, 0.0),
            load_before=np.where(flattened, self._load_at(deepest, radius)[0], 0.0),
            area_before=np.where(flattened, self._area_at(deepest, radius)[0], 0.0),
            load_exponent=np.maximum(1.5 * star**-0.0331, least),
            area_exponent=star**-0.12,
        )
        return law, residual

    def _work(self, w: FloatArray) -> FloatArray:
        """Work of loading, the integral of P/P_c over w/w_c."""
        # a power before the first blend, and smooth in ln w between the ends of the blends
        end = np.log(w)
        edge = np.append(self._load.x, np.inf)
        low, high = np.minimum(end[..., None], edge[:-1]), np.minimum(end[..., None], edge[1:])
        node, weight = np.polynomial.legendre.leggauss(NODES)
        inside = np.exp(0.5 * (low + high)[..., None] + 0.5 * (high - low)[..., None] * node)
        parts = 0.5 * (high - low) * ((self._scaled_load(inside)[0] * inside) @ weight)
        return np.asarray(np.exp(2.5 * np.minimum(end, edge[0])) / 2.5 + parts.sum(axis=-1))

    def _load_at(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        scaled, slope = self._scaled_load(depth / (self._yield * radius))
        load = 4.0 / 3.0 * self._yield**1.5 * radius**2 * scaled
        return load, load * slope / depth

    def _area_at(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        scaled, slope = self._area.at(depth / (self._yield * radius))
        area = math.pi * self._yield * radius**2 * scaled
        return area, area * slope / depth

    def _depth_at(self, area: FloatArray, radius: FloatArray) -> FloatArray:
        scaled = area / (math.pi * self._yield * radius**2)
        return np.asarray(self._yield * radius * self._area.inverse(scaled))

    def _bound(self) -> Material:
        """Return the material, or raise InvalidInput for a law without one."""
        if self.material is None:
            raise InvalidInput(
                f"{self!r} has no material yet: use it in a model, or call for_material(material)"
            )
        return self.material


@dataclass(frozen=True)
class KogutEtsion(ElasticPlastic):
    """Elastic-plastic contact of a sphere and a rigid plane by Kogut and Etsion, frictionless.

    With ``K = 0.454 + 0.41 nu`` the material yields at the indentation ``w_c = (pi K H/(2 E*))^2 R``. Up to
    there the contact is Hertz's, with P_c and A_c at w_c. With w* = w/w_c, ``P = 1.03 P_c w*^1.425`` and
    ``A = 0.93 A_c w*^1.136`` up to w* = 6, ``1.40 P_c w*^1.263`` and ``0.94 A_c w*^1.146`` up to 110, then
    the contact is fully plastic, ``P = H A`` and ``A = 2 pi R w``.

    The formulas jump at w* = 1, 6 and 110: P by +3, +1.7 and 3/(1.4 K) 110^-0.263 - 1 (+7.9 % at nu = 0.3,
    -5.5 % at 0.5), A by -7, +2.9 and +7.1 %. Cubics of ln P and ln A over ln w close the jumps with
    continuous slopes, from w* = 1 to 2, 4.8 to 7.5 and 88 to 137.5. They change A by at most 7.5, 1.5 and
    4.2 %, and P by at most 2.9, 1.7 and, for the third, which depends on nu,

    ====================  ====  ====  ====  ====  ====  ====
    nu                    0     0.1   0.2   0.3   0.4   0.5
    third change of P, %  15.8  12.1  8.6   5.1   1.8   4.2
    ====================  ====  ====  ====  ====  ====  ====

    `blends` evaluates the changes for a material, and the notes of a state name those that it reaches. P and
    A increase with w for all nu. The law couples by order 1. Valid for H/E* >= 0.0025 and contacts narrower
    than R. Kogut and Etsion, J. Appl. Mech. 69, 657 (2002), doi:10.1115/1.1490373.

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

    def __post_init__(self) -> None:
        check.member(self, "hardness", above=0.0)

    @property
    def _strain(self) -> float:
        return self.hardness / (HARDNESS_RATIO * self._bound().composite_modulus)

    @property
    def _factor(self) -> float:
        """K [-]."""
        return 0.454 + 0.41 * self._bound().poisson_ratio

    @cached_property
    def _yield(self) -> float:
        return (0.5 * math.pi * self._factor * self.hardness / self._bound().composite_modulus) ** 2

    @cached_property
    def _loads(self) -> list[tuple[float, float]]:
        """Factors and exponents of P/P_c; H 2 pi R w/P_c = 3/K w*."""
        return [(1.0, 1.5), (1.03, 1.425), (1.40, 1.263), (3.0 / self._factor, 1.0)]

    AREAS: ClassVar = [(1.0, 1.0), (0.93, 1.136), (0.94, 1.146), (2.0, 1.0)]
    BREAKS: ClassVar = (1.0, 6.0, 110.0)
    BLENDS: ClassVar = [
        (1.0, AFTER_YIELD),
        (6.0 / AROUND, 6.0 * AROUND),
        (110.0 / AROUND, 110.0 * AROUND),
    ]

    @cached_property
    def _load(self) -> LogCubic:
        return LogCubic.powers(self._loads, self.BLENDS)

    @cached_property
    def _area(self) -> LogCubic:
        return LogCubic.powers(self.AREAS, self.BLENDS)

    def _published(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        regime = np.searchsorted(self.BREAKS, w)
        (p, m), (q, n) = np.array(self._loads).T[:, regime], np.array(self.AREAS).T[:, regime]
        return p * w**m, q * w**n


# Jackson and Green: Hertz's law holds up to this multiple of the indentation at yield.
HERTZIAN = 1.9

# Largest yield strength over E* for the exponent B, which grows with it and has doubled there: three times
# the largest of the source's finite elements. Far above, B would be that of no material.
LARGEST_STRAIN = 0.03


@dataclass(frozen=True)
class JacksonGreen(ElasticPlastic):
    """Elastic-plastic contact of a sphere and a rigid plane by Jackson and Green, frictionless.

    With ``C = 1.295 exp(0.736 nu)`` the material yields at ``w_c = (pi C S_y/(2 E*))^2 R``. Up to 1.9 w_c
    the contact is Hertz's. Beyond, with w* = w/w_c and ``B = 0.14 exp(23 S_y/E*)``,
    ``A = pi R w (w*/1.9)^B``, and with ``a = sqrt(A/pi)`` and ``H = 2.84 S_y (1 - exp(-0.82 (a/R)^-0.7))``,
    ``P/P_c = exp(-w*^(5/12)/4) w*^(3/2) + 4 H/(C S_y) (1 - exp(-w*^(5/9)/25)) w*``.

    At 1.9 the load jumps by +0.5 % at nu = 0.3 and -3.4 % at 0.5, and the slope of A changes. Cubics of ln P
    and ln A over ln w from w* = 1.9 to 3.8 close the jump with continuous slopes. They change A by at most
    1.5 % at S_y/E* = 0.0015 and 2.8 % at 0.03, and P by at most

    ===============================  ====  ====  ====  ====  ====  ====
    nu                               0     0.1   0.2   0.3   0.4   0.5
    change of P, S_y/E* = 0.0015, %  6.9   4.7   2.5   0.6   2.2   4.0
    change of P, S_y/E* = 0.03, %    6.6   4.3   2.1   1.0   2.9   4.8
    ===============================  ====  ====  ====  ====  ====  ====

    `blends` evaluates this for a material, and the notes of a state name it. The law couples by order 1.
    Valid for S_y/E* from 0.0009 to 0.03, above which B is that of 0.03, and for contacts narrower than R.
    Jackson and Green, J. Tribol. 127, 343 (2005), doi:10.1115/1.1866166.

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

    def __post_init__(self) -> None:
        check.member(self, "yield_strength", above=0.0)

    @property
    def _strain(self) -> float:
        return self.yield_strength / self._bound().composite_modulus

    @property
    def _factor(self) -> float:
        """C [-]."""
        return 1.295 * math.exp(0.736 * self._bound().poisson_ratio)

    @cached_property
    def _yield(self) -> float:
        return (0.5 * math.pi * self._factor * self._strain) ** 2

    @cached_property
    def _exponent(self) -> float:
        """B [-]."""
        return 0.14 * math.exp(23.0 * min(self._strain, LARGEST_STRAIN))

    @cached_property
    def _load(self) -> LogCubic:
        end = HERTZIAN * AFTER_YIELD
        value, slope = self._formula(np.asarray(end))
        ends = np.log([HERTZIAN, end])
        return LogCubic(ends, np.array([1.5 * ends[0], np.log(value)]), np.array([1.5, slope]))

    @cached_property
    def _area(self) -> LogCubic:
        parts = [(1.0, 1.0), (HERTZIAN**-self._exponent, 1.0 + self._exponent)]
        return LogCubic.powers(parts, [(HERTZIAN, HERTZIAN * AFTER_YIELD)])

    def _scaled_load(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        plastic = w > HERTZIAN * AFTER_YIELD
        blended, formula = self._load.at(w), self._formula(np.where(plastic, w, HERTZIAN))
        load, slope = (np.where(plastic, *parts) for parts in zip(formula, blended, strict=True))
        return load, slope

    def _formula(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """P/P_c over w/w_c > 1.9, and d ln P/d ln w."""
        power = 1.0 + self._exponent  # of w in (a/R)^2
        wide = (self._yield * w * (w / HERTZIAN) ** self._exponent) ** -0.35
        hardness = -2.84 * np.expm1(-0.82 * wide)
        harder = -2.84 * np.exp(-0.82 * wide) * 0.82 * 0.35 * power * wide
        elastic = np.exp(-0.25 * w ** (5.0 / 12.0)) * w**1.5
        decay = w ** (5.0 / 9.0) / 25.0
        share = -np.expm1(-decay)
        plastic = 4.0 / self._factor * hardness * share * w
        rise = 1.0 + harder / hardness + 5.0 / 9.0 * decay * np.exp(-decay) / share
        total = elastic + plastic
        slope = (elastic * (1.5 - 5.0 / 48.0 * w ** (5.0 / 12.0)) + plastic * rise) / total
        return total, slope

    def _published(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        plastic = w > HERTZIAN
        load = np.where(plastic, self._formula(np.maximum(w, HERTZIAN))[0], w**1.5)
        return load, w * np.maximum(w / HERTZIAN, 1.0) ** self._exponent

    def notes(self, indentation: FloatArray, radius: FloatArray) -> tuple[Note, ...]:
        """As `ElasticPlastic.notes`, with a warning for plastic contacts beyond the range of S_y/E*."""
        notes = super().notes(indentation, radius)
        if notes and self._strain > LARGEST_STRAIN:
            text = (
                f"S_y/E* = {self._strain:.3g} exceeds {LARGEST_STRAIN:g}, up to which the plastic part of "
                f"{self!r} holds: its loads and areas are an extrapolation; use KogutEtsion"
            )
            notes += (Note(text),)
        return notes
