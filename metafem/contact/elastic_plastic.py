"""Elastic-plastic contact of a sphere and a rigid plane, by formulas fitted to finite elements."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.contact.by_indentation import LawByIndentation
from metafem.contact.law import Values, material_of
from metafem.errors import InvalidInput
from metafem.material import Material
from metafem.notes import Note, information

# Lowest ratio of yield strength to E* in the finite-element analyses of both sources: E/Y = 1000, nu = 0.3.
LEAST_STRAIN = 9e-4

# Indentation at which the blend after first yield ends, over that at which it begins. With this ratio, the
# slope of ln P over ln w within the blend does not exceed that of Hertz's law.
AFTER_YIELD = 2.0

# Number of indentations at which the change by a blend is evaluated, and number of decimals of the change.
SAMPLES, DIGITS = 201, 9


class Blend(NamedTuple):
    """Range of a cubic that replaces a jump of the published formulas, with the changes that it makes."""

    start: float  # w/w_c
    end: float  # w/w_c
    load_change: tuple[float, float]  # lowest and highest relative change of P
    area_change: tuple[float, float]  # lowest and highest relative change of A


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
    def _published(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return P/P_c and A/A_c at w/w_c from the published formulas, which have jumps."""

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

    def blends(self) -> tuple[Blend, ...]:
        """Return the blends; each states how much it changes the published load and area."""
        found = []
        for start, end in np.exp(self._area.x).reshape(-1, 2):
            w = np.geomspace(start, end, SAMPLES)
            load, area = self._published(w)
            change = [self._scaled_load(w)[0] / load - 1.0, self._area.at(w)[0] / area - 1.0]
            ranges = [(float(c.min().round(DIGITS)), float(c.max().round(DIGITS))) for c in change]
            found.append(Blend(float(start), float(end), ranges[0], ranges[1]))
        return tuple(found)

    def notes(self, indentation: FloatArray, radius: FloatArray) -> tuple[Note, ...]:
        """Return a note on the number of plastic contacts and on the blends that they reach."""
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
        """Return the indentation w_c [mm] at which the material below the contact first yields."""
        return np.multiply(self._yield, radius)

    def _scales(self, radius: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        square = self._yield * radius**2
        return self._yield * radius, 4.0 / 3.0 * self._yield**0.5 * square, math.pi * square
