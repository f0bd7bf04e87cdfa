"""Axisymmetric small-strain elasticity: displacements of polynomial degree p, pressures of degree p - 1."""

from __future__ import annotations

import logging
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from skfem import ElementQuadP, MeshQuad
from skfem.assembly.dofs import Dofs

from metafem._validate import FloatArray, IntArray
from metafem.fe.axisymmetric.geometry import Flat
from metafem.fe.linear_solve import Solved, solve

# Number of Gauss points per direction minus the polynomial degree. One point is needed for the polynomials;
# the others resolve the analytic maps and 1/r.
EXTRA_POINTS = 3

# Length of the largest array of a group of elements: 2 MiB, so that a few such arrays fit into the cache.
GROUP = 250_000


def hierarchical(kind: Any, degree: int) -> Any:
    """Return a hierarchical element; suppress scikit-fem's logged advice to use nodal elements."""
    logger = logging.getLogger(kind.__module__)
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        return kind(degree)
    finally:
        logger.setLevel(level)


def assembled(number: IntArray, block: FloatArray, size: int) -> csc_matrix:
    """Return the sum of element matrices (elements, local, local) for unknowns (elements, local)."""
    width = number.shape[1]
    rows, columns = np.repeat(number, width, axis=1).ravel(), np.tile(number, (1, width)).ravel()
    return coo_matrix((block.ravel(), (rows, columns)), shape=(size, size)).tocsc()


class Polynomials:
    """Numbering and shape functions of the scalar polynomials of one degree on a mesh."""

    def __init__(self, mesh: MeshQuad, degree: int) -> None:
        self.element = hierarchical(ElementQuadP, degree)
        self.dofs = Dofs(mesh, self.element)
        self.local = (degree + 1) ** 2
        self.inner = (degree - 1) ** 2
        # Bubbles are numbered last, globally and in each element.
        self.skeleton = int(self.dofs.N) - self.inner * mesh.nelements

    def shapes(self, point: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return shape functions (local, n) and derivatives (local, 2, n) at reference points (2, n)."""
        pairs = [self.element.lbasis(point, i) for i in range(self.local)]
        return np.array([value for value, _ in pairs]), np.array([slope for _, slope in pairs])


class Body:
    """An axisymmetric elastic body with E* = 1, on a mesh of its reference plane.

    ``div(2 mu dev eps - p I) = 0``, ``div u + p/K = 0`` with ``mu = (1 - nu)/2`` and ``1/K = 3 (1 - 2 nu)/(1
    - nu^2)``. This mixed form holds for every nu in [0, 0.5], including incompressible bodies. The bubble
    functions of displacement and pressure are eliminated element by element; the remaining unknowns are the
    skeleton. The degree is at least 4.
    """

    def __init__(self, mesh: MeshQuad, geometry: Flat, degree: int, poisson_ratio: float) -> None:
        self.mesh, self.geometry, self.degree = mesh, geometry, degree
        self.poisson_ratio = poisson_ratio
        self.displacement, self.pressure = Polynomials(mesh, degree), Polynomials(mesh, degree - 1)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus mu over E* [-]."""
        return 0.5 * (1.0 - self.poisson_ratio)

    @property
    def compliance(self) -> float:
        """Compliance E*/K [-]."""
        return 3.0 * (1.0 - 2.0 * self.poisson_ratio) / (1.0 - self.poisson_ratio**2)

    @cached_property
    def _local(self) -> tuple[IntArray, IntArray]:
        """Local numbers of the skeleton and of the bubbles, ordered radial, downward, pressure."""
        u, p = self.displacement, self.pressure
        kept, inner = [], []
        for start, field in ((0, u), (u.local, u), (2 * u.local, p)):
            shared = field.local - field.inner
            kept.append(start + np.arange(shared))
            inner.append(start + np.arange(shared, field.local))
        return np.concatenate(kept), np.concatenate(inner)

    @cached_property
    def numbering(self) -> IntArray:
        """Global numbers of the skeleton unknowns of each element, (elements, local)."""
        u, p = self.displacement, self.pressure
        mine = u.dofs.element_dofs[: u.local - u.inner]
        other = p.dofs.element_dofs[: p.local - p.inner]
        return np.vstack([mine, mine + u.skeleton, other + 2 * u.skeleton]).T

    @cached_property
    def _condensed(self) -> tuple[csc_matrix, FloatArray]:
        """Matrix of the skeleton, and for each element the matrix that gives bubbles from the skeleton."""
        kept, inner = self._local
        count = self.mesh.nelements
        points = (self.degree + EXTRA_POINTS) ** 2
        step = max(1, GROUP // (points * self.displacement.local))
        schur, responses = [], []
        for start in range(0, count, step):
            block = self._element_matrices(np.arange(start, min(start + step, count)))
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
        dilation = along_r + hoop
        mu, weighted = self.shear_modulus, weight[..., None]

        def product(left: FloatArray, right: FloatArray) -> FloatArray:
            return np.asarray(np.matmul(left.transpose(0, 2, 1), right * weighted))

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
        straight = self.mesh.mapping()
        plane = straight.F(point, elements)
        total = np.einsum(
            "ijeq,jkeq->ikeq", self.geometry.jacobian(plane), straight.DF(point, elements), optimize=True
        )
        (a, b), (c, d) = total
        determinant = a * d - b * c
        radius, inverse = self.geometry.point(plane)[0], np.array([[d, -b], [-c, a]]) / determinant
        along_r, along_z = np.einsum("jieq,bjq->ieqb", inverse, slope, optimize=True)
        return along_r, along_z, value.T / radius[..., None], other.T, weight * np.abs(determinant) * radius

    def boundary(self, *names: str) -> IntArray:
        """Return the numbers of one displacement component on named boundaries."""
        facets = np.unique(np.concatenate([self.mesh.boundaries[name] for name in names]))
        corners = np.unique(self.mesh.facets[:, facets])
        dofs = self.displacement.dofs
        return np.concatenate([dofs.nodal_dofs[:, corners].ravel(), dofs.facet_dofs[:, facets].ravel()])

    def solve(self, fixed: IntArray, value: FloatArray) -> Solved:
        """Return the solution with the `fixed` skeleton unknowns set to `value`, (n, k), and no other load.

        The skeleton holds the coefficients that elements share, in the order radial, downward, pressure.
        """
        free = np.setdiff1d(np.arange(self.matrix.shape[0]), fixed)
        rows = self.matrix[free]
        skeleton = np.zeros((self.matrix.shape[0], value.shape[1]))
        skeleton[fixed] = value[fixed]
        solved = solve(rows[:, free].tocsc(), -(rows @ skeleton))
        skeleton[free] = solved.value
        return replace(solved, value=skeleton)

    def located(self, name: str, plane: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the elements of points (2, n) on a named boundary, and the points' reference coordinates."""
        facets = self.mesh.boundaries[name]
        ends = self.mesh.p[:, self.mesh.facets[:, facets]]
        along = int(np.argmax(np.ptp(ends.reshape(2, -1), axis=1)))
        start = ends[along].min(axis=0)
        order = np.argsort(start)
        which = np.searchsorted(start[order], plane[along], side="right") - 1
        element = self.mesh.f2t[0, facets[order[np.maximum(which, 0)]]]
        # Elements are parallelograms in the plane, so one Newton step from the middle is exact.
        straight, middle = self.mesh.mapping(), np.full((2, len(element), 1), 0.5)
        step = plane - straight.F(middle, element)[..., 0]
        slope = straight.invDF(middle, element)[..., 0]
        return element, np.clip(0.5 + np.einsum("ijn,jn->in", slope, step), 0.0, 1.0)

    def fields_at(
        self, skeleton: FloatArray, element: IntArray, point: FloatArray, *, by_plane: bool = False
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return displacement (2, n), its gradient (2, 2, n) in (r, z), and pressure (n,) inside elements.

        `skeleton` is one column of a solution, `point` (2, n) are coordinates in the reference square. With
        `by_plane` the gradient is in the plane's coordinates, which is finite where the Jacobian vanishes.
        """
        local = self.displacement.local
        full = self._coefficients(skeleton, element)
        u = full[:, : 2 * local].reshape(-1, 2, local)
        value, slope = self.displacement.shapes(point)
        other, _ = self.pressure.shapes(point)
        straight = self.mesh.mapping()
        total = straight.DF(point[:, :, None], element)[..., 0]
        if not by_plane:
            plane = straight.F(point[:, :, None], element)[..., 0]
            total = np.einsum("ijn,jkn->ikn", self.geometry.jacobian(plane), total)
        (a, b), (c, d) = total
        inverse = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
        return (
            np.einsum("ncb,bn->cn", u, value),
            np.einsum("ncb,bkn,kjn->cjn", u, slope, inverse, optimize=True),
            np.einsum("nb,bn->n", full[:, 2 * local :], other),
        )

    def _coefficients(self, skeleton: FloatArray, element: IntArray) -> FloatArray:
        """Return all coefficients of elements (n, local), including bubbles: radial, downward, pressure."""
        kept, inner = self._local
        shared = skeleton[self.numbering[element]]
        full = np.empty((len(element), len(kept) + len(inner)))
        full[:, kept] = shared
        full[:, inner] = np.einsum("nij,nj->ni", self._condensed[1][element], shared)
        return full
