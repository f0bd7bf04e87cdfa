"""Coarse model of a large scene, used as a preconditioner for long waves and for the start."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dpotrs

from metafem._kernels.sums import mesh
from metafem._validate import FloatArray
from metafem.substrate import Radial

# Number of nodes of the coarse model. Dense matrices of this size are factorised in a fraction of a
# millisecond (100) to a tenth of a second (1600). More than USUAL_NODES are used if EACH asperities per node
# remain, for which this time is short.
USUAL_NODES = 100
MAX_NODES = 1600
EACH = 200

# Minimum number of asperities per node.
FEWEST = 16

# Number of points per side of a node's cell over which the influence is averaged.
POINTS = 3


@dataclass(frozen=True, eq=False)
class Coarse:
    """Nodes of a square grid that covers the scene; displacements are interpolated bilinearly between them.

    The loads of an asperity are shared by the four nodes around it, with the weights of the interpolation.
    """

    corner: NDArray[np.int64]  # index of the first of the four nodes around each asperity, (n,)
    fraction: FloatArray  # position of each asperity between its nodes, row and column, (n, 2)
    columns: int  # number of nodes in a row
    influence: FloatArray  # mean influence of the nodes' cells on each other [1/mm], (count, count)

    @property
    def count(self) -> int:
        """Number of nodes."""
        return len(self.influence)

    @property
    def rough(self) -> Coarse:
        """The model itself, whose products take little time."""
        return self

    def loads(self, load: FloatArray) -> FloatArray:
        """Return the sum of the loads at each node, (count,)."""
        total = np.zeros(self.count)
        mesh.spread_hats(self.corner, self.fraction, self.columns, load, total)
        return total

    def interpolated(self, value: FloatArray) -> FloatArray:
        """Return the values (n,) at the asperities of values (count,) at the nodes."""
        result = np.empty(len(self.corner))
        mesh.gather_hats(self.corner, self.fraction, self.columns, value, result)
        return result

    def displacement(self, load: FloatArray) -> FloatArray:
        """Return the displacement of the asperities by their loads (n,) in the coarse model, (n,) [mm]."""
        return self.interpolated(self.influence @ self.loads(load))

    def preconditioner(self, inverse: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """Return a function that approximates (1/D + E K E')^-1 v by Woodbury's formula.

        The function is ``v -> D v - D E Q E' D v`` with ``Q = (K^-1 + M)^-1``, where D is `inverse`, K is the
        influence of the nodes on each other, E interpolates from the nodes, and M is E' D E with the sum of
        each row on its diagonal. The function is positive definite for any D > 0, because ``(E' D v).Q E' D
        v`` is at most ``(E' D v).M^-1 E' D v``, which is at most v.D v by the Cauchy-Schwarz inequality.
        """
        root = np.sqrt(self.loads(inverse))
        inner = np.eye(self.count) + root[:, None] * self.influence * root
        # called directly: the checks of `scipy.linalg.cho_solve` take longer than the solution
        factor, _ = dpotrf(inner, lower=1, overwrite_a=1)

        def apply(vector: FloatArray) -> FloatArray:
            phi = self.influence @ self.loads(inverse * vector)
            phi -= self.influence @ (root * dpotrs(factor, root * phi, lower=1)[0])
            return np.asarray(inverse * (vector - self.interpolated(phi)))

        return apply


def coarsen(position: FloatArray, substrate: Radial) -> Coarse:
    """Return the coarse model of positions (n, 2) on a substrate."""
    low = position.min(axis=0)
    extent = np.maximum(position.max(axis=0) - low, 1e-12 * float(np.ptp(position)))
    count = len(position)
    nodes = max(1.0, min(USUAL_NODES, count / FEWEST), min(MAX_NODES, count / EACH))
    size = max(math.sqrt(float(extent[0] * extent[1]) / nodes), float(extent.max()) / nodes)
    exact = (position - low)[:, ::-1] / size
    cell = np.floor(exact).astype(np.int64)
    rows, columns = (int(most) + 2 for most in cell.max(axis=0))
    # mean over pairs of points in two cells, tabulated by the offset of the nodes
    offset = np.arange(max(rows, columns))
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
    y, x = np.divmod(np.arange(rows * columns), columns)
    influence = table[np.abs(x[:, None] - x), np.abs(y[:, None] - y)]
    return Coarse(cell @ np.array([columns, 1]), exact - cell, columns, influence)
