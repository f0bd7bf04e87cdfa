"""Coarse model of a large scene, used as a preconditioner for long waves."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.fft import irfft2, rfft2
from scipy.linalg.lapack import dpotrf, dpotrs
from scipy.sparse import csr_array

from metafem._validate import FloatArray
from metafem.substrate import Radial


class Coarse:
    """Nodes of a square grid that covers the scene; displacements are interpolated bilinearly between them.

    The loads of an asperity are shared by the four nodes around it, with the weights of the interpolation.
    """

    def __init__(self, position: FloatArray, substrate: Radial) -> None:
        count = len(position)
        low = position.min(axis=0)
        extent = np.maximum(position.max(axis=0) - low, 1e-12 * float(np.ptp(position)))
        # a matrix of 100 nodes is factorised in a fraction of a millisecond, one of 1600 in a tenth of a
        # second, which is short for 200 asperities per node; fewer than 16 per node save no products
        nodes = max(1.0, min(100, count / 16), min(1600, count / 200))
        size = max(math.sqrt(float(extent[0] * extent[1]) / nodes), float(extent.max()) / nodes)
        place = (position - low)[:, ::-1] / size
        cell = np.floor(place).astype(np.int64)
        rows, columns = (int(most) + 2 for most in cell.max(axis=0))
        y, x = (place - cell).T
        corner = cell @ np.array([columns, 1])
        nearest = corner[:, None] + np.array([0, 1, columns, columns + 1])
        weight = np.column_stack([(1.0 - y) * (1.0 - x), (1.0 - y) * x, y * (1.0 - x), y * x])
        starts = np.arange(0, 4 * count + 1, 4)
        self.hats = csr_array((weight.ravel(), nearest.ravel(), starts), shape=(count, rows * columns))
        self.sharing = self.hats.T.tocsr()
        # influence [1/mm] of a cloud of the size of a cell: at the centre of a square of side 1, the mean of
        # 1/r is 3.525, and the mean over the square is 2.973
        offset = size * np.abs(np.fft.fftfreq(2 * max(rows, columns), 0.5 / max(rows, columns)))
        table = substrate.influence(np.hypot(np.hypot(offset[:, None], offset), size / 2.973))
        # without the waves of negative influence, which a thin layer has on a grid wider than its thickness
        table = irfft2(np.maximum(rfft2(table).real, 0.0), s=table.shape)
        row, column = np.divmod(np.arange(rows * columns), columns)
        self.influence = table[np.abs(row[:, None] - row), np.abs(column[:, None] - column)]

    def preconditioner(self, inverse: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """Return a function that approximates (1/D + E K E')^-1 v by Woodbury's formula.

        The function is ``v -> D v - D E Q E' D v`` with ``Q = (K^-1 + M)^-1``, where D is `inverse`, K is the
        influence of the nodes on each other, E interpolates from the nodes, and M is E' D E with the sum of
        each row on its diagonal. The function is positive definite for any D > 0, because ``(E' D v).Q E' D
        v`` is at most ``(E' D v).M^-1 E' D v``, which is at most v.D v by the Cauchy-Schwarz inequality.
        """
        root = np.sqrt(self.sharing @ inverse)
        inner = np.eye(len(root)) + root[:, None] * self.influence * root
        # called directly: the checks of `scipy.linalg.cho_solve` take longer than the solution
        factor, failed = dpotrf(inner, lower=1, overwrite_a=1)
        if failed:
            raise np.linalg.LinAlgError("the coarse model is not positive definite")

        def apply(vector: FloatArray) -> FloatArray:
            phi = self.influence @ (self.sharing @ (inverse * vector))
            phi -= self.influence @ (root * dpotrs(factor, root * phi, lower=1)[0])
            return np.asarray(inverse * (vector - self.hats @ phi))

        return apply
