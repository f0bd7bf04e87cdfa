"""The elements: patch test and the geometries."""

import numpy as np
import pytest
from skfem import MeshQuad

from metafem.fe.elements import Body, solve
from metafem.fe.geometry import Cap, Flat, Oblate, named


def test_uniaxial_compression_is_exact():
    for poisson_ratio in [0.3, 0.5]:
        mesh = named(
            MeshQuad.init_tensor(np.array([0.0, 0.3, 1.0]), np.array([0.0, 0.5, 2.0])), 1.5, 1.0, 2.0
        )
        body = Body(mesh, Flat(), 4, poisson_ratio)
        start = body.displacement.skeleton
        top = start + body.boundary("contact")
        fixed = np.unique(np.concatenate([body.boundary("axis"), start + body.boundary("base"), top]))
        value = np.zeros((body.matrix.shape[0], 1))
        nodes = np.unique(mesh.facets[:, mesh.boundaries["contact"]])
        value[start + nodes] = 0.02
        skeleton, _ = solve(body.matrix, fixed, value)
        # E = 1 - nu^2, strain 0.01, area per 2 pi: 1/2.
        assert (body.matrix @ skeleton)[start + nodes].sum() == pytest.approx(
            0.005 * (1.0 - poisson_ratio**2), rel=1e-11
        )
        u, gradient, _ = body.fields_at(skeleton[:, 0], np.array([0]), np.array([[0.4], [0.7]]))
        assert gradient[:, :, 0] == pytest.approx(np.diag([0.01 * poisson_ratio, -0.01]), abs=1e-12)
        assert u.shape == (2, 1)


def test_jacobians_are_the_maps_derivatives():
    for geometry in [Flat(), Oblate(0.4), Cap(0.5, 0.2, 3.0, 2.0)]:
        plane = np.array([[0.05, 0.3, 0.45, 1.2, 2.5], [0.02, 1.0, 0.5, 0.3, 1.9]])
        step = 1e-6
        for axis in range(2):
            shift = step * np.eye(2)[axis][:, None]
            slope = (geometry.point(plane + shift) - geometry.point(plane - shift)) / (2.0 * step)
            # Central differences: step^2 and rounding / step.
            np.testing.assert_allclose(geometry.jacobian(plane)[:, axis], slope, atol=1e-8)


def test_surface_points_are_where_they_should_be():
    for geometry in (Flat(), Oblate(0.4), Cap(0.5, 0.2, 3.0, 2.0)):
        r = np.array([0.1, 0.35, 0.6, 2.0])
        np.testing.assert_allclose(geometry.point(geometry.surface(r))[0], r, rtol=1e-12)
