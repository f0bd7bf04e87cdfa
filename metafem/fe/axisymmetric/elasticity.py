"""Axisymmetric small-strain elasticity with displacements of degree p and pressures of degree p - 1."""

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

# Gauss points per direction in addition to the degree: the polynomials of the elements need one; the others
# resolve the analytic maps and 1/r.
EXTRA_POINTS = 3

# Numbers in the largest array of a group of elements: 2 MiB, so that a few such arrays fit into the cache.
GROUP = 250_000


def hierarchical(kind: Any, degree: int) -> Any:
    """Return an element of a hierarchical family, without the logged advice to use nodal elements."""
    logger = logging.getLogger(kind.__module__)
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        return kind(degree)
    finally:
        logger.setLevel(level)


def assembled(number: IntArray, block: FloatArray, size: int) -> csc_matrix:
    """Assemble element matrices (elements, local, local) with global unknown numbers (elements, local)."""
    width = number.shape[1]
    rows, columns = np.repeat(number, width, axis=1).ravel(), np.tile(number, (1, width)).ravel()
    return coo_matrix((block.ravel(), (rows, columns)), shape=(size, size)).tocsc()


class Polynomials:
    """Scalar polynomials of one degree on a mesh: numbering and reference shapes."""

    def __init__(self, mesh: MeshQuad, degree: int) -> None:
        self.element = hierarchical(ElementQuadP, degree)
        self.dofs = Dofs(mesh, self.element)
        self.local = (degree + 1) ** 2
        self.inner = (degree - 1) ** 2
        # Bubbles are numbered last, globally and in each element.
        self.skeleton = int(self.dofs.N) - self.inner * mesh.nelements

    def shapes(self, point: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Values (local, n) and derivatives (local, 2, n) at points (2, n) of the reference square."""
        pairs = [self.element.lbasis(point, i) for i in range(self.local)]
        return np.array([value for value, _ in pairs]), np.array([slope for _, slope in pairs])


class Body:
    """An axisymmetric elastic body of composite modulus 1 on a mesh of its reference plane.

    ``div(2 mu dev eps - p I) = 0``, ``div u + p/K = 0`` with ``mu = (1 - nu)/2`` and
    ``1/K = 3 (1 - 2 nu)/(1 - nu^2)``: exact for every nu in [0, 0.5], including incompressible bodies.
    The bubbles of displacement and pressure are eliminated element by element. The degree is at
    least 4.
    """

    def __init__(self, mesh: MeshQuad, geometry: Flat, degree: int, poisson_ratio: float) -> None:
        self.mesh, self.geometry, self.degree = mesh, geometry, degree
        self.poisson_ratio = poisson_ratio
        self.displacement, self.pressure = Polynomials(mesh, degree), Polynomials(mesh, degree - 1)

    @property
    def shear_modulus(self) -> float:
        """Mu, in units of the composite modulus."""
        return 0.5 * (1.0 - self.poisson_ratio)

    @property
    def compliance(self) -> float:
        """1/K, in units of 1/E*."""
        return 3.0 * (1.0 - 2.0 * self.poisson_ratio) / (1.0 - self.poisson_ratio**2)

    @cached_property
    def _local(self) -> tuple[IntArray, IntArray]:
        """Local numbers of the skeleton and the bubbles for (radial, downward, pressure)."""
        u, p = self.displacement, self.pressure
        kept, inner = [], []
        for start, field in ((0, u), (u.local, u), (2 * u.local, p)):
            shared = field.local - field.inner
            kept.append(start + np.arange(shared))
            inner.append(start + np.arange(shared, field.local))
        return np.concatenate(kept), np.concatenate(inner)

    @cached_property
    def numbering(self) -> IntArray:
        """Global skeleton numbers of the remaining unknowns of each element, (elements, kept)."""
        u, p = self.displacement, self.pressure
        mine = u.dofs.element_dofs[: u.local - u.inner]
        other = p.dofs.element_dofs[: p.local - p.inner]
        return np.vstack([mine, mine + u.skeleton, other + 2 * u.skeleton]).T

    @cached_property
    def _condensed(self) -> tuple[csc_matrix, FloatArray]:
        """Matrix of the skeleton, and for each element the matrix from skeleton to bubbles."""
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
        """Matrix of the skeleton, without the bubbles."""
        return self._condensed[0]

    def _element_matrices(self, elements: IntArray) -> FloatArray:
        """Matrices [[K, G'], [G, -C]] of some elements."""
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
        """Shapes at the Gauss points of elements, with the weight r of the solid of revolution.

        d/dr, d/dz and 1/r of the displacements (elements, points, local), the pressures (points, local) and
        the weights (elements, points).
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
        """Scalar displacement numbers on named boundaries."""
        facets = np.unique(np.concatenate([self.mesh.boundaries[name] for name in names]))
        corners = np.unique(self.mesh.facets[:, facets])
        dofs = self.displacement.dofs
        return np.concatenate([dofs.nodal_dofs[:, corners].ravel(), dofs.facet_dofs[:, facets].ravel()])

    def solve(self, fixed: IntArray, value: FloatArray) -> Solved:
        """Solve with some skeleton unknowns fixed at `value`, (n, k), and no load on the others.

        The skeleton holds the coefficients shared by elements: radial, downward, pressure.
        """
        free = np.setdiff1d(np.arange(self.matrix.shape[0]), fixed)
        rows = self.matrix[free]
        skeleton = np.zeros((self.matrix.shape[0], value.shape[1]))
        skeleton[fixed] = value[fixed]
        solved = solve(rows[:, free].tocsc(), -(rows @ skeleton))
        skeleton[free] = solved.value
        return replace(solved, value=skeleton)

    def located(self, name: str, plane: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the elements that hold points (2, n) of a named boundary, and the local coordinates."""
        facets = self.mesh.boundaries[name]
        ends = self.mesh.p[:, self.mesh.facets[:, facets]]
        along = int(np.argmax(np.ptp(ends.reshape(2, -1), axis=1)))
        start = ends[along].min(axis=0)
        order = np.argsort(start)
        which = np.searchsorted(start[order], plane[along], side="right") - 1
        element = self.mesh.f2t[0, facets[order[np.maximum(which, 0)]]]
        # Elements are parallelograms in the plane: one Newton step from the middle is exact.
        straight, middle = self.mesh.mapping(), np.full((2, len(element), 1), 0.5)
        step = plane - straight.F(middle, element)[..., 0]
        slope = straight.invDF(middle, element)[..., 0]
        return element, np.clip(0.5 + np.einsum("ijn,jn->in", slope, step), 0.0, 1.0)

    def fields_at(
        self, skeleton: FloatArray, element: IntArray, point: FloatArray, *, by_plane: bool = False
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Displacement (2, n), its gradient (2, 2, n) by (r, z), and pressure (n,) inside elements.

        `skeleton` is one column of a solution, `point` (2, n) are coordinates in the reference square. With
        `by_plane` the gradient is by the plane's coordinates, and finite where the Jacobian vanishes.
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
        """All coefficients of elements (n, local), bubbles included: radial, downward, pressure."""
        kept, inner = self._local
        shared = skeleton[self.numbering[element]]
        full = np.empty((len(element), len(kept) + len(inner)))
        full[:, kept] = shared
        full[:, inner] = np.einsum("nij,nj->ni", self._condensed[1][element], shared)
        return full
