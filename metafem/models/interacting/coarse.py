"""Coarse model of a large scene: a preconditioner for long waves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.substrate import Radial

# Number of cells of the coarse model: dense matrices of this size are factorised in a fraction of a
# millisecond (100) to a tenth of a second (1600), which is short for a scene with EACH asperities per cell.
USUAL_CELLS = 100
MAX_CELLS = 1600
EACH = 200

# Minimum number of asperities per cell.
FEWEST = 16

# Points per side of a cell over which the mean influence is taken.
POINTS = 3


@dataclass(frozen=True, eq=False)
class Coarse:
    """Square cells over the scene within which displacements are assumed uniform."""

    cell: NDArray[np.int64]  # the cell of each asperity, (n,)
    count: int  # number of cells that contain any
    influence: FloatArray  # mean influence of the cells on each other [1/mm], (count, count)

    def loads(self, load: FloatArray) -> FloatArray:
        """Return the sums over the cells."""
        return np.asarray(np.bincount(self.cell, load, minlength=self.count), dtype=np.float64)

    def preconditioner(self, inverse: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """Return ``v -> D v - D E Q E' D v``, about (1/D + K)^-1 v by Woodbury's formula.

        E spreads the cells over their asperities, ``Q = (K^-1 + E' D E)^-1``. It is positive for any D,
        because no (E' D v)^2 exceeds D's sum over the cell times v.D v.
        """
        root = np.sqrt(self.loads(inverse))
        inner = np.eye(self.count) + root[:, None] * self.influence * root
        factor = scipy.linalg.cho_factor(inner, lower=True, overwrite_a=True)

        def apply(vector: FloatArray) -> FloatArray:
            phi = self.influence @ self.loads(inverse * vector)
            phi -= self.influence @ (root * scipy.linalg.cho_solve(factor, root * phi))
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
    # mean over pairs of points of two cells, by their offset in whole cells
    offset = np.arange(max(int(x.max()), int(y.max())) + 1)
    point = (np.arange(POINTS) + 0.5) / POINTS
    between = (point[:, None] - point).ravel()
    dx, dy = (
        offset[:, None, None, None] + between[None, None, :, None],
        offset[None, :, None, None] + between[None, None, None, :],
    )
    r = size * np.hypot(dx, dy)
    # coincident points represent subcells: the mean of 1/r over a square is 2.973 over its side
    r[r == 0.0] = size / POINTS / 2.973
    table = substrate.influence(r).mean(axis=(2, 3))
    return Coarse(cell, len(used), table[np.abs(x[:, None] - x), np.abs(y[:, None] - y)])
