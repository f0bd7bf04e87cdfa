"""One-dimensional elements along the edges of the block, whose tensor products are hexahedra."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.polynomial import polynomial

from metafem._validate import FloatArray

# Number of Gauss points in a cell. The matrices need 3; the tractions, which are not polynomials, need more.
POINTS = 5

# Coefficients of the Lagrange polynomials of equidistant nodes in a cell of unit length, by degree.
LAGRANGE = {1: [[1, -1], [0, 1]], 2: [[1, -3, 2], [0, 4, -4], [0, -1, 2]]}


def shapes(line: FloatArray, degree: int, position: FloatArray, derivative: int = 0) -> Any:
    """Return the shape functions of a degree, or their derivatives, as a sparse matrix (positions, nodes)."""
    cell = np.clip(np.searchsorted(line, position, side="right") - 1, 0, len(line) - 2)
    width = np.diff(line)[cell]
    x = (position - line[cell]) / width
    each = [polynomial.polyder(np.array(c, dtype=np.float64), derivative) for c in LAGRANGE[degree]]
    value = np.array([polynomial.polyval(x, c) for c in each]) / width**derivative
    column = degree * cell + np.arange(degree + 1)[:, None]
    row = np.broadcast_to(np.arange(len(position)), column.shape)
    count = degree * (len(line) - 1) + 1
    return sp.csr_array((value.ravel(), (row.ravel(), column.ravel())), shape=(len(position), count))


@dataclass(frozen=True, eq=False)
class LineElements:
    """Quadratic (displacement) and linear (pressure) elements on one line of vertices."""

    node: FloatArray  # ascending positions of the quadratic degrees of freedom [mm]
    point: FloatArray  # Gauss points [mm]
    weight: FloatArray  # their weights [mm]
    # values and derivatives of the quadratic shape functions at the Gauss points; then values of the linear
    # ones
    quadratic: tuple[Any, Any]
    linear: Any

    @classmethod
    def on(cls, line: FloatArray) -> LineElements:
        """Return the elements on a line of ascending vertices."""
        middle, half = 0.5 * (line[1:] + line[:-1]), 0.5 * np.diff(line)
        gauss, weight = np.polynomial.legendre.leggauss(POINTS)
        point = (middle[:, None] + half[:, None] * gauss).ravel()
        return cls(
            np.sort(np.concatenate([line, middle])),
            point,
            np.outer(half, weight).ravel(),
            (shapes(line, 2, point), shapes(line, 2, point, derivative=1)),
            shapes(line, 1, point),
        )

    def integral(self, left: Any, right: Any) -> Any:
        """Return the integrals of products of two sets of functions, from their values at Gauss points."""
        return left.T @ sp.diags_array(self.weight) @ right
