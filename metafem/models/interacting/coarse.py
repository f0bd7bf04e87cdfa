"""Coarse model of a large scene, used as a preconditioner for long waves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dpotrs

from metafem._validate import FloatArray
from metafem.substrate import Radial

# Number of cells of the coarse model. Dense matrices of this size are factorised in a fraction of a
# millisecond (100) to a tenth of a second (1600). More than USUAL_CELLS are used if EACH asperities per cell
# remain, for which this time is short.
USUAL_CELLS = 100
MAX_CELLS = 1600
EACH = 200

# Minimum number of asperities per cell.
FEWEST = 16

# Number of points per side of a cell over which the influence is averaged.
POINTS = 3


@dataclass(frozen=True, eq=False)
class Coarse:
    """Square cells that cover the scene; displacements are assumed uniform within each cell."""

    cell: NDArray[np.int64]  # index of the cell of each asperity, (n,)
    count: int  # number of cells that contain asperities
    influence: FloatArray  # mean influence of the cells on each other [1/mm], (count, count)

    def loads(self, load: FloatArray) -> FloatArray:
        """Return the sum of the loads in each cell, (count,)."""
        return np.asarray(np.bincount(self.cell, load, minlength=self.count), dtype=np.float64)

    def preconditioner(self, inverse: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """Return a function that approximates (1/D + E K E')^-1 v by Woodbury's formula.

        The function is ``v -> D v - D E Q E' D v`` with ``Q = (K^-1 + E' D E)^-1``, where D is `inverse`, K
        is the influence of the cells on each other, and E assigns the value of a cell to its asperities. The
        function is positive definite for any D > 0, because (E' D v)^2 in a cell is at most the sum of D over
        the cell times v.D v.
        """
        root = np.sqrt(self.loads(inverse))
        inner = np.eye(self.count) + root[:, None] * self.influence * root
        # called directly: the checks of `scipy.linalg.cho_solve` take longer than the solution
        factor, _ = dpotrf(inner, lower=1, overwrite_a=1)

        def apply(vector: FloatArray) -> FloatArray:
            phi = self.influence @ self.loads(inverse * vector)
            phi -= self.influence @ (root * dpotrs(factor, root * phi, lower=1)[0])
            return np.asarray(inverse * (vector - phi[self.cell]))

        return apply


def coarsen(position: FloatArray, substrate: Radial) -> Coarse:
    """Return the coarse model of positions (n, 2) on a substrate."""
    low = position.min(axis=0)
    extent = np.maximum(position.max(axis=0) - low, 1e-12 * float(np.ptp(position)))
    count = len(position)
    cells = max(1.0, min(USUAL_CELLS, count / FEWEST), min(MAX_CELLS, count / EACH))
    size = max(math.sqrt(float(extent[0] * extent[1]) / cells), float(extent.max()) / cells)
    index = np.floor((position - low) / (size * (1.0 + 1e-9))).astype(np.int64)
    columns = int(index[:, 0].max()) + 1
    used, cell = np.unique(index @ np.array([1, columns]), return_inverse=True)
    x, y = used % columns, used // columns
    # mean over pairs of points in two cells, tabulated by the offset of the cells
    offset = np.arange(max(int(x.max()), int(y.max())) + 1)
    point = (np.arange(POINTS) + 0.5) / POINTS
    between = (point[:, None] - point).ravel()
    dx, dy = (
        offset[:, None, None, None] + between[None, None, :, None],
        offset[None, :, None, None] + between[None, None, None, :],
    )
    r = size * np.hypot(dx, dy)
    # coincident points represent subcells: the mean of 1/r over a square is 2.973 divided by its side
    r[r == 0.0] = size / POINTS / 2.973
    table = substrate.influence(r).mean(axis=(2, 3))
    return Coarse(cell, len(used), table[np.abs(x[:, None] - x), np.abs(y[:, None] - y)])
