"""Fields on a body's surface at any radius."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.fe.axisymmetric.elasticity import Body


def locate(body: Body, name: str, plane: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the elements that hold points (2, n) of a named boundary, and the local coordinates."""
    mesh = body.mesh
    facets = mesh.boundaries[name]
    ends = mesh.p[:, mesh.facets[:, facets]]
    along = int(np.argmax(np.ptp(ends.reshape(2, -1), axis=1)))
    start = ends[along].min(axis=0)
    order = np.argsort(start)
    which = np.searchsorted(start[order], plane[along], side="right") - 1
    element = mesh.f2t[0, facets[order[np.maximum(which, 0)]]]
    # Elements are parallelograms in the plane: one Newton step from the middle is exact.
    straight, middle = mesh.mapping(), np.full((2, len(element), 1), 0.5)
    step = plane - straight.F(middle, element)[..., 0]
    slope = straight.invDF(middle, element)[..., 0]
    return element, np.clip(0.5 + np.einsum("ijn,jn->in", slope, step), 0.0, 1.0)


def surface_displacement(body: Body, skeleton: FloatArray, name: str, r: FloatArray) -> FloatArray:
    """Displacement (2, n): radial and downwards, at the radii r on one boundary."""
    element, point = locate(body, name, body.geometry.surface(r))
    return body.fields_at(skeleton, element, point)[0]


def contact_pressure(body: Body, skeleton: FloatArray, r: FloatArray) -> FloatArray:
    """Downward traction per horizontal area at the radii r inside the contact.

    ``-(sigma_zz + sigma_rz n_r/n_z)``.
    """
    plane = body.geometry.surface(r)
    element, point = locate(body, "contact", plane)
    displacement, gradient, pressure = body.fields_at(skeleton, element, point)
    mean = (gradient[0, 0] + gradient[1, 1] + displacement[0] / r) / 3.0
    shear = body.shear_modulus
    down = 2.0 * shear * (gradient[1, 1] - mean) - pressure
    across = shear * (gradient[0, 1] + gradient[1, 0])
    # The boundary runs along the first coordinate of the plane.
    tangent = body.geometry.jacobian(plane)[:, 0]
    return np.asarray(across * tangent[1] / tangent[0] - down)
