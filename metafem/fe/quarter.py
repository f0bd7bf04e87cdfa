"""Influence between the sites of a block, from mixed elements on a quarter of it: Q2/Q1, E* = 1.

The solution is that of a point load on the half-space, in closed form, plus a smooth remainder.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial, reduce
from itertools import product
from typing import Any

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementLineP1, ElementLineP2, MeshLine

from metafem._validate import FloatArray
from metafem.fe.elements import solve
from metafem.progress import each
from metafem.surface import Block

Vector = tuple[FloatArray, FloatArray, FloatArray]

# Largest number of cells in a quarter; the factorisation of the 55,000 unknowns takes 2 GiB and a minute.
MOST_CELLS = 2000


def displacement(x: FloatArray, y: FloatArray, z: FloatArray, poisson_ratio: float) -> Vector:
    """Return the displacement per unit normal load [1/mm] at (x, y, z) from the load, with z >= 0.

    Boussinesq's solution: Johnson, Contact Mechanics, equation 3.18, doi:10.1017/CBO9781139171731.
    ``(R - z)/r^2`` is written as ``1/(R + z)`` to avoid cancellation near the axis.
    """
    # with E* = 1 the shear modulus is (1 - nu)/2
    scale = 1.0 / (2.0 * math.pi * (1.0 - poisson_ratio))
    R = np.sqrt(x**2 + y**2 + z**2)
    radial = scale * (z / R**3 - (1.0 - 2.0 * poisson_ratio) / (R * (R + z)))
    axial = scale * (z**2 / R**3 + 2.0 * (1.0 - poisson_ratio) / R)
    return radial * x, radial * y, axial


def traction(x: FloatArray, y: FloatArray, z: FloatArray, normal: int, poisson_ratio: float) -> Vector:
    """Return the traction per unit load [1/mm^2] at (x, y, z), on a plane whose normal is axis 0, 1 or 2.

    Johnson, equation 3.19 in Cartesian components, also written with ``1/(R + z)``. The traction does not
    depend on the modulus and is finite for nu = 1/2.
    """
    if normal == 1:
        across, along, down = traction(y, x, z, 0, poisson_ratio)
        return along, across, down
    R = np.sqrt(x**2 + y**2 + z**2)
    vertical = -1.5 / math.pi * z**2 / R**5
    if normal == 2:
        return vertical * x, vertical * y, vertical * z
    factor = 0.5 / math.pi * (1.0 - 2.0 * poisson_ratio)
    common = -1.5 / math.pi * z / R**5 + factor * (2.0 * R + z) / (R**3 * (R + z) ** 2)
    return factor * (z / R**3 - 1.0 / (R * (R + z))) + x**2 * common, x * y * common, vertical * x


def mirrored(
    field: Callable[[FloatArray, FloatArray, FloatArray], Vector],
    point: FloatArray,
    source: FloatArray,
    parity: tuple[int, int],
) -> FloatArray:
    """Return the field (3q, m) at points (q, 3) due to each of m loads (m, 2) and its mirror images.

    `parity` holds the signs of the images in the planes x = 0 and y = 0.
    """
    total = np.zeros((3 * len(point), len(source)))
    x, y, z = point.T[:, :, None]
    for mirror in product((1, -1), repeat=2):
        sign = math.prod(m for m, p in zip(mirror, parity, strict=True) if p < 0)
        position = source * mirror
        total += sign * np.concatenate(field(x - position[:, 0], y - position[:, 1], z))
    return total


class Line:
    """Quadratic (displacement) and linear (pressure) elements on one line of ascending vertices."""

    def __init__(self, line: FloatArray) -> None:
        # five Gauss points; the matrices need 3, the tractions, which are not polynomials, need more
        self.basis = Basis(MeshLine(line), ElementLineP2(), intorder=9)
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


# The far face along an axis: the axis, its Gauss points (q, 3), their weights (3q, 1), and the interpolation
# from the nodes, (3q, nodal values).
Face = tuple[int, FloatArray, FloatArray, Any]

# Solution of the block minus that of the half-space, for each of m mirrored loads: their parity, their
# positions (m, 2), the displacements (3 nodes, m) [1/mm], and the nodal forces of the base.
Remainder = tuple[tuple[int, int], FloatArray, FloatArray, FloatArray]


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
            load[:nodal] -= side[3].T @ self._forces(side, source, parity)
        fixed = [self._base]
        for k, sign in enumerate(parity):
            # on a symmetry plane, an even field has no normal and an odd field no tangential displacement
            still = [k] if sign > 0 else [c for c in range(3) if c != k]
            fixed.append(np.take(self._index[still], np.argmin(self.axes[k].node), axis=k + 1).ravel())
        value, _ = solve(self.matrix, np.concatenate(fixed), value, load)
        reaction = (self.matrix @ value - load)[self._base]
        return parity, source, value[:nodal], reaction

    def influence(self, field: Remainder, position: FloatArray) -> FloatArray:
        """Return the normal displacement of the top at (n, 2) minus the half-space's, (n, m) [1/mm].

        The result follows from Betti's theorem for the fields of a load at the position p and of the load j.
        U and T are displacement and traction of the half-space, w is the finite-element solution, and t(w)
        its reaction: ``w_j(p) = -int_sides T_p (U_j + w_j) + int_base U_p (T_j + t(w_j))``. The result
        is symmetric and smooth in p, and the order of its error is twice that of w.
        """
        (parity, source, inner, reaction), (*sides, base) = field, self.faces
        result = self._displacement(self._base_node, position, parity).T @ reaction
        result += self._displacement(base[1], position, parity).T @ self._forces(base, source, parity)
        for side in sides:
            _, point, _, interpolation = side
            whole = self._displacement(point, source, parity) + interpolation @ inner
            result -= self._forces(side, position, parity).T @ whole
        return result

    def _displacement(self, point: FloatArray, source: FloatArray, parity: tuple[int, int]) -> FloatArray:
        """Return the half-space's displacement (3q, loads) at points (q, 3)."""
        return mirrored(partial(displacement, poisson_ratio=self.poisson_ratio), point, source, parity)

    def _forces(self, face: Face, source: FloatArray, parity: tuple[int, int]) -> FloatArray:
        """Return the half-space's tractions at the Gauss points of a face, times the weights, (3q, loads)."""
        normal, point, weight, _ = face
        field = partial(traction, normal=normal, poisson_ratio=self.poisson_ratio)
        return weight * mirrored(field, point, source, parity)

    def _face(self, normal: int) -> Face:
        """Return the face at the far end of axis `normal`."""
        parts = [(axis.point, axis.weight, axis.quadratic[0]) for axis in self.axes]
        node = self.axes[normal].node
        far = node.max(keepdims=True)
        parts[normal] = far, np.ones(1), sp.csr_array([(node == far).astype(float)])
        points, weights, values = zip(*parts, strict=True)
        weight = np.tile(np.einsum("i,j,k->ijk", *weights).ravel(), 3)[:, None]
        return normal, _points(*points), weight, sp.block_diag([_kron(values)] * 3, format="csr")


def _points(x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Return the points of a tensor product, (q, 3)."""
    return np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)


def _kron(factors: Sequence[Any]) -> Any:
    return reduce(partial(sp.kron, format="csr"), factors)


def site_influence(
    block: Block, poisson_ratio: float, position: FloatArray, cell: float, edge_cell: float
) -> tuple[FloatArray, float, float]:
    """Return the influence between sites (n, 2) [mm] and its errors; see `Block3D.solution`."""
    lines, stretch = quarter_lines(block, position, cell, edge_cell)
    coarser = 1.6 * stretch
    fewer, _ = quarter_lines(block, position, coarser * cell, coarser * edge_cell)
    fine, coarse = (
        _remainder(block, Quarter(mesh, poisson_ratio), position) for mesh in each("mesh", (lines, fewer))
    )
    value = fine[0].copy()
    dx, dy = (position[:, None] - position).transpose(2, 0, 1)
    r = np.hypot(dx, dy)
    np.fill_diagonal(r, math.inf)
    point = 1.0 / (math.pi * r)
    fine[0] = 0.5 * (value + value.T)
    fine += np.stack([point, -point * dx / r**2, -point * dy / r**2, point / r**2])
    return fine, float(np.abs(value - value.T).max()), float(np.abs(value - coarse[0]).max())


def quarter_lines(
    block: Block, position: FloatArray, cell: float, edge_cell: float
) -> tuple[list[FloatArray], float]:
    """Return the vertices of a mesh for loads at `position`, (n, 2) [mm], and the factor on its cell sizes.

    The vertices run along x and y from the symmetry planes to the sides, and along z from the top to the
    base. `cell` is the size of the largest cells near the loads and `edge_cell` that of the last cells at the
    base and the sides, in units of the thickness. If a wide and thin block needs more than `MOST_CELLS`, both
    are enlarged in steps of a tenth.
    """
    length = np.array([0.5 * block.width, 0.5 * block.length, block.thickness])
    reach = np.append(np.abs(position).max(axis=0), 0.0) + block.thickness
    # cells of equal size up to `reach` alone: a thin block would have millions until they are enlarged
    fewest = np.prod(np.minimum(length, reach) / (block.thickness * cell))
    stretch = max(1.0, float(fewest / MOST_CELLS) ** (1.0 / 3.0))
    while True:
        sizes = stretch * block.thickness * np.array([cell, edge_cell])
        lines = [graded_line(*span, *sizes) for span in zip(length, reach, strict=True)]
        if math.prod(len(line) - 1 for line in lines) <= MOST_CELLS:
            return lines, stretch
        stretch *= 1.1


def graded_line(length: float, reach: float, cell: float, edge_cell: float) -> FloatArray:
    """Return the ascending ends of cells from 0 to `length`, of at most the size `cell` up to `reach`.

    From `length` inwards the sizes grow by a factor of e, beginning with at most `edge_cell`. Beyond `reach`
    they grow by a third of the distance: on 90 mm the influence is then 9e-6 /mm off that of the layer. With
    0.4 it is 1.2e-5 /mm off; gentler grading only adds cells.
    """
    distance, size = [0.0], min(edge_cell, cell)
    while distance[-1] < length:
        distance.append(distance[-1] + size)
        beyond = max(length - distance[-1] - reach, 0.0)
        size = min(math.e * size, cell + 0.33 * beyond)
    return length * (1.0 - np.array(distance[::-1]) / distance[-1])


def _remainder(block: Block, quarter: Quarter, position: FloatArray) -> FloatArray:
    """Return value, gradient and Laplacian of w between sites, (4, n, n).

    For each of the four parities, the load and its three mirror images with the signs of the parity are
    applied together. A single load is a quarter of the sum over the parities.
    """
    # one load for sites that are mirror images up to rounding
    folded = np.abs(position)
    _, first, orbit = np.unique(
        np.round(folded / block.thickness, 12), axis=0, return_index=True, return_inverse=True
    )
    site, side = folded[first], np.where(position < 0.0, -1.0, 1.0)
    # the field is analytic within the distance to the nearest face; with 0.02 of it as the step of the finite
    # differences, the Laplacian has relative errors of 2e-5 by truncation and of 1e-11 by rounding
    step = 0.02 * np.minimum(0.5 * np.array([block.width, block.length]) - site, block.thickness).min(axis=1)
    around = step[:, None] * np.array([[[0, 0]], [[1, 0]], [[-1, 0]], [[0, 1]], [[0, -1]]])
    # 256 positions at once; the fields on the faces of the largest mesh then take 100 MB
    places = np.array_split((site + around).reshape(-1, 2), -(-5 * len(site) // 256))
    h, total = step[:, None], np.zeros((4, len(position), len(position)))
    for parity in each("load case", [(1, 1), (1, -1), (-1, 1), (-1, -1)]):
        field = quarter.solve(parity, site)
        values = np.concatenate([quarter.influence(field, part) for part in places])
        w, east, west, north, south = values.reshape(5, len(site), -1)
        slopes = (east - west) / (2.0 * h), (north - south) / (2.0 * h)
        result = np.stack([w, *slopes, (east + west + north + south - 4.0 * w) / h**2])
        sign = np.prod(np.where(np.array(parity) < 0, side, 1.0), axis=1)
        total += 0.25 * result[:, orbit[:, None], orbit] * sign[:, None] * sign
    total[1:3] *= side.T[:, :, None]
    return total
