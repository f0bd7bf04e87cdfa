"""Contact of a given radius: two linear problems, and the indentation for which the pressure is finite."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from skfem import ElementLinePp, MeshQuad

from metafem._validate import FloatArray
from metafem.fe.axisymmetric.elasticity import Body, Solution, hierarchical
from metafem.fe.axisymmetric.geometry import Geometry, Oblate
from metafem.fe.axisymmetric.surface_values import locate
from metafem.fe.linear_solve import LinearStatus

Profile = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class Pressed:
    """Solution on one mesh with elements of one degree."""

    load: float  # P/E* [mm^2]
    indentation: float  # [mm]
    # half of the relative difference of loads or indentations between the two criteria; 0 for one criterion
    bracket: float
    residual: float  # of the linear system
    status: LinearStatus  # of the linear system
    body: Body  # for the evaluation of fields, with the skeleton of its solution
    skeleton: FloatArray
    extent: float  # largest radius of the body [mm]


def spectral(
    mesh: MeshQuad, geometry: Oblate, degree: int, poisson_ratio: float, profile: Profile, extent: float
) -> Pressed:
    """Solve on a half-space in oblate-spheroidal coordinates.

    Near the edge the depth of the surface below the contact is ``K mu + O(mu^2)``, where K is the strength of
    the pressure singularity. At the indentation found, K vanishes.
    """
    body = Body(mesh, geometry, degree, poisson_ratio)
    solution = _solve(body, profile, walled=False)
    element, point = locate(body, "free", np.zeros((2, 1)))
    slope = body.plane_gradient(solution.skeleton, int(element[0]), point)[1]
    indentation = -slope[1] / slope[0]
    return _combined(body, solution, indentation, 0.0, extent)


def graded(
    mesh: MeshQuad,
    geometry: Geometry,
    degree: int,
    poisson_ratio: float,
    profile: Profile,
    contact_radius: float,
    extent: float,
    walled: bool,
) -> Pressed:
    """Solve on a mesh graded to the edge; the indentation is the mean of the results of the two criteria."""
    body = Body(mesh, geometry, degree, poisson_ratio)
    solution = _solve(body, profile, walled)
    start = body.displacement.skeleton
    edge = geometry.surface(np.array(contact_radius))[0]
    corner, other = _edge_nodes(mesh, float(edge))
    reaction = solution.reaction[start + corner]
    no_reaction = -reaction[1] / reaction[0]
    sunk = solution.skeleton[start + other]
    depth = float(profile(geometry.point(mesh.p[:, other])[:1])[0])
    no_gap = (depth + sunk[1]) / (1.0 - sunk[0])
    indentation = 0.5 * (no_reaction + no_gap)
    load = total_load(body, solution)
    middle = load[0] * indentation + load[1]
    half = 0.5 * abs(no_gap - no_reaction)
    bracket = max(half / abs(indentation), half * load[0] / abs(middle))
    return _combined(body, solution, indentation, bracket, extent)


def total_load(body: Body, solution: Solution) -> FloatArray:
    """Load P/E* of each right-hand side: the sum of the reactions of the contact's nodes."""
    return np.asarray(
        2.0 * math.pi * solution.reaction[body.displacement.skeleton + _nodes(body, "contact")].sum(axis=0)
    )


def contact_data(body: Body, value: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Coefficients (n,) of the polynomials that interpolate `value` of the radius along the contact.

    Exact at the nodes, and the least-squares fit between them.
    """
    mesh, field = body.mesh, body.displacement
    facets = mesh.boundaries["contact"]
    x, w = np.polynomial.legendre.leggauss(body.degree + 3)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    line = hierarchical(ElementLinePp, body.degree)
    bubbles = np.array([line.lbasis(x[None], i)[0] for i in range(2, body.degree + 1)])
    # The degrees on a facet run from its smaller coordinate to its larger one.
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


def _solve(body: Body, profile: Profile, walled: bool) -> Solution:
    """Solve for a unit displacement of the contact, and for the profile pressed flat."""
    start = body.displacement.skeleton
    radial = [body.boundary("axis"), body.boundary("base")]
    if walled:
        radial.append(body.boundary("wall"))
    fixed = np.unique(
        np.concatenate([*radial, start + body.boundary("base"), start + body.boundary("contact")])
    )
    value = np.zeros((body.matrix.shape[0], 2))
    value[start : 2 * start, 0] = contact_data(body, np.ones_like)
    value[start : 2 * start, 1] = contact_data(body, lambda r: -profile(r))
    return body.solve(fixed, value)


def _combined(body: Body, solution: Solution, indentation: float, bracket: float, extent: float) -> Pressed:
    weight = np.array([indentation, 1.0])
    return Pressed(
        load=float(total_load(body, solution) @ weight),
        indentation=float(indentation),
        bracket=float(bracket),
        residual=solution.residual,
        status=solution.status,
        body=body,
        skeleton=solution.skeleton @ weight,
        extent=extent,
    )


def _nodes(body: Body, name: str) -> FloatArray:
    return np.unique(body.mesh.facets[:, body.mesh.boundaries[name]])


def _edge_nodes(mesh: MeshQuad, edge: float) -> tuple[int, int]:
    """Node at the contact's edge and the next one outside it."""
    free = np.unique(mesh.facets[:, mesh.boundaries["free"]])
    order = free[np.argsort(np.abs(mesh.p[0, free] - edge))]
    return int(order[0]), int(order[1])
