"""Elastic-plastic contact law of Jackson and Green."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray
from metafem.contact.by_indentation import LogCubic
from metafem.contact.elastic_plastic import AFTER_YIELD, ElasticPlastic
from metafem.contact.law import material_of
from metafem.material import Material
from metafem.notes import Note

# Hertz's law holds up to this multiple of the indentation at yield.
HERTZIAN = 1.9

# Largest ratio of yield strength to E* in the exponent B: three times the largest ratio in the finite-element
# analyses of the source. B has then doubled; at much larger ratios B would be unrealistic.
LARGEST_STRAIN = 0.03


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

    @property
    def _factor(self) -> float:
        """Factor C [-]."""
        return 1.295 * math.exp(0.736 * material_of(self).poisson_ratio)

    @cached_property
    def _exponent(self) -> float:
        """Exponent B [-]."""
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
        """Return P/P_c at w/w_c > 1.9, and d ln P/d ln w."""
        power = 1.0 + self._exponent  # exponent of w in (a/R)^2
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
        """Return `ElasticPlastic.notes`, and a warning if S_y/E* is too large for plastic contacts."""
        notes = super().notes(indentation, radius)
        if notes and self._strain > LARGEST_STRAIN:
            text = (
                f"S_y/E* = {self._strain:.3g} exceeds {LARGEST_STRAIN:g}, up to which the plastic part of "
                f"{self!r} holds: its loads and areas are an extrapolation; use KogutEtsion"
            )
            notes += (Note(text, quantity="S_y/E*", value=self._strain, bound=LARGEST_STRAIN),)
        return notes
