"""Axisymmetric small-strain elasticity: displacements of polynomial degree p, pressures of degree p - 1.

The sparse symmetric systems of this body, and of the block, are solved by a fast factorisation with a check,
and by full pivoting if it fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix, diags_array
from scipy.sparse.linalg import splu
from skfem import ElementQuadP, MeshQuad
from skfem.assembly.dofs import Dofs

from metafem._validate import FloatArray, IntArray
from metafem.errors import NotConverged
from metafem.fe.geometry import Flat

# Number of Gauss points per direction minus the polynomial degree. One point is needed for the polynomials;
# the others resolve the analytic maps and 1/r.
EXTRA_POINTS = 3

# Largest scaled residual of an accurate solution after refinement. A good factorisation reaches about 1e-15;
# one with a small pivot ends orders of magnitude higher.
RESIDUAL = 1e-10


def solve(
    matrix: Any, fixed: IntArray, value: FloatArray, load: FloatArray | None = None, threshold: float = 0.0
) -> tuple[FloatArray, float]:
    """Return the solution of a sparse symmetric system for all columns of `load`, (n, k), and its residual.

    The unknowns `fixed` keep their `value`, (n, k); the load of the others is 0 by default.

    Rows and columns are scaled by the square roots of the diagonal entries, or of their largest entries where
    the diagonal is zero. After elimination of the bubbles, the displacement and pressure blocks are definite
    with opposite signs. Such a quasi-definite matrix needs no pivoting in any order (Vanderbei, SIAM J.
    Optim. 5, 100 (1995), doi:10.1137/0805005). With a `threshold`, a diagonal pivot is used only if it
    exceeds this fraction of the largest entry of its column. If the residual is not small, the system is
    factorised again with full partial pivoting. If it stays large, NotConverged is raised.
    """
    free, result = np.setdiff1d(np.arange(len(value)), fixed), np.zeros(value.shape)
    result[fixed] = value[fixed]
    rows = matrix[free]
    right = -(rows @ result) if load is None else load[free] - rows @ result
    inner = rows[:, free]
    size = np.abs(inner.diagonal())
    size = np.where(size > 0.0, size, np.abs(inner).max(axis=0).toarray().ravel())
    scale = diags_array(1.0 / np.sqrt(np.where(size > 0.0, size, 1.0)))
    scaled, target = (scale @ inner @ scale).tocsc(), scale @ right
    unit = np.maximum(np.abs(target).max(axis=0), np.finfo(float).tiny)
    stable: dict[str, Any] = {"diag_pivot_thresh": threshold, "options": {"SymmetricMode": True}}
    residual = math.inf
    for options in ({"permc_spec": "MMD_AT_PLUS_A", **stable}, {}):
        try:
            factors = splu(scaled, **options)
        except RuntimeError:  # a pivot of exactly zero
            continue
        solution, rest = np.zeros_like(target), target
        for _ in range(4):  # each gains as many digits as the factors have; accurate factors need two
            solution += factors.solve(rest)
            rest = target - scaled @ solution
            residual = float((np.abs(rest).max(axis=0) / unit).max())
            if residual <= 1e-14:  # about rounding
                break
        if residual <= RESIDUAL:
            result[free] = scale @ solution
            return result, residual
    raise NotConverged(f"the linear system keeps a residual of {residual:.1e} with full pivoting")


def assembled(number: IntArray, block: FloatArray, size: int) -> csc_matrix:
    """Return the sum of element matrices (elements, local, local) for unknowns (elements, local)."""
    width = number.shape[1]
    rows, columns = np.repeat(number, width, axis=1).ravel(), np.tile(number, (1, width)).ravel()
    return coo_matrix((block.ravel(), (rows, columns)), shape=(size, size)).tocsc()


class Polynomials:
    """Numbering and shape functions of the scalar polynomials of one degree on a mesh."""

    def __init__(self, mesh: MeshQuad, degree: int) -> None:
        self.element = ElementQuadP(degree)
        self.dofs = Dofs(mesh, self.element)
        self.local = (degree + 1) ** 2
        # bubbles are numbered last, globally and in each element
        self.shared = self.local - (degree - 1) ** 2
        self.skeleton = int(self.dofs.N) - (self.local - self.shared) * mesh.nelements

    def shapes(self, point: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return shape functions (local, n) and derivatives (local, 2, n) at reference points (2, n)."""
        value, slope = zip(*(self.element.lbasis(point, i) for i in range(self.local)), strict=True)
        return np.array(value), np.array(slope)


class Body:
    """An axisymmetric elastic body with E* = 1, on a mesh of its reference plane.

    ``div(2 mu dev eps - p I) = 0``, ``div u + p/K = 0`` with ``mu = (1 - nu)/2`` and ``1/K = 3 (1 - 2 nu)/(1
    - nu^2)``. This mixed form holds for every nu in [0, 0.5], including incompressible bodies. The bubble
    functions of displacement and pressure are eliminated element by element; the remaining unknowns are the
    skeleton, in the order radial, downward, pressure. The degree is at least 4.
    """

    def __init__(self, mesh: MeshQuad, geometry: Flat, degree: int, poisson_ratio: float) -> None:
        self.mesh, self.geometry, self.degree = mesh, geometry, degree
        self.shear_modulus = 0.5 * (1.0 - poisson_ratio)
        self.compliance = 3.0 * (1.0 - 2.0 * poisson_ratio) / (1.0 - poisson_ratio**2)
        self.displacement, self.pressure = Polynomials(mesh, degree), Polynomials(mesh, degree - 1)
        u, p = self.displacement, self.pressure
        # local numbers of the skeleton and of the bubbles, ordered radial, downward, pressure
        starts = ((0, u), (u.local, u), (2 * u.local, p))
        self._kept = np.concatenate([start + np.arange(field.shared) for start, field in starts])
        self._inner = np.setdiff1d(np.arange(2 * u.local + p.local), self._kept)
        # global numbers of the skeleton unknowns of each element, (elements, local)
        mine, other = u.dofs.element_dofs[: u.shared], p.dofs.element_dofs[: p.shared]
        self.numbering = np.vstack([mine, mine + u.skeleton, other + 2 * u.skeleton]).T

    @cached_property
    def _condensed(self) -> tuple[csc_matrix, FloatArray]:
        """Matrix of the skeleton, and for each element the matrix that gives bubbles from the skeleton."""
        kept, inner, count = self._kept, self._inner, self.mesh.nelements
        points = (self.degree + EXTRA_POINTS) ** 2
        # the largest array of a group of elements takes 2 MiB, so that a few such arrays fit into the cache
        groups = -(-count * points * self.displacement.local // 250_000)
        schur, responses = [], []
        for elements in np.array_split(np.arange(count), min(groups, count)):
            block = self._element_matrices(elements)
            coupling = block[:, inner[:, None], kept]
            response = -np.linalg.solve(block[:, inner[:, None], inner], coupling)
            schur.append(block[:, kept[:, None], kept] + np.matmul(coupling.transpose(0, 2, 1), response))
            responses.append(response)
        size = 2 * self.displacement.skeleton + self.pressure.skeleton
        return assembled(self.numbering, np.concatenate(schur), size), np.concatenate(responses)

    @property
    def matrix(self) -> csc_matrix:
        """Matrix of the skeleton, after elimination of the bubbles."""
        return self._condensed[0]

    def _element_matrices(self, elements: IntArray) -> FloatArray:
        """Return the matrices [[K, G'], [G, -C]] of some elements."""
        along_r, along_z, hoop, other, weight = self.shapes_at_points(elements)
        dilation, mu = along_r + hoop, self.shear_modulus

        def product(left: FloatArray, right: FloatArray) -> FloatArray:
            return np.asarray(np.matmul(left.transpose(0, 2, 1), right * weight[..., None]))

        rr, zz = product(along_r, along_r), product(along_z, along_z)
        radial = 2.0 * (rr + product(hoop, hoop)) + zz - 2.0 / 3.0 * product(dilation, dilation)
        mixed = product(along_z, along_r) - 2.0 / 3.0 * product(dilation, along_z)
        down = 4.0 / 3.0 * zz + rr
        at_points = np.broadcast_to(other, (len(elements), *other.shape))
        one, two = -product(at_points, dilation), -product(at_points, along_z)
        return np.block(
            [
                [mu * radial, mu * mixed, one.transpose(0, 2, 1)],
                [mu * mixed.transpose(0, 2, 1), mu * down, two.transpose(0, 2, 1)],
                [one, two, -self.compliance * product(at_points, at_points)],
            ]
        )

    def shapes_at_points(self, elements: IntArray) -> tuple[FloatArray, ...]:
        """Return shape functions and weights at the Gauss points of elements.

        For the displacements d/dr, d/dz and the shape functions over r (elements, points, local), for the
        pressures the shape functions (points, local), and the weights (elements, points), which include r.
        """
        x, w = np.polynomial.legendre.leggauss(self.degree + EXTRA_POINTS)
        x, w = 0.5 * (x + 1.0), 0.5 * w
        point, weight = np.array(np.meshgrid(x, x)).reshape(2, -1), np.outer(w, w).ravel()
        value, slope = self.displacement.shapes(point)
        other, _ = self.pressure.shapes(point)
        plane, inverse, determinant = self._mapped(point, elements)
        along_r, along_z = np.einsum("jieq,bjq->ieqb", inverse, slope, optimize=True)
        radius = self.geometry.point(plane)[0]
        return along_r, along_z, value.T / radius[..., None], other.T, weight * np.abs(determinant) * radius

    def _mapped(self, point: FloatArray, elements: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return points of the plane, and inverse and determinant of d(r, z)/d(reference square)."""
        straight = self.mesh.mapping()
        plane = straight.F(point, elements)
        (a, b), (c, d) = np.einsum(
            "ijeq,jkeq->ikeq", self.geometry.jacobian(plane), straight.DF(point, elements), optimize=True
        )
        determinant = a * d - b * c
        return plane, np.array([[d, -b], [-c, a]]) / determinant, determinant

    def nodes(self, name: str) -> IntArray:
        """Return the corners of the elements on a named boundary."""
        return np.unique(self.mesh.facets[:, self.mesh.boundaries[name]])

    def boundary(self, *names: str) -> IntArray:
        """Return the numbers of one displacement component on named boundaries."""
        facets = np.concatenate([self.mesh.boundaries[name] for name in names])
        return np.asarray(self.displacement.dofs.get_facet_dofs(facets).flatten())

    def contact_values(self, value: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Return the coefficients (n,) of polynomials that approximate `value`(r) along the contact.

        They are exact at the nodes and least-squares fits between the nodes.
        """
        x, _ = np.polynomial.legendre.leggauss(self.degree + EXTRA_POINTS)
        first, last = self.mesh.p[:, self.mesh.facets[:, self.mesh.boundaries["contact"]]].swapaxes(0, 1)
        plane = (first[..., None] + (last - first)[..., None] * 0.5 * (x + 1.0)).reshape(2, -1)
        element, point = self.located("contact", plane)
        rows = np.zeros((plane.shape[1], int(self.displacement.dofs.N)))
        shapes, _ = self.displacement.shapes(point)
        rows[np.arange(len(rows)), self.displacement.dofs.element_dofs[:, element]] = shapes
        nodes, result = self.nodes("contact"), np.zeros(rows.shape[1])
        result[nodes] = value(self.geometry.point(self.mesh.p[:, nodes])[0])
        between = np.setdiff1d(self.boundary("contact"), nodes)
        rest = value(self.geometry.point(plane)[0]) - rows @ result
        result[between] = np.linalg.lstsq(rows[:, between], rest)[0]
        return result[: self.displacement.skeleton]

    def located(self, name: str, plane: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the elements of points (2, n) on a named boundary, and the points' reference coordinates."""
        facets = self.mesh.boundaries[name]
        ends = self.mesh.p[:, self.mesh.facets[:, facets]]
        along = int(np.argmax(np.ptp(ends.reshape(2, -1), axis=1)))
        start = ends[along].min(axis=0)
        order = np.argsort(start)
        which = np.searchsorted(start[order], plane[along], side="right") - 1
        element = self.mesh.f2t[0, facets[order[np.maximum(which, 0)]]]
        # elements are parallelograms in the plane, so one Newton step from the middle is exact
        straight, middle = self.mesh.mapping(), np.full((2, len(element), 1), 0.5)
        step = plane - straight.F(middle, element)[..., 0]
        slope = straight.invDF(middle, element)[..., 0]
        return element, np.clip(0.5 + np.einsum("ijn,jn->in", slope, step), 0.0, 1.0)

    def fields_at(
        self, skeleton: FloatArray, element: IntArray, point: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return displacement (2, n), its gradient (2, 2, n) in (r, z), and pressure (n,) inside elements.

        `skeleton` is one column of a solution, `point` (2, n) are coordinates in the reference square.
        """
        local, shared = self.displacement.local, skeleton[self.numbering[element]]
        full = np.empty((len(element), len(self._kept) + len(self._inner)))
        full[:, self._kept] = shared
        full[:, self._inner] = np.einsum("nij,nj->ni", self._condensed[1][element], shared)
        u = full[:, : 2 * local].reshape(-1, 2, local)
        value, slope = self.displacement.shapes(point)
        other, _ = self.pressure.shapes(point)
        inverse = self._mapped(point[:, :, None], element)[1][..., 0]
        return (
            np.einsum("ncb,bn->cn", u, value),
            np.einsum("ncb,bkn,kjn->cjn", u, slope, inverse, optimize=True),
            np.einsum("nb,bn->n", full[:, 2 * local :], other),
        )
