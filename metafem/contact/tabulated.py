"""Contact law from a table of indentation, load and area."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.contact.by_indentation import LawByIndentation, LogCubic
from metafem.contact.law import Values, material_of
from metafem.errors import refuse_if
from metafem.material import Material

if TYPE_CHECKING:
    from metafem.surface import Surface

# Minimum number of points of a table without the origin; the slope of the cubic at a point needs three
# points.
FEWEST = 3


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
        words = f"has {table.shape[1]} positive points; a table needs at least {FEWEST}"
        refuse_if(table.shape[1] < FEWEST, words, key="indentation")
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
    def _load(self) -> LogCubic:
        """P/E* [mm^2] as a function of d [mm]."""
        return _monotone(self.table[0], self.table[1] / material_of(self).composite_modulus)

    @cached_property
    def _area(self) -> LogCubic:
        """A [mm^2] as a function of d [mm]."""
        return _monotone(self.table[0], self.table[2])

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return R of all asperities [mm], which the law does not use."""
        return surface.radius if radius is None else radius

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Return the last indentation of the table [mm]."""
        return np.full(np.shape(radius), self.table[0, -1])[()]

    def _scales(self, radius: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        one = np.ones_like(radius)
        return one, one, one


def _monotone(x: FloatArray, y: FloatArray) -> LogCubic:
    """Return the monotone cubic of ln y in ln x; its slope at the first point is that of the first secant."""
    u, v = np.log(x), np.log(y)
    slope = np.asarray(scipy.interpolate.pchip_interpolate(u, v, u, der=1))
    secant = np.diff(v) / np.diff(u)
    slope[0] = secant[0]
    slope[-1] = slope[-1] or secant[-1]  # PCHIP may set 0 at the last point
    return LogCubic(u, v, slope)
