"""The conducting layer on a grounded base."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if
from metafem.substrate.layered import Layered, Quadrature, quadrature, regular_table
from metafem.substrate.protocol import agreed
from metafem.surface import Surface

# End of the table in s = r/t. There G is below 1e-16 of its value on a half-space: it decays as
# exp(-pi/2 s), pi/2 being the first pole of tanh.
TABLE_END = 24.0


@dataclass(frozen=True)
class GroundedLayer(Layered):
    """A conducting layer of thickness t, unbounded in the plane, whose base has the potential 0.

    ``G(r) = 1/pi int_0^inf tanh(k t) J0(k r) dk``, which is the series of images
    ``1/pi [1/r + sum_m 2 (-1)^m / sqrt(r^2 + (2 m t)^2)]``: the potential at r by a current I through a point
    of the surface is ``rho I G(r)/2``. The self term is ``-ln 2/(pi t)``. The layer is valid if the sides of
    the block are farther away from the asperities than t.
    Carslaw and Jaeger, Conduction of Heat in Solids (1959), chapter 8.

    Parameters
    ----------
    thickness : float, optional
        t [mm], positive; default: the thickness of the surface's block.
    share : float
        Share of the layer in the sum of its resistivity and that of the opposite half-space [-], from 0 to 1;
        default: 1. The regular part of G is multiplied by it, so that ``(rho_1 + rho_2) I G(r)/2`` is the
        sum of the potentials of both bodies.

    Raises
    ------
    InvalidInput
        If a value is outside its range, or the thickness differs from that of the surface.

    Examples
    --------
    >>> from metafem import HalfSpace
    >>> (GroundedLayer(7.2).influence([1.5, 6.0]) / HalfSpace().influence([1.5, 6.0])).round(3)
    array([0.857, 0.48 ])
    """

    name: ClassVar[str] = "grounded layer"

    thickness: float | None = None
    share: float = 1.0

    def __post_init__(self) -> None:
        check.member(self, "thickness", optional=True, above=0.0)
        check.member(self, "share", at_least=0.0, at_most=1.0)

    def for_surface(self, surface: Surface) -> GroundedLayer:
        """Return the layer with the thickness of a surface's block."""
        block = surface.block
        refuse_if(
            block is None and self.thickness is None,
            "GroundedLayer() needs the surface's block, or the argument thickness",
        )
        given = None if block is None else block.thickness
        return replace(self, thickness=agreed("GroundedLayer", "thickness", self.thickness, given))

    @property
    def _thickness(self) -> float:
        if self.thickness is None:
            raise InvalidInput("GroundedLayer needs thickness; for_surface(surface) sets it")
        return self.thickness

    @property
    def _quadrature(self) -> Quadrature:
        x, weight = _quadrature()
        return x, self.share * weight

    @property
    def _table(self) -> FloatArray:
        return _table()

    @property
    def _mean(self) -> float:
        """Twice the potential by a uniform current density 1/rho [mm]."""
        return 2.0 * self.share * self._thickness

    def _deficit(self, wavenumber: FloatArray) -> FloatArray:
        return self.share * _deficit(wavenumber)

    def regular_derivatives(self, distance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the regular parts of G [1/mm], G' [1/mm^2] and G'' [1/mm^3] at distances r >= 0 [mm]."""
        value, first, second = super().regular_derivatives(distance)
        return self.share * value, self.share * first, self.share * second


def _deficit(wavenumber: FloatArray) -> FloatArray:
    """Return 1 - tanh x without cancellation."""
    return np.asarray(2.0 / (np.exp(2.0 * wavenumber) + 1.0))


@lru_cache
def _quadrature() -> Quadrature:
    return quadrature(_deficit)


@lru_cache
def _table() -> FloatArray:
    return regular_table(_quadrature(), TABLE_END)
