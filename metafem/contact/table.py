"""Contact laws with load and area as functions of the indentation, and such a law from a table."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.caps.shapes import Values
from metafem.contact.law import ROUNDING, Contact, Contacts, material_of, root
from metafem.errors import InvalidInput, refuse_if
from metafem.material import Material

if TYPE_CHECKING:
    from scipy.interpolate import CubicHermiteSpline

    from metafem.surface import Surface


class LawByIndentation(Contact):
    """Contact law with load P/E* and area A as functions of the indentation d; its coupling is of order 1.

    The contact radius is ``sqrt(A/pi)``. The law ignores the curvature due to other contacts, which is a term
    of order 3.
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
                f"indentation = {d[first]:.4g} mm exceeds {most[first]:.4g} mm, the largest that {self!r} "
                "describes; use lighter loads or a law with a larger range"
            )
        closed = d > 0.0
        load, area, stiffness, _ = self._pressed(np.where(closed, d, size), size)
        values = load, area, stiffness, np.sqrt(area / math.pi)
        return Contacts(*(np.asarray(np.where(closed, value, 0.0))[()] for value in values))

    def contact_radius(self, indentation: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the contact radius sqrt(A/pi) [mm]; 0 where the contact is open."""
        return self.contacts(np.asarray(indentation), np.asarray(radius)).contact_radius

    def indentation(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
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

    def load(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the rescaled load P/E* [mm^2]."""
        return self._of_closed(0, contact_radius, radius)

    def stiffness(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return d(P/E*)/dd [mm]; 0 for an open contact."""
        return self._of_closed(2, contact_radius, radius)

    def area_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return dA/dd [mm]; 0 for an open contact."""
        return self._of_closed(3, contact_radius, radius)

    def _of_closed(self, which: int, contact_radius: Values, radius: Values) -> FloatArray:
        """Return one of the values of `_pressed` at contact radii [mm]; 0 for open contacts."""
        d, size = np.broadcast_arrays(self.indentation(contact_radius, radius), radius)
        closed = d > 0.0
        found = self._pressed(np.where(closed, d, size), size)[which]
        return np.asarray(np.where(closed, found, 0.0))[()]


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
        zero = int(not table[:, 0].any())
        table = table[:, zero:]
        # the slope of the cubic at a point needs three points
        words = f"has {table.shape[1]} positive points; a table needs at least 3"
        refuse_if(table.shape[1] < 3, words, key="indentation")
        for name, row in zip(given, table, strict=True):
            check.increasing(name, row, first=zero)
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
