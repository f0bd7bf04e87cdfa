"""Substrates whose influence depends only on the distance between source and displaced point."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.material import PeriodicCell
from metafem.substrate.periodic import LatticeSum, lattice_sum
from metafem.surface import Surface


class Radial(ABC):
    """Base of substrates with the influence 1/(pi r) of a half-space plus a regular part.

    Examples
    --------
    >>> from metafem import HalfSpace
    >>> isinstance(HalfSpace(), Radial)
    True
    """

    @property
    def name(self) -> str:
        """Name of the substrate; default: the name of its class."""
        return type(self).__name__

    def for_surface(self, surface: Surface) -> Self:
        """Return the substrate with the dimensions and the Poisson's ratio of a surface."""
        return self

    @property
    @abstractmethod
    def self_influence(self) -> float:
        """Regular part of G at r = 0 [1/mm]."""

    @property
    @abstractmethod
    def self_curvature(self) -> float:
        """Second derivative of the regular part of G at r = 0 [1/mm^3]."""

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

    def periodic(self, cell: PeriodicCell, x: FloatArray, y: FloatArray) -> LatticeSum:
        """Return the influence of all periods of a source at differences x, y [mm] of the positions.

        The sum has the regular terms alone at x = y = 0, and no mean displacement of a half-space.
        """
        return lattice_sum(cell, x, y, self.transform, self.last_wavenumber)

    def regular(self, distance: ArrayLike) -> FloatArray:
        """Return ``G(r) - 1/(pi r)`` [1/mm], finite down to r = 0."""
        return self.regular_derivatives(_distances(distance, positive=False))[0]

    @overload
    def influence(self, distance: ArrayLike, derivatives: Literal[False] = False) -> FloatArray: ...

    @overload
    def influence(
        self, distance: ArrayLike, derivatives: Literal[True]
    ) -> tuple[FloatArray, FloatArray, FloatArray]: ...

    def influence(
        self, distance: ArrayLike, derivatives: bool = False
    ) -> FloatArray | tuple[FloatArray, FloatArray, FloatArray]:
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
        r = _distances(distance, positive=True)
        value, first, second = self.regular_derivatives(r)
        point = 1.0 / (math.pi * r)
        if not derivatives:
            return np.asarray(point + value)
        return point + value, first - point / r, second + 2.0 * point / r**2

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Return the displacement at asperity i per unit of rescaled load on asperity j, (n, n) [1/mm]."""
        if surface.cell is not None:
            return self.influence_terms(surface)[0]
        bound = self.for_surface(surface)
        _, _, r = _differences(surface.position)
        matrix = bound.influence(r)
        np.fill_diagonal(matrix, bound.self_influence)
        return matrix

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return gradient (x, y) [1/mm^2] and Laplacian [1/mm^3] at i of the influence of j, (n, n) each."""
        return self.influence_terms(surface)[1:]

    def influence_terms(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return `influence_matrix` and the three `influence_derivatives`; G is evaluated once.

        With a periodic cell they are sums over all periods, see `metafem.substrate.periodic`.
        """
        bound = self.for_surface(surface)
        dx, dy, r = _differences(surface.position)
        if surface.cell is not None:
            return _symmetric(bound.periodic(surface.cell, dx[_upper(len(dx))], dy[_upper(len(dx))]), len(dx))
        matrix, first, second = bound.influence(r, derivatives=True)
        np.fill_diagonal(matrix, bound.self_influence)
        first /= r
        laplacian = second + first
        np.fill_diagonal(laplacian, 2.0 * bound.self_curvature)
        return matrix, first * dx, first * dy, laplacian


def _upper(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    return np.triu_indices(count)


def _symmetric(half: LatticeSum, count: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the matrices (n, n) from their upper halves; the gradients change sign below the diagonal."""
    i, j = _upper(count)
    value, slope_x, slope_y, laplacian = (np.empty((count, count)) for _ in range(4))
    pairs = zip((value, slope_x, slope_y, laplacian), half, (1.0, -1.0, -1.0, 1.0), strict=True)
    for matrix, part, sign in pairs:
        matrix[j, i] = sign * part
        matrix[i, j] = part
    return value, slope_x, slope_y, laplacian


def _differences(position: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x_i - x_j, y_i - y_j and the distances, (n, n) each; the unused diagonal is positive."""
    x, y = position.T
    dx, dy = x[:, None] - x, y[:, None] - y
    r = np.hypot(dx, dy)
    np.fill_diagonal(r, 1.0 if len(r) == 1 else r[0, 1])
    return dx, dy, r


def _distances(distance: ArrayLike, positive: bool) -> FloatArray:
    try:
        r = np.asarray(distance, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"distance is not an array of numbers: {distance!r:.80}") from None
    if not (np.isfinite(r).all() and ((r > 0.0) | ((not positive) & (r == 0.0))).all()):
        raise InvalidInput(f"distance = {distance!r:.80} must be finite and greater than 0")
    return r
