"""Elastic substrates: their protocol, those whose influence is radial, and the half-space.

The influence of a radial substrate depends only on the distance between source and displaced point.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if
from metafem.material import PeriodicCell
from metafem.substrate.periodic import lattice_sum
from metafem.surface import Surface


def agreed(substrate: str, name: str, stated: Any, given: Any) -> Any:
    """Return a value that the substrate or the surface defines; raise InvalidInput if both do and differ."""
    refuse_if(
        stated is not None and given is not None and stated != given,
        f"{substrate} has {name} = {stated}, but the surface has {given}",
    )
    return given if stated is None else stated


@runtime_checkable
class Substrate(Protocol):
    """Green's function of the block: the surface displacement per unit of rescaled load P/E*."""

    def for_surface(self, surface: Surface) -> Substrate:
        """Return the substrate with the dimensions and the Poisson's ratio of a surface."""

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Return the displacement at asperity i per unit of rescaled load on asperity j, (n, n) [1/mm].

        The diagonal contains the regular self terms: the difference from a half-space at r = 0.
        """

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return derivatives of the displacement at asperity i per unit of rescaled load on j, each (n, n).

        They are the two components of the in-plane gradient at i [1/mm^2] and the in-plane Laplacian
        [1/mm^3]. The diagonals contain the regular self terms.
        """


class Radial(ABC):
    """Base of substrates with the influence 1/(pi r) of a half-space plus a regular part.

    Examples
    --------
    >>> from metafem import HalfSpace
    >>> isinstance(HalfSpace(), Radial)
    True
    """

    def for_surface(self, surface: Surface) -> Self:
        """Return the substrate with the dimensions and the Poisson's ratio of a surface."""
        return self

    @property
    def self_influence(self) -> float:
        """Regular part of G at r = 0 [1/mm]; zero for a half-space, whose response is in the contact law."""
        return float(self.regular_derivatives(np.zeros(1))[0][0])

    @property
    def self_curvature(self) -> float:
        """Second derivative of the regular part of G at r = 0 [1/mm^3]."""
        return float(self.regular_derivatives(np.zeros(1))[2][0])

    @abstractmethod
    def regular_derivatives(self, distance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the regular parts of G [1/mm], G' [1/mm^2] and G'' [1/mm^3] at distances r >= 0 [mm]."""

    @property
    def last_wavenumber(self) -> float:
        """Wavenumber beyond which `transform` is zero to rounding [1/mm]."""
        return 0.0

    def transform(self, wavenumber: FloatArray) -> FloatArray:
        """Return the two-dimensional Fourier transform of the regular part of G [mm] at wavenumbers [1/mm].

        At 0 it is the mean displacement by a uniform pressure p/E* = 1, without the part of a half-space.
        """
        raise InvalidInput(
            f"{self!r} has no transform, which a surface with a periodic cell needs; use "
            "metafem.HalfSpace(), metafem.BondedLayer(), or define transform and last_wavenumber"
        )

    def periodic(self, cell: PeriodicCell, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the rows of `lattice_sum` for a source at differences x, y [mm] of the positions, (4, ...).

        They have the regular terms alone at x = y = 0, and no mean displacement of a half-space.
        """
        return lattice_sum(cell, x, y, self.transform, self.last_wavenumber)

    def regular(self, distance: ArrayLike) -> FloatArray:
        """Return ``G(r) - 1/(pi r)`` [1/mm], finite down to r = 0."""
        return self.regular_derivatives(np.asarray(distance, dtype=np.float64))[0]

    def influence(self, distance: ArrayLike, derivatives: bool = False) -> Any:
        """Return the surface displacement at a distance from a point load, per unit of P/E*.

        Parameters
        ----------
        distance : array_like
            r [mm], positive.
        derivatives : bool
            Whether to return (G, G', G'') instead of G; default: False.

        Returns
        -------
        G [1/mm], or G, G' [1/mm^2] and G'' [1/mm^3].

        Raises
        ------
        InvalidInput
            If a distance is not positive and finite.
        """
        r = np.asarray(distance, dtype=np.float64)
        if not ((r > 0.0) & (r < math.inf)).all():
            raise InvalidInput(f"distance = {distance!r:.80} must be finite and greater than 0")
        value, first, second = self.regular_derivatives(r)
        point = 1.0 / (math.pi * r)
        if not derivatives:
            return np.asarray(point + value)
        return point + value, first - point / r, second + 2.0 * point / r**2

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Return the displacement at asperity i per unit of rescaled load on asperity j, (n, n) [1/mm]."""
        return self.influence_terms(surface)[0]

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return gradient (x, y) [1/mm^2] and Laplacian [1/mm^3] at i of the influence of j, (n, n) each."""
        return self.influence_terms(surface)[1:]

    def influence_terms(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return `influence_matrix` and the three `influence_derivatives`; G is evaluated once.

        With a periodic cell they are sums over all periods, see `metafem.substrate.periodic`.
        """
        bound, (x, y) = self.for_surface(surface), surface.position.T
        dx, dy = x[:, None] - x, y[:, None] - y
        if surface.cell is not None:
            i, j = np.triu_indices(len(x))
            half, whole = bound.periodic(surface.cell, dx[i, j], dy[i, j]), np.empty((4, *dx.shape))
            for full, part, sign in zip(whole, half, (1.0, -1.0, -1.0, 1.0), strict=True):
                full[j, i], full[i, j] = sign * part, part  # the gradients are antisymmetric
            matrix, slope_x, slope_y, laplacian = whole
            return matrix, slope_x, slope_y, laplacian
        r = np.sqrt(dx * dx + dy * dy)
        np.fill_diagonal(r, 1.0 if len(r) == 1 else r[0, 1])  # not used
        matrix, first, second = bound.regular_derivatives(r)
        inverse = 1.0 / r
        point = inverse / math.pi
        matrix = matrix + point
        np.fill_diagonal(matrix, bound.self_influence)
        first = (first - point * inverse) * inverse
        laplacian = first + second + 2.0 * point * inverse * inverse
        np.fill_diagonal(laplacian, 2.0 * bound.self_curvature)
        return matrix, first * dx, first * dy, laplacian


@dataclass(frozen=True)
class HalfSpace(Radial):
    """An elastic half-space: ``G(r) = 1/(pi r)``.

    It is valid if the distances between asperities are small compared with the block. Boussinesq (1885);
    Johnson, Contact Mechanics, equation 3.22a, doi:10.1017/CBO9781139171731.

    Examples
    --------
    >>> HalfSpace().influence([1.0, 2.0]).round(6)
    array([0.31831 , 0.159155])
    """

    name: ClassVar[str] = "half-space"

    def regular_derivatives(self, distance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return three arrays of zeros: a half-space has no regular part."""
        return np.zeros_like(distance), np.zeros_like(distance), np.zeros_like(distance)

    def transform(self, wavenumber: FloatArray) -> FloatArray:
        """Return zeros: a half-space has no regular part, and its mean displacement is left out."""
        return np.zeros_like(wavenumber)
