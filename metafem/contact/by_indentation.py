"""Contact laws that are known as load and area over the indentation."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import ClassVar

import numpy as np

from metafem._validate import FloatArray
from metafem.contact.law import Contact, Values
from metafem.errors import InvalidInput

# Relative excess of an indentation over the largest that is taken for rounding.
ROUNDING = 1e-12


class LawByIndentation(Contact):
    """A law of load P/E* and area A over the indentation d of one contact; it interacts by order 1.

    The contact radius is ``sqrt(A/pi)``. The curvature by other contacts is ignored: it is a term of
    order 3. The pressure is not known; its second moment is 2/5 P a^2 with Hertz's pressure and 1/2 P a^2
    with a uniform one, between which elastic-plastic contacts lie. `second_moment` is the larger.
    """

    largest_order: ClassVar[int] = 1

    @abstractmethod
    def _load_at(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """P/E* [mm^2] and its derivative [mm] at indentations depth > 0 [mm]."""

    @abstractmethod
    def _area_at(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """A [mm^2] and its derivative [mm] at indentations depth > 0 [mm]."""

    @abstractmethod
    def _depth_at(self, area: FloatArray, radius: FloatArray) -> FloatArray:
        """Indentation d [mm] at areas > 0 [mm^2]."""

    def contact_radius(self, indentation: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Contact radius sqrt(A/pi) [mm]; 0 where the contact is open."""
        given = (np.asarray(value, dtype=np.float64) for value in (indentation, radius))
        d, size = np.broadcast_arrays(*given)
        most = self.largest_indentation(size)
        deep = d > most * (1.0 + ROUNDING)
        if deep.any():
            first = np.unravel_index(int(np.argmax(deep)), d.shape)
            raise InvalidInput(
                f"indentation = {d[first]:.4g} mm exceeds {most[first]:.4g} mm, the largest that {self!r} "
                "describes; use lighter loads or a law with a larger range"
            )
        closed = d > 0.0
        area, _ = self._area_at(np.where(closed, d, 1.0), size)
        return np.asarray(np.where(closed, np.sqrt(area / math.pi), 0.0))[()]

    def indentation(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Indentation d [mm]."""
        a, size, closed = _closed(contact_radius, radius)
        return np.asarray(np.where(closed, self._depth_at(math.pi * a**2, size), 0.0))[()]

    def load(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Rescaled load P/E* [mm^2]."""
        a, size, closed = _closed(contact_radius, radius)
        load, _ = self._load_at(self._depth_at(math.pi * a**2, size), size)
        return np.asarray(np.where(closed, load, 0.0))[()]

    def second_moment(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Second moment over E* of a uniform pressure, 1/2 P/E* a^2 [mm^4], an upper bound."""
        return np.asarray(0.5 * np.square(contact_radius) * self.load(contact_radius, radius))[()]

    def stiffness(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Derivative of P/E* by d [mm]; 0 for an open contact."""
        a, size, closed = _closed(contact_radius, radius)
        _, slope = self._load_at(self._depth_at(math.pi * a**2, size), size)
        return np.asarray(np.where(closed, slope, 0.0))[()]

    def area_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Derivative of the area by d [mm]; 0 for an open contact."""
        a, size, closed = _closed(contact_radius, radius)
        _, slope = self._area_at(self._depth_at(math.pi * a**2, size), size)
        return np.asarray(np.where(closed, slope, 0.0))[()]


def _closed(contact_radius: Values, radius: Values) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Return contact radii [mm], R/1000 for open contacts, summit radii [mm], and which are closed."""
    given = (np.asarray(value, dtype=np.float64) for value in (contact_radius, radius))
    a, size = np.broadcast_arrays(*given)
    closed = a > 0.0
    return np.where(closed, a, 1e-3 * size), size, closed
