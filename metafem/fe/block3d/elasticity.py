"""Mixed elasticity of a quarter of the block, Q2 displacements and Q1 pressure, for unit E*."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem.fe.block3d.boussinesq import displacement
from metafem.fe.block3d.faces import Face, mirrored
from metafem.fe.block3d.grading import Lines
from metafem.fe.block3d.line_elements import LineElements
from metafem.fe.linear_solve import solve

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Remainder:
    """Difference between the solutions of the block and of the half-space under each of m mirrored loads."""

    parity: tuple[int, int]
    source: FloatArray
    displacement: FloatArray  # (3 nodes, m) [1/mm]
    reaction: FloatArray  # nodal forces of the base, (3 nodes of the base, m) [1]
    residual: float


@dataclass(frozen=True, eq=False)
class Quarter:
    """Elements, matrix and degrees of freedom of the quarter x, y >= 0, z from the top down."""

    axes: tuple[LineElements, LineElements, LineElements]
    matrix: Any
    poisson_ratio: float
    sides: tuple[Face, Face]
    base: Face
    _index: IntArray  # of the displacement at a node, (component, x, y, z)

    @classmethod
    def on(cls, lines: Lines, poisson_ratio: float) -> Quarter:
        """Assemble the matrix without boundary conditions.

        ``2 mu dev(eps) : eps(v) - p div v - q div u - p q / K``, with 1/K = 0 for nu = 1/2. Elements and
        boxes are tensor products, so the matrices of Q2 and Q1 hexahedra are Kronecker products of line
        matrices: equal to the assembled matrices, and a thousand times as fast.
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
        shape = tuple(axis.node.size for axis in axes)
        return cls(
            axes,
            sp.block_array(rows, format="csr"),
            poisson_ratio,
            (Face.of(axes, 0), Face.of(axes, 1)),
            Face.of(axes, 2),
            np.arange(3 * math.prod(shape)).reshape(3, *shape),
        )

    def solve(self, parity: tuple[int, int], source: FloatArray) -> Remainder:
        """Solve for the difference from the half-space under mirrored unit loads.

        The parity holds the signs of a load's mirror images in x = 0 and in y = 0; `source` (m, 2) holds the
        positions of the loads [mm].
        """
        base, nodal = self._index[..., -1].ravel(), self._index.size
        known = self._known(parity)
        value = np.zeros((known.size, len(source)))
        load = np.zeros_like(value)
        value[base] = -self._base_displacement(source, parity)
        for side in self.sides:
            stress = side.weight[:, None] * side.traction(source, parity, self.poisson_ratio)
            load[:nodal] -= side.interpolation.T @ stress
        free, fixed = np.flatnonzero(~known), np.flatnonzero(known)
        rows = self.matrix[free]
        solved = solve(rows[:, free].tocsc(), load[free] - rows[:, fixed] @ value[fixed])
        value[free] = solved.value
        return Remainder(parity, source, value[:nodal], (self.matrix @ value - load)[base], solved.residual)

    def influence(self, field: Remainder, position: FloatArray) -> FloatArray:
        """Normal displacement of the top at positions (n, 2) minus that of the half-space, (n, m) [1/mm].

        By Betti's theorem for the fields of a load at the position p and of a source j. U, T are
        displacement and traction of the half-space, w the solution of the elements and t(w) its reaction:
        ``w_j(p) = -int_sides T_p (U_j + w_j) + int_base U_p (T_j + t(w_j))``. The result is
        symmetric and smooth in p, and the order of its error is twice that of w.
        """
        parity, nu = field.parity, self.poisson_ratio
        result = self._base_displacement(position, parity).T @ field.reaction
        stress = self.base.weight[:, None] * self.base.traction(field.source, parity, nu)
        result += self.base.displacement(position, parity, nu).T @ stress
        for side in self.sides:
            whole = side.displacement(field.source, parity, nu) + side.interpolation @ field.displacement
            result -= side.traction(position, parity, nu).T @ (side.weight[:, None] * whole)
        return result

    def top(self, field: Remainder, position: FloatArray) -> FloatArray:
        """As `influence`, interpolated in the elements; for positions in the quarter."""
        along = [self.axes[k].at(position[:, k]).toarray() for k in (0, 1)]
        normal = field.displacement[self._index[2, :, :, 0]]
        return np.asarray(np.einsum("nx,ny,xym->nm", *along, normal, optimize=True))

    def _known(self, parity: tuple[int, int]) -> BoolArray:
        """Whether each unknown is prescribed by symmetry or by the base."""
        known = np.zeros(self.matrix.shape[0], dtype=bool)
        for k, sign in enumerate(parity):
            # on the symmetry plane, an even field has no normal and an odd field no tangential displacement
            still = [k] if sign > 0 else [c for c in range(3) if c != k]
            known[np.take(self._index[still], 0, axis=k + 1)] = True
        known[self._index[..., -1]] = True
        return known

    def _base_displacement(self, source: FloatArray, parity: tuple[int, int]) -> FloatArray:
        """Half-space's displacement at the nodes of the base, (3 nodes, loads)."""
        nodes = np.meshgrid(*(axis.node for axis in self.axes), indexing="ij")
        point = np.stack([each[..., -1].ravel() for each in nodes], axis=-1)
        return mirrored(partial(displacement, poisson_ratio=self.poisson_ratio), point, source, parity)


def _kron(factors: Sequence[Any]) -> Any:
    return reduce(partial(sp.kron, format="csr"), factors)
