"""Contact of prescribed radius: two linear problems, and the indentation with a finite edge pressure."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from skfem import ElementLinePp, MeshQuad

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.fe.axisymmetric.elasticity import Body, hierarchical
from metafem.fe.axisymmetric.geometry import Flat, Oblate
from metafem.fe.linear_solve import LinearStatus, Solved

Profile = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class PressedContact:
    """Finite-element solution of one contact under a rigid, frictionless plane.

    Attributes
    ----------
    contact_radius : float
        a [mm].
    rescaled_load : float
        P/E* [mm^2].
    indentation : float
        Approach of the plane to the far body since first touch [mm].
    error_estimate : float
        Upper bound of the relative errors of load and indentation [-].
    residual : float
        Scaled residual of the linear system, recomputed [-].
    status : LinearStatus

    Examples
    --------
    >>> import metafem as mf
    >>> contact = mf.fe.press(contact_radius=0.2, radius=0.526)
    >>> round(contact.indentation, 6), round(contact.rescaled_load, 6)
    (0.076046, 0.020279)
    >>> contact.pressure([0.0, 0.1, 0.3]).round(4)
    array([0.2421, 0.2096, 0.    ])
    """

    contact_radius: float
    rescaled_load: float
    indentation: float
    error_estimate: float
    residual: float
    status: LinearStatus
    body: Body = field(repr=False)
    skeleton: FloatArray = field(repr=False)
    extent: float = field(repr=False)  # largest radius of the body [mm]

    def displacement(self, r: ArrayLike) -> FloatArray:
        """Return the downward displacement [mm] of the surface at the undeformed radii r [mm], of any shape.

        Raises
        ------
        InvalidInput
            If a radius is negative or outside the body.
        """
        radius = check.array("r", np.atleast_1d(r), shape=(None,))
        refuse_if(
            radius.min() < 0.0 or radius.max() > self.extent,
            f"r must lie from 0 to {self.extent:g}, the radius of the body",
        )
        result = np.empty(radius.shape)
        closed = radius <= self.contact_radius
        for name, part in (("contact", closed), ("free", ~closed)):
            if part.any():
                place = self.body.located(name, self.body.geometry.surface(radius[part]))
                result[part] = self.body.fields_at(self.skeleton, *place)[0][1]
        return result.reshape(np.shape(r))

    def pressure(self, r: ArrayLike) -> FloatArray:
        """Return the contact pressure per horizontal area over E* [-] at the radii r [mm]; 0 outside."""
        radius = check.array("r", np.atleast_1d(r), shape=(None,))
        result = np.zeros(radius.shape)
        inside = np.abs(radius) < self.contact_radius
        # The hoop strain u/r needs r > 0; the lower bound 1e-6 a changes the result by a relative 1e-12.
        near = np.maximum(np.abs(radius[inside]), 1e-6 * self.contact_radius)
        if inside.any():
            result[inside] = self._traction(near)
        return result.reshape(np.shape(r))

    def _traction(self, r: FloatArray) -> FloatArray:
        """Return the downward traction per horizontal area in contact, ``-(sigma_zz + sigma_rz n_r/n_z)``."""
        body = self.body
        plane = body.geometry.surface(r)
        displacement, gradient, pressure = body.fields_at(self.skeleton, *body.located("contact", plane))
        mean = (gradient[0, 0] + gradient[1, 1] + displacement[0] / r) / 3.0
        down = 2.0 * body.shear_modulus * (gradient[1, 1] - mean) - pressure
        across = body.shear_modulus * (gradient[0, 1] + gradient[1, 0])
        # The boundary runs along the first plane coordinate.
        tangent = body.geometry.jacobian(plane)[:, 0]
        return np.asarray(across * tangent[1] / tangent[0] - down)


def spectral(
    mesh: MeshQuad, geometry: Oblate, degree: int, poisson_ratio: float, profile: Profile, extent: float
) -> PressedContact:
    """Return the contact on a half-space, solved in oblate-spheroidal coordinates.

    Near the edge, the depth of the surface below the contact is ``K mu + O(mu^2)``, where K is the strength
    of the pressure singularity. The indentation is that for which K vanishes.
    """
    body = Body(mesh, geometry, degree, poisson_ratio)
    solved = _solve(body, profile, walled=False)
    edge = body.located("free", np.zeros((2, 1)))
    slope = [body.fields_at(part, *edge, by_plane=True)[1][1, 1, 0] for part in solved.value.T]
    load = _nodal_forces(body, solved)[_nodes(body, "contact")].sum(axis=0)
    return _combined(body, solved, load, -slope[1] / slope[0], 0.0, geometry.radius, extent)


def graded(
    mesh: MeshQuad,
    geometry: Flat,
    degree: int,
    poisson_ratio: float,
    profile: Profile,
    contact_radius: float,
    extent: float,
    walled: bool,
) -> PressedContact:
    """Return the contact on a mesh graded towards the edge; two criteria give the indentation.

    The result is the mean of the results of the two criteria. The error estimate is half of the relative
    difference of their loads or indentations, whichever is larger.
    """
    body = Body(mesh, geometry, degree, poisson_ratio)
    solved = _solve(body, profile, walled)
    free = _nodes(body, "free")
    edge = geometry.surface(np.array(contact_radius))[0]
    corner, other = free[np.argsort(np.abs(mesh.p[0, free] - edge))][:2]
    force = _nodal_forces(body, solved)
    no_reaction = -force[corner, 1] / force[corner, 0]
    sunk = solved.value[body.displacement.skeleton + other]
    depth = float(profile(geometry.point(mesh.p[:, other])[:1])[0])
    no_gap = (depth + sunk[1]) / (1.0 - sunk[0])
    indentation = 0.5 * (no_reaction + no_gap)
    load = force[_nodes(body, "contact")].sum(axis=0)
    half = 0.5 * abs(no_gap - no_reaction)
    bracket = max(half / abs(indentation), half * load[0] / abs(load[0] * indentation + load[1]))
    return _combined(body, solved, load, indentation, bracket, contact_radius, extent)


def contact_data(body: Body, value: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return the coefficients (n,) of polynomials that approximate `value`(r) along the contact.

    They are exact at the nodes and least-squares fits between the nodes.
    """
    mesh, field = body.mesh, body.displacement
    facets = mesh.boundaries["contact"]
    x, w = np.polynomial.legendre.leggauss(body.degree + 3)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    line = hierarchical(ElementLinePp, body.degree)
    bubbles = np.array([line.lbasis(x[None], i)[0] for i in range(2, body.degree + 1)])
    # The degrees of freedom of a facet run from its smaller to its larger coordinate.
    nodes = mesh.facets[:, facets]
    nodes = np.where(mesh.p[:, nodes[0]].sum(axis=0) <= mesh.p[:, nodes[1]].sum(axis=0), nodes, nodes[::-1])
    first, last = mesh.p[:, nodes[0], None], mesh.p[:, nodes[1], None]
    inside = value(body.geometry.point(first + (last - first) * x)[0])
    ends = value(body.geometry.point(mesh.p[:, nodes])[0])
    rest = inside - ends[0, :, None] * (1.0 - x) - ends[1, :, None] * x
    result = np.zeros(field.skeleton)
    result[nodes] = ends
    result[field.dofs.facet_dofs[:, facets]] = np.linalg.solve(
        (bubbles * w) @ bubbles.T, (bubbles * w) @ rest.T
    )
    return result


def _solve(body: Body, profile: Profile, walled: bool) -> Solved:
    """Return the solutions for a unit displacement of the contact and for the flattened profile."""
    start = body.displacement.skeleton
    radial = body.boundary("axis", "base", *(["wall"] if walled else []))
    fixed = np.unique(np.concatenate([radial, start + body.boundary("base", "contact")]))
    value = np.zeros((body.matrix.shape[0], 2))
    value[start : 2 * start, 0] = contact_data(body, np.ones_like)
    value[start : 2 * start, 1] = contact_data(body, lambda r: -profile(r))
    return body.solve(fixed, value)


def _nodal_forces(body: Body, solved: Solved) -> FloatArray:
    """Return the downward nodal forces P/E* on the skeleton for each right-hand side, (n, 2) [mm^2]."""
    start = body.displacement.skeleton
    return np.asarray(2.0 * math.pi * (body.matrix[start : 2 * start] @ solved.value))


def _combined(
    body: Body,
    solved: Solved,
    load: FloatArray,
    indentation: float,
    bracket: float,
    contact_radius: float,
    extent: float,
) -> PressedContact:
    weight = np.array([indentation, 1.0])
    return PressedContact(
        contact_radius=contact_radius,
        rescaled_load=float(load @ weight),
        indentation=float(indentation),
        error_estimate=float(bracket),
        residual=solved.residual,
        status=solved.status,
        body=body,
        skeleton=solved.value @ weight,
        extent=extent,
    )


def _nodes(body: Body, name: str) -> FloatArray:
    return np.unique(body.mesh.facets[:, body.mesh.boundaries[name]])
