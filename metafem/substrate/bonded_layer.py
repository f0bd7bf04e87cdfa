"""The elastic layer bonded to a rigid base: its influence as an integral over wavenumbers, tabulated."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import ClassVar

import numpy as np
from scipy.special import j0, j1

from metafem import _validate as check
from metafem._kernels import layer as kernel
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if
from metafem.material import PeriodicCell
from metafem.substrate.periodic import image_sum
from metafem.substrate.radial import Radial, agreed
from metafem.surface import Surface

# Upper limit of the integrals. Beyond it 1 - M, which decreases at most as x^2 exp(-2x), is below 1e-19.
LAST_WAVENUMBER = 25.0

# End of the table in s = r/t. There G is below 1e-13 of its value on a half-space. Its decay is slowest at
# nu = 1/2, where it is exp(-0.739 s); 0.739 = cos 0.739 is the first pole of M.
TABLE_END = 48.0


@dataclass(frozen=True)
class BondedLayer(Radial):
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
        given = getattr(surface.block, "thickness", None)
        thickness = agreed("BondedLayer", "thickness", self.thickness, given)
        ratio = agreed("BondedLayer", "poisson_ratio", self.poisson_ratio, surface.material.poisson_ratio)
        refuse_if(thickness is None, "BondedLayer() needs the surface's block, or the argument thickness")
        return replace(self, thickness=thickness, poisson_ratio=ratio)

    def regular_derivatives(self, distance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the regular parts of G [1/mm], G' [1/mm^2] and G'' [1/mm^3] at distances r >= 0 [mm]."""
        thickness, ratio = self._values()
        value, first, second = kernel.regular(distance, thickness, _table(ratio))
        return value, first, second

    @property
    def last_wavenumber(self) -> float:
        """Wavenumber k beyond which 1 - M(k t) is zero to rounding [1/mm]."""
        return LAST_WAVENUMBER / self._values()[0]

    def transform(self, wavenumber: FloatArray) -> FloatArray:
        """Return ``2 (M(k t) - 1)/k`` [mm] at wavenumbers k [1/mm].

        At 0 it is the displacement by a uniform pressure p/E* = 1 without lateral strain.
        """
        thickness, ratio = self._values()
        x = np.where(wavenumber > 0.0, wavenumber * thickness, 1.0)
        value = -2.0 * thickness * _deficit(np.minimum(x, 4.0 * LAST_WAVENUMBER), ratio) / x
        mean = thickness * (1.0 - 2.0 * ratio) / (1.0 - ratio) ** 2
        return np.asarray(np.where(wavenumber > 0.0, value, mean))

    def periodic(self, cell: PeriodicCell, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the influence of all periods; directly where fewer periods than waves are summed.

        The waves of a thin layer in a large cell would need gigabytes.
        """
        sides, reach = np.array([cell.width, cell.length]), TABLE_END * self._values()[0]
        waves = np.prod(1.0 + self.last_wavenumber * sides / (2.0 * math.pi))
        if np.prod(1.0 + 2.0 * reach / sides) > waves:
            return super().periodic(cell, x, y)
        own = self.self_influence, 2.0 * self.self_curvature
        return image_sum(cell, x, y, partial(self.influence, derivatives=True), reach, own)

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
def _quadrature(poisson_ratio: float) -> tuple[FloatArray, FloatArray]:
    """Return nodes x and weights w for which sum w f(x) is the integral of (1 - M) f."""
    node, weight = np.polynomial.legendre.leggauss(16)
    panels = 72  # each is shorter than three periods of J0 at the end of the table
    half = 0.5 * LAST_WAVENUMBER / panels
    x = (half * (2.0 * np.arange(panels)[:, None] + 1.0 + node)).ravel()
    return x, half * np.tile(weight, panels) * _deficit(x, poisson_ratio)


@lru_cache
def _table(poisson_ratio: float) -> FloatArray:
    """Return the read-only table of the regular part."""
    x, weight = _quadrature(poisson_ratio)

    def regular(s: FloatArray) -> tuple[FloatArray, ...]:
        phase = np.outer(s, x)
        zero, one = j0(phase), j1(phase)
        return -(zero @ weight), one @ (weight * x), (zero - one / phase) @ (weight * x**2)

    return kernel.tabulated(regular, TABLE_END)
