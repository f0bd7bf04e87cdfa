"""Mixed elasticity of a quarter of the block, Q2 displacements and Q1 pressure, for unit E*."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial, reduce
from itertools import product
from typing import Any

import numpy as np
import scipy.sparse as sp

from metafem._validate import FloatArray, IntArray
from metafem.fe.block_lines import LineElements
from metafem.fe.block_mesh import Lines
from metafem.fe.block_point_load import displacement, side_traction
from metafem.fe.block_solver import solve

@dataclass(frozen=True, eq=False)
class Quarter:
    """Elements, matrix and degrees of freedom of the quarter x, y >= 0, z from the top down."""

    axes: tuple[LineElements, LineElements, LineElements]
    matrix: Any
    poisson_ratio: float

    @classmethod
    def on(cls, lines: Lines, poisson_ratio: float) -> Quarter:
        """Assemble the matrix without boundary conditions.

        ``2 mu dev(eps) : eps(v) - p div v - q div u - p q / K``, with 1/K = 0 for nu = 1/2. Elements and
        boxes are tensor products, so the matrices of Q2 and Q1 hexahedra are Kronecker products of
        those of lines: the same numbers as hexahedra's own, in a thousandth of the time.
        """
        axes = (LineElements.on(lines.x), LineElements.on(lines.y), LineElements.on(lines.z))
        mu = 0.5 * (1.0 - poisson_ratio)
        compliance = 1.5 * (1.0 - 2.0 * poisson_ratio) / (mu * (1.0 + poisson_ratio))

        def gradients(a: int, b: int) -> Any:
            """int d_a v d_b u"""
            return _kron([axis.product[int(a == k), int(b == k)] for k, axis in enumerate(axes)])

        laplacian = gradients(0, 0) + gradients(1, 1) + gradients(2, 2)
        rows: list[list[Any]] = [
            [mu * (gradients(b, a) - 2.0 / 3.0 * gradients(a, b)) for b in range(3)] for a in range(3)
        ]
        divergence = [_kron([axis.pressure[int(b == k)] for k, axis in enumerate(axes)]) for b in range(3)]
        for a in range(3):
            rows[a][a] = rows[a][a] + mu * laplacian
            rows[a].append(-divergence[a].T)
        mass = _kron([axis.pressure["mass"] for axis in axes])
        rows.append([*(-matrix for matrix in divergence), -compliance * mass])
        return cls(axes, sp.block_array(rows, format="csr"), poisson_ratio)

    def remainders(
        self, parity: tuple[int, int], sources: FloatArray, places: FloatArray
    ) -> tuple[FloatArray, float]:
        """Normal displacement of the top beyond the half-space's, under mirrored unit loads.

        Parameters
        ----------
        parity : (int, int)
            Sign of a load's mirror image in x = 0 and in y = 0.
        sources, places : (m, 2), (n, 2) ndarray
            Where the loads and the points in question are, in the quarter [mm].

        Returns
        -------
        (n, m) ndarray [1/mm], and the residual of the linear solution.
        """
        index = np.arange(3 * self._size).reshape(3, *(axis.node.size for axis in self.axes))
        known = np.zeros(self.matrix.shape[0], dtype=bool)
        for k, sign in enumerate(parity):
            # an even field does not move through its plane, an odd one moves through it alone
            still = [k] if sign > 0 else [c for c in range(3) if c != k]
            known[np.take(index[still], 0, axis=k + 1)] = True
        base = index[..., -1].ravel()
        known[base] = True
        value = np.zeros((known.size, len(sources)))
        load = np.zeros_like(value)
        for j, source in enumerate(sources):
            for mirror in product((1, -1), repeat=2):
                sign = math.prod(m for m, p in zip(mirror, parity, strict=True) if p < 0)
                image = source * mirror
                value[base, j] -= sign * self._base_displacement(image)
                load[: 3 * self._size, j] -= sign * self._side_load(image, index)
        free, fixed = np.flatnonzero(~known), np.flatnonzero(known)
        rows = self.matrix[free]
        value[free], residual = solve(rows[:, free].tocsc(), load[free] - rows[:, fixed] @ value[fixed])
        normal = value[index[2, :, :, 0]]
        along_x, along_y = (self.axes[k].at(places[:, k]).toarray() for k in (0, 1))
        return np.einsum("ny,nym->nm", along_y, np.tensordot(along_x, normal, 1)), residual

    @property
    def _size(self) -> int:
        return math.prod(axis.node.size for axis in self.axes)

    def _base_displacement(self, source: FloatArray) -> FloatArray:
        """Displacement of the base's nodes in a half-space, component by component."""
        x, y, z = (axis.node for axis in self.axes)
        field = displacement(x[:, None] - source[0], y - source[1], z[-1], self.poisson_ratio)
        return np.concatenate([part.ravel() for part in field])

    def _side_load(self, source: FloatArray, index: IntArray) -> FloatArray:
        """Nodal forces of a half-space's traction on the sides x = max and y = max."""
        force = np.zeros(index.shape)
        depth, depth_weight = self.axes[2].quadrature
        down = self.axes[2].at(depth)
        for k, other in ((0, 1), (1, 0)):
            along, weight = self.axes[other].quadrature
            shape = self.axes[other].at(along)
            distance = self.axes[k].node[-1] - source[k]
            traction = side_traction(
                distance, along[:, None] - source[other], depth, self.poisson_ratio
            )
            for component, stress in zip((k, other, 2), traction, strict=True):
                nodal = shape.T @ (weight[:, None] * stress * depth_weight @ down)
                np.moveaxis(force[component], k, 0)[-1] += nodal
        return force.ravel()


def _kron(factors: Sequence[Any]) -> Any:
    return reduce(partial(sp.kron, format="csr"), factors)
