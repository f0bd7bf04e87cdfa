"""The elastic layer bonded to a rigid base."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import ClassVar

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if
from metafem.substrate.layered import Layered, Quadrature, quadrature, regular_table
from metafem.substrate.protocol import agreed
from metafem.surface import Surface

# End of the table in s = r/t. There G is below 1e-13 of its value on a half-space. Its decay is slowest at
# nu = 1/2, where it is exp(-0.739 s); 0.739 = cos 0.739 is the first pole of M.
TABLE_END = 48.0


@dataclass(frozen=True)
class BondedLayer(Layered):
    """A layer of thickness t, unbounded in the plane, bonded to a rigid base.

    ``G(r) = 1/pi int_0^inf M(k t) J0(k r) dk`` with
    ``M(x) = (2 K sinh 2x - 4x) / (2 K cosh 2x + 4x^2 + 1 + K^2)`` and ``K = 3 - 4 nu``. The difference from
    1/(pi r) of a half-space is tabulated as polynomials in r/t, once for each nu, with an error below 1e-12
    of 1/(pi r). The layer is valid if the sides of the block are farther away from the asperities than t.
    Johnson, Contact Mechanics, section 5.8, doi:10.1017/CBO9781139171731.

    Parameters
    ----------
    thickness : float, optional
        t [mm], positive; default: the thickness of the surface's block.
    poisson_ratio : float, optional
        nu [-], from 0 to 0.5; default: the Poisson's ratio of the surface's material.

    Raises
    ------
    InvalidInput
        If a value is outside its range, or differs from the value of the surface.

    Examples
    --------
    >>> from metafem import HalfSpace
    >>> layer = BondedLayer(thickness=7.2, poisson_ratio=0.5)
    >>> (layer.influence([1.5, 6.0]) / HalfSpace().influence([1.5, 6.0])).round(3)
    array([ 0.64 , -0.059])
    """

    name: ClassVar[str] = "layer"

    thickness: float | None = None
    poisson_ratio: float | None = None

    def __post_init__(self) -> None:
        check.member(self, "thickness", optional=True, above=0.0)
        check.member(self, "poisson_ratio", optional=True, **check.POISSON)

    def for_surface(self, surface: Surface) -> BondedLayer:
        """Return the layer with the thickness and the Poisson's ratio of a surface."""
        ratio = agreed("BondedLayer", "poisson_ratio", self.poisson_ratio, surface.material.poisson_ratio)
        block = surface.block
        refuse_if(
            block is None and self.thickness is None,
            "BondedLayer() needs the surface's block, or the argument thickness",
        )
        given = None if block is None else block.thickness
        thickness = agreed("BondedLayer", "thickness", self.thickness, given)
        return replace(self, thickness=thickness, poisson_ratio=ratio)

    @property
    def _thickness(self) -> float:
        return self._values()[0]

    @property
    def _quadrature(self) -> Quadrature:
        return _quadrature(self._values()[1])

    @property
    def _table(self) -> FloatArray:
        return _table(self._values()[1])

    @property
    def _mean(self) -> float:
        """Displacement by a uniform pressure p/E* = 1 without lateral strain [mm]."""
        thickness, ratio = self._values()
        return thickness * (1.0 - 2.0 * ratio) / (1.0 - ratio) ** 2

    def _deficit(self, wavenumber: FloatArray) -> FloatArray:
        return _deficit(wavenumber, self._values()[1])

    def _values(self) -> tuple[float, float]:
        if self.thickness is None or self.poisson_ratio is None:
            raise InvalidInput(
                "BondedLayer needs thickness and poisson_ratio; for_surface(surface) sets them"
            )
        return self.thickness, self.poisson_ratio


def _deficit(wavenumber: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return 1 - M at wavenumbers x = k t [-], without cancellation."""
    x, kappa = wavenumber, 3.0 - 4.0 * poisson_ratio
    # in denominator minus numerator, the terms exp(2x) cancel analytically
    upper = 2.0 * kappa * np.exp(-2.0 * x) + 4.0 * x + 4.0 * x**2 + 1.0 + kappa**2
    return np.asarray(upper / (2.0 * kappa * np.cosh(2.0 * x) + 4.0 * x**2 + 1.0 + kappa**2))


@lru_cache
def _quadrature(poisson_ratio: float) -> Quadrature:
    return quadrature(partial(_deficit, poisson_ratio=poisson_ratio))


@lru_cache
def _table(poisson_ratio: float) -> FloatArray:
    return regular_table(_quadrature(poisson_ratio), TABLE_END)
