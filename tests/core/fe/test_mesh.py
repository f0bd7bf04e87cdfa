"""Recipes, frozen meshes and their boundaries' names."""

import numpy as np
import pytest
from skfem import MeshQuad

from metafem.fe.elements import Body
from metafem.fe.geometry import Oblate, graded_mesh
from metafem.fe.prescribed_radius import pressed
from validation.finite_elements.frozen_meshes import FOLDER, recipes


def parabola(r):
    return r**2 / (2.0 * 0.526)


def test_recipes_still_make_the_frozen_meshes():
    for name in ["half_space", "cap", "cell"]:
        frozen, made = MeshQuad.load(FOLDER / f"{name}.vtu"), recipes()[name]
        np.testing.assert_allclose(frozen.p, made.p, rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(frozen.t, made.t)
        assert frozen.boundaries.keys() == made.boundaries.keys()
        for boundary, facets in made.boundaries.items():
            np.testing.assert_array_equal(np.sort(frozen.boundaries[boundary]), np.sort(facets))


def test_a_frozen_mesh_gives_hertz():
    mesh = MeshQuad.load(FOLDER / "half_space.vtu")
    contact = pressed(Body(mesh, Oblate(0.2), 10, 0.5), parabola, 0.2, 1.0)
    assert contact.indentation == pytest.approx(0.2**2 / 0.526, rel=1e-6)


def test_lines_increase_for_any_radius():
    for contact, foot in [(1e-6, None), (0.1, 0.1001), (0.3, 2.0)]:
        mesh = graded_mesh(contact, 5.0, 1.0, foot, contact_edge=1e-6)
        lines = np.unique(mesh.p[0])
        assert lines[0] == 0.0
        assert lines[-1] == 5.0
        assert contact in lines
        assert (mesh.p[0, mesh.t[3]] > mesh.p[0, mesh.t[0]]).all()
