"""Elastic-plastic contact law of Kogut and Etsion."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from metafem._validate import FloatArray
from metafem.contact.by_indentation import LogCubic
from metafem.contact.elastic_plastic import AFTER_YIELD, ElasticPlastic
from metafem.contact.law import material_of
from metafem.material import Material

# The blends around w* = 6 and 110 extend from w*/AROUND to w* AROUND. Wider blends change the load more;
# narrower blends increase the largest slope of ln P, which exceeds 1.5.
AROUND = 1.25


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

    @property
    def _factor(self) -> float:
        """Factor K [-]."""
        return 0.454 + 0.41 * material_of(self).poisson_ratio

    @cached_property
    def _loads(self) -> list[tuple[float, float]]:
        """Factors and exponents of P/P_c in the four regimes; in the last, H 2 pi R w/P_c = 3/K w*."""
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
