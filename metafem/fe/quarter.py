"""Mixed elements for a quarter of the block: Q2 displacements, Q1 pressure, E* = 1."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial, reduce
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementLineP1, ElementLineP2, MeshLine

from metafem._validate import FloatArray
from metafem.fe.linear_solve import solve
from metafem.fe.point_load import displacement, mirrored, traction

# Number of Gauss points in a cell. The matrices need 3; the tractions, which are not polynomials, need more.
POINTS = 5


class Line:
    """Quadratic (displacement) and linear (pressure) elements on one line of ascending vertices."""

    def __init__(self, line: FloatArray) -> None:
        self.basis = Basis(MeshLine(line), ElementLineP2(), intorder=2 * POINTS - 1)
        self.node = self.basis.doflocs[0]
        self.point = np.asarray(self.basis.global_coordinates())[0].ravel()
        self.weight = self.basis.dx.ravel()
        # values and derivatives of the quadratic functions at the Gauss points, and values of the linear ones
        self.quadratic = self._at_points(self.basis), self._at_points(self.basis, slope=True)
        self.linear = self._at_points(self.basis.with_element(ElementLineP1()))

    def _at_points(self, basis: Basis, *, slope: bool = False) -> Any:
        value = np.array([each.grad[0] if slope else each for (each,) in basis.basis])
        row = np.broadcast_to(np.arange(len(self.point)).reshape(value.shape[1:]), value.shape)
        column = np.broadcast_to(basis.element_dofs[..., None], value.shape)
        return sp.csr_array((value.ravel(), (row.ravel(), column.ravel())))

    def integral(self, left: Any, right: Any) -> Any:
        """Return the integrals of products of two sets of functions, from their values at Gauss points."""
        return left.T @ sp.diags_array(self.weight) @ right


class Face(NamedTuple):
    """Gauss points of the far face along an axis: positions (q, 3), weights, interpolation from nodes."""

    normal: int
    point: FloatArray
    weight: FloatArray  # (3q, 1)
    interpolation: Any  # (3q, nodal values)


class Remainder(NamedTuple):
    """Solution of the block minus that of the half-space, for each of m mirrored loads."""

    parity: tuple[int, int]
    source: FloatArray
    displacement: FloatArray  # (3 nodes, m) [1/mm]
    reaction: FloatArray  # nodal forces of the base, (3 nodes of the base, m) [1]


class Quarter:
    """The quarter x, y >= 0 of the block on the tensor product of three lines; z points down from the top.

    The form is ``2 mu dev(eps) : eps(v) - p div v - q div u - p q / K``, with 1/K = 0 for nu = 1/2. The mesh
    and the Q2 and Q1 hexahedra are tensor products, so the matrices are Kronecker products of line matrices.
    They equal the assembled matrices and are computed a thousand times as fast.
    """

    def __init__(self, lines: Sequence[FloatArray], poisson_ratio: float) -> None:
        self.axes = axes = [Line(line) for line in lines]
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
        self.matrix = sp.block_array(rows, format="csr")
        self.faces = [self._face(normal) for normal in range(3)]  # the two sides and the base
        self.poisson_ratio = poisson_ratio
        # number of the displacement at a node, (component, x, y, z)
        shape = [axis.node.size for axis in axes]
        self._index = np.arange(3 * math.prod(shape)).reshape(3, *shape)
        self._base = self._index[..., np.argmax(axes[2].node)].ravel()
        x, y, z = (axis.node for axis in axes)
        self._base_node = _points(x, y, z.max(keepdims=True))

    def solve(self, parity: tuple[int, int], source: FloatArray) -> Remainder:
        """Return the solution minus that of the half-space, under mirrored unit loads.

        `parity` holds the signs of a load's mirror images in x = 0 and in y = 0. `source` (m, 2) holds the
        positions of the loads [mm].
        """
        nodal = self._index.size
        value = np.zeros((self.matrix.shape[0], len(source)))
        load = np.zeros_like(value)
        value[self._base] = -self._displacement(self._base_node, source, parity)
        for side in self.faces[:2]:
            load[:nodal] -= side.interpolation.T @ self._forces(side, source, parity)
        fixed = [self._base]
        for k, sign in enumerate(parity):
            # on a symmetry plane, an even field has no normal and an odd field no tangential displacement
            still = [k] if sign > 0 else [c for c in range(3) if c != k]
            fixed.append(np.take(self._index[still], np.argmin(self.axes[k].node), axis=k + 1).ravel())
        value, _ = solve(self.matrix, np.concatenate(fixed), value, load)
        reaction = (self.matrix @ value - load)[self._base]
        return Remainder(parity, source, value[:nodal], reaction)

    def influence(self, field: Remainder, position: FloatArray) -> FloatArray:
        """Return the normal displacement of the top at (n, 2) minus the half-space's, (n, m) [1/mm].

        The result follows from Betti's theorem for the fields of a load at the position p and of the load j.
        U and T are displacement and traction of the half-space, w is the finite-element solution, and t(w)
        its reaction: ``w_j(p) = -int_sides T_p (U_j + w_j) + int_base U_p (T_j + t(w_j))``. The result
        is symmetric and smooth in p, and the order of its error is twice that of w.
        """
        parity, (*sides, base) = field.parity, self.faces
        result = self._displacement(self._base_node, position, parity).T @ field.reaction
        result += self._displacement(base.point, position, parity).T @ self._forces(
            base, field.source, parity
        )
        for side in sides:
            whole = self._displacement(side.point, field.source, parity)
            whole += side.interpolation @ field.displacement
            result -= self._forces(side, position, parity).T @ whole
        return result

    def _displacement(self, point: FloatArray, source: FloatArray, parity: tuple[int, int]) -> FloatArray:
        """Return the half-space's displacement (3q, loads) at points (q, 3)."""
        return mirrored(partial(displacement, poisson_ratio=self.poisson_ratio), point, source, parity)

    def _forces(self, face: Face, source: FloatArray, parity: tuple[int, int]) -> FloatArray:
        """Return the half-space's tractions at the Gauss points of a face, times the weights, (3q, loads)."""
        field = partial(traction, normal=face.normal, poisson_ratio=self.poisson_ratio)
        return face.weight * mirrored(field, face.point, source, parity)

    def _face(self, normal: int) -> Face:
        """Return the face at the far end of axis `normal`."""
        parts = [(axis.point, axis.weight, axis.quadratic[0]) for axis in self.axes]
        node = self.axes[normal].node
        far = node.max(keepdims=True)
        parts[normal] = far, np.ones(1), sp.csr_array([(node == far).astype(float)])
        points, weights, values = zip(*parts, strict=True)
        weight = np.tile(np.einsum("i,j,k->ijk", *weights).ravel(), 3)[:, None]
        return Face(normal, _points(*points), weight, sp.block_diag([_kron(values)] * 3, format="csr"))


def _points(x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Return the points of a tensor product, (q, 3)."""
    return np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)


def _kron(factors: Sequence[Any]) -> Any:
    return reduce(partial(sp.kron, format="csr"), factors)
