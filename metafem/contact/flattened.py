"""Elastic unloading and reloading of asperities flattened by an earlier load."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.contact.by_indentation import LawByIndentation
from metafem.contact.law import Values
from metafem.notes import Note, information


@dataclass(frozen=True, eq=False, repr=False)
class FlattenedContact(Value, LawByIndentation):
    """Contact law of each asperity of a surface that an earlier load has flattened.

    The indentation e is measured from the lowered summit. Up to the earlier indentation, ``e <= depth``, the
    contact is elastic: ``P = load_before (e/depth)^load_exponent`` and
    ``A = area_before (e/depth)^area_exponent``. Beyond it, the original law continues at the indentation
    ``e + residual``. For an asperity that has not yielded, depth and residual are 0. `Contact.unloaded`
    returns this law. All arrays are (n,).

    Attributes
    ----------
    law : LawByIndentation
        Law of the first loading.
    residual : ndarray
        Loss of height [mm].
    depth : ndarray
        Earlier indentation minus the loss of height [mm].
    load_before, area_before : ndarray
        P/E* and A at the earlier indentation [mm^2].
    load_exponent, area_exponent : ndarray
        Exponents of the elastic unloading [-].
    """

    individual: ClassVar[bool] = True
    plastic: ClassVar[bool] = True

    law: LawByIndentation
    residual: FloatArray
    depth: FloatArray
    load_before: FloatArray
    area_before: FloatArray
    load_exponent: FloatArray
    area_exponent: FloatArray

    def __repr__(self) -> str:
        """Return text with the original law and the largest loss of height."""
        return f"FlattenedContact({self.law!r}, by up to {float(np.max(self.residual)):.4g} mm)"

    @property
    def count(self) -> int:
        """Number of asperities."""
        return int(np.size(self.residual))

    def one(self, i: int) -> FlattenedContact:
        """Return the law of one asperity."""
        return FlattenedContact(
            self.law, *(np.asarray(getattr(self, part.name)[i]) for part in fields(self)[1:])
        )

    def breaks(self, radius: float) -> FloatArray:
        """Return the contact radii [mm] between which the law of one asperity is smooth."""
        before = math.sqrt(float(self.area_before) / math.pi)
        later = self.law.breaks(radius)
        return np.append([before] if before > 0.0 else [], later[later > before])

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Return the largest indentation [mm] of the original law, measured from the lowered summit."""
        return np.asarray(self.law.largest_indentation(radius) - self.residual)

    def notes(self, indentation: FloatArray, radius: FloatArray) -> tuple[Note, ...]:
        """Return a note on the number of flattened summits, and the notes of the original law."""
        flat = int((self.depth > 0.0).sum())
        elastic = (np.asarray(indentation) <= self.depth) & (self.depth > 0.0)
        if not flat:
            return self.law.notes(indentation, radius)
        text = (
            f"{flat} of {self.depth.size} summits are flattened by an earlier load, by up to "
            f"{float(np.max(self.residual)):.4g} mm; {int(elastic.sum())} of them are elastic, not loaded "
            "beyond it"
        )
        return (information(text), *self.law.notes(np.asarray(indentation) + self.residual, radius))

    def unloaded(self, indentation: FloatArray, radius: FloatArray) -> tuple[FlattenedContact, FloatArray]:
        """Return the law after further indentations (n,) [mm], and the further loss of height (n,) [mm]."""
        deeper, loss = self.law.unloaded(np.asarray(indentation) + self.residual, radius)
        further = np.asarray(indentation) > self.depth
        parts = (
            np.where(further, getattr(deeper, part.name), getattr(self, part.name))
            for part in fields(self)[1:]
        )
        return FlattenedContact(self.law, *parts), np.where(further, loss - self.residual, 0.0)

    def _scales(self, radius: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        return self.law._scales(radius)

    def _load_at(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        later = self.law._load_at(depth + self.residual, radius)
        return self._unloading(depth, self.load_before, self.load_exponent, later)

    def _area_at(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        later = self.law._area_at(depth + self.residual, radius)
        return self._unloading(depth, self.area_before, self.area_exponent, later)

    def _unloading(
        self,
        depth: FloatArray,
        before: FloatArray,
        exponent: FloatArray,
        later: tuple[FloatArray, FloatArray],
    ) -> tuple[FloatArray, FloatArray]:
        """Return a quantity and its derivative: elastic up to `depth`, by the original law beyond."""
        elastic = depth < self.depth
        value = before * np.where(elastic, depth / np.where(elastic, self.depth, 1.0), 1.0) ** exponent
        return np.where(elastic, value, later[0]), np.where(elastic, value * exponent / depth, later[1])

    def _depth_at(self, area: FloatArray, radius: FloatArray) -> FloatArray:
        elastic = area < self.area_before
        share = np.where(elastic, area / np.where(elastic, self.area_before, 1.0), 1.0)
        later = self.law._depth_at(area, radius) - self.residual
        return np.where(elastic, self.depth * share ** (1.0 / self.area_exponent), later)
