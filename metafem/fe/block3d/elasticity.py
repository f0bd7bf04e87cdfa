"""Mixed elements for a quarter of the block: Q2 displacements, Q1 pressure, E* = 1."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem.fe.block3d.boussinesq import displacement, mirrored, traction
from metafem.fe.block3d.line_elements import LineElements
from metafem.fe.linear_solve import solve

BoolArray = NDArray[np.bool_]


class Remainder(NamedTuple):
    """Solution of the block minus that of the half-space, for each of m mirrored loads."""

    parity: tuple[int, int]
    source: FloatArray
    displacement: FloatArray  # (3 nodes, m) [1/mm]
    reaction: FloatArray  # nodal forces of the base, (3 nodes of the base, m) [1]
    residual: float


class Face(NamedTuple):
    """Gauss points of the far face along an axis: positions (q, 3), weights, interpolation from nodes."""

    normal: int
    point: FloatArray
    weight: FloatArray  # (3q, 1)
    interpolation: Any  # (3q, nodal values)


@dataclass(frozen=True, eq=False)
class Quarter:
    """Elements, matrix and degrees of freedom of the quarter x, y >= 0; z points down from the top."""

    axes: list[LineElements]
    matrix: Any
    poisson_ratio: float
    faces: list[Face]  # the two sides and the base
    _index: IntArray  # of the displacement at a node, (component, x, y, z)

    @classmethod
    def on(cls, lines: Sequence[FloatArray], poisson_ratio: float) -> Quarter:
        """Return the quarter on the tensor product of `lines`, with its matrix before boundary conditions.

        The form is ``2 mu dev(eps) : eps(v) - p div v - q div u - p q / K``, with 1/K = 0 for nu = 1/2. The
        mesh and the Q2 and Q1 hexahedra are tensor products, so the matrices are Kronecker products of line
        matrices. They equal the assembled matrices and are computed a thousand times as fast.
        """
        axes = [LineElements.on(line) for line in lines]
        mu = 0.5 * (1.0 - poisson_ratio)
        compliance = 1.5 * (1.0 - 2.0 * poisson_ratio) / (mu * (1.0 + poisson_ratio))

        def gradients(a: int, b: int) -> Any:
            """int d_a v d_b u"""
            return _kron([x.integral(x.quadratic[a == k], x.quadratic[b == k]) for k, x in enumerate(axes)])

        laplacian = gradients(0, 0) + gradients(1, 1) + gradients(2, 2)
        rows: list[list[Any]] = [
            [mu * (gradients(b, a) - 2.0 / 3.0 * gradients(a, b)) for b in range(3)] for a in range(3)
        ]
        divergence = [
            _kron([x.integral(x.linear, x.quadratic[b == k]) for k, x in enumerate(axes)]) for b in range(3)
        ]
        for a in range(3):
            rows[a][a] = rows[a][a] + mu * laplacian
            rows[a].append(-divergence[a].T)
        mass = _kron([x.integral(x.linear, x.linear) for x in axes])
        rows.append([*(-matrix for matrix in divergence), -compliance * mass])
        shape = tuple(axis.node.size for axis in axes)
        return cls(
            axes,
            sp.block_array(rows, format="csr"),
            poisson_ratio,
            [_face(axes, normal) for normal in range(3)],
            np.arange(3 * math.prod(shape)).reshape(3, *shape),
        )

    def solve(self, parity: tuple[int, int], source: FloatArray) -> Remainder:
        """Return the solution minus that of the half-space, under mirrored unit loads.

        `parity` holds the signs of a load's mirror images in x = 0 and in y = 0. `source` (m, 2) holds the
        positions of the loads [mm].
        """
        base, nodal = self._index[..., -1].ravel(), self._index.size
        known = self._known(parity)
        value = np.zeros((known.size, len(source)))
        load = np.zeros_like(value)
        value[base] = -self._displacement(self._base_nodes, source, parity)
        for side in self.faces[:2]:
            load[:nodal] -= side.interpolation.T @ self._forces(side, source, parity)
        free, fixed = np.flatnonzero(~known), np.flatnonzero(known)
        rows = self.matrix[free]
        solved = solve(rows[:, free].tocsc(), load[free] - rows[:, fixed] @ value[fixed])
        value[free] = solved.value
        return Remainder(parity, source, value[:nodal], (self.matrix @ value - load)[base], solved.residual)

    def influence(self, field: Remainder, position: FloatArray) -> FloatArray:
        """Return the normal displacement of the top at (n, 2) minus the half-space's, (n, m) [1/mm].

        The result follows from Betti's theorem for the fields of a load at the position p and of the load j.
        U and T are displacement and traction of the half-space, w is the finite-element solution, and t(w)
        its reaction: ``w_j(p) = -int_sides T_p (U_j + w_j) + int_base U_p (T_j + t(w_j))``. The result
        is symmetric and smooth in p, and the order of its error is twice that of w.
        """
        parity, (*sides, base) = field.parity, self.faces
        result = self._displacement(self._base_nodes, position, parity).T @ field.reaction
        result += self._displacement(base.point, position, parity).T @ self._forces(
            base, field.source, parity
        )
        for side in sides:
            whole = self._displacement(side.point, field.source, parity)
            whole += side.interpolation @ field.displacement
            result -= self._forces(side, position, parity).T @ whole
        return result

    def _known(self, parity: tuple[int, int]) -> BoolArray:
        """Return whether symmetry or the bonded base prescribes each unknown."""
        known = np.zeros(self.matrix.shape[0], dtype=bool)
        for k, sign in enumerate(parity):
            # on a symmetry plane, an even field has no normal and an odd field no tangential displacement
            still = [k] if sign > 0 else [c for c in range(3) if c != k]
            known[np.take(self._index[still], 0, axis=k + 1)] = True
        known[self._index[..., -1]] = True
        return known

    @property
    def _base_nodes(self) -> FloatArray:
        """Return the positions of the nodes of the base, (nodes, 3) [mm]."""
        x, y, z = (axis.node for axis in self.axes)
        return _points(x, y, z[-1:])

    def _displacement(self, point: FloatArray, source: FloatArray, parity: tuple[int, int]) -> FloatArray:
        """Return the half-space's displacement (3q, loads) at points (q, 3)."""
        return mirrored(partial(displacement, poisson_ratio=self.poisson_ratio), point, source, parity)

    def _forces(self, face: Face, source: FloatArray, parity: tuple[int, int]) -> FloatArray:
        """Return the half-space's tractions at the Gauss points of a face, times the weights, (3q, loads)."""
        field = partial(traction, normal=face.normal, poisson_ratio=self.poisson_ratio)
        return face.weight * mirrored(field, face.point, source, parity)


def _face(axes: Sequence[LineElements], normal: int) -> Face:
    """Return the face at the far end of axis `normal`."""
    points, weights, values = [], [], []
    for k, axis in enumerate(axes):
        last = sp.csr_array(([1.0], ([0], [axis.node.size - 1])))
        end = axis.node[-1:], np.ones(1), last
        point, weight, value = end if k == normal else (axis.point, axis.weight, axis.quadratic[0])
        points.append(point)
        weights.append(weight)
        values.append(value)
    weight = np.tile(np.einsum("i,j,k->ijk", *weights).ravel(), 3)[:, None]
    return Face(normal, _points(*points), weight, sp.block_diag([_kron(values)] * 3, format="csr"))


def _points(x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Return the points of a tensor product, (q, 3)."""
    return np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)


def _kron(factors: Sequence[Any]) -> Any:
    return reduce(partial(sp.kron, format="csr"), factors)
