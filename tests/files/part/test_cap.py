import numpy as np
import pytest

from metafem.files.part.cap import CHORD_ERROR, cap_mesh

HEIGHTS = [1e-6, 0.01, 0.12, 0.4, 0.526]


@pytest.mark.parametrize("height", HEIGHTS)
def test_vertices_lie_on_the_sphere(height):
    vertices, _, rim = cap_mesh(height, 0.526)
    distance = np.linalg.norm(vertices - [0.0, 0.0, height - 0.526], axis=1)
    np.testing.assert_allclose(distance, 0.526, rtol=1e-12)
    assert vertices[0].tolist() == [0.0, 0.0, height]
    assert (vertices[rim, 2] == 0.0).all()
    assert (np.delete(vertices[:, 2], rim) > 0.0).all()


@pytest.mark.parametrize("height", HEIGHTS)
def test_faces_stay_within_the_chord_error(height):
    # The deepest point of a triangle inscribed in a sphere is the one nearest the sphere's centre.
    vertices, faces, _ = cap_mesh(height, 0.526)
    a, b, c = (vertices[faces[:, k]] - [0.0, 0.0, height - 0.526] for k in range(3))
    normal = np.cross(b - a, c - a)
    distance = np.einsum("ij,ij->i", a, normal) / np.linalg.norm(normal, axis=1)
    depth = 1.0 - distance / 0.526  # positive distance: the faces look outwards
    assert (depth > 0.0).all()
    # 1 - sqrt(1 - rho^2) against the bound's rho^2/2
    assert depth.max() <= CHORD_ERROR * (1.0 + CHORD_ERROR)


@pytest.mark.parametrize("height", HEIGHTS)
def test_the_rim_is_the_only_border(height):
    _, faces, rim = cap_mesh(height, 0.526)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    directed = {tuple(edge) for edge in edges.tolist()}
    border = {edge for edge in directed if edge[::-1] not in directed}
    assert len(directed) == len(edges)
    assert border == set(zip(rim.tolist(), np.roll(rim, -1).tolist(), strict=True))
