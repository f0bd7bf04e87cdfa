import numpy as np
import pytest

import metafem as mf
from metafem.files.part.cap import cap_faces, cap_vertices, ring_count

RADIUS = 0.526
HEIGHTS = [1e-6, 0.01, 0.12, 0.4, 0.526]


def cap(height, chord_error=2e-4):
    h, R = np.array([height]), np.array([RADIUS])
    rings = int(ring_count(h, R, chord_error)[0])
    vertices = cap_vertices(h, R, rings)[0]
    return vertices, cap_faces(rings), np.arange(len(vertices) - 6 * rings, len(vertices))


@pytest.mark.parametrize("height", HEIGHTS)
def test_vertices_lie_on_the_sphere(height):
    vertices, _, rim = cap(height)
    distance = np.linalg.norm(vertices - [0.0, 0.0, height - RADIUS], axis=1)
    np.testing.assert_allclose(distance, RADIUS, rtol=1e-12)
    assert vertices[0].tolist() == [0.0, 0.0, height]
    assert (vertices[rim, 2] == 0.0).all()
    assert (np.delete(vertices[:, 2], rim) > 0.0).all()


@pytest.mark.parametrize("chord_error", [2e-5, 2e-4, 3e-3])
@pytest.mark.parametrize("height", HEIGHTS)
def test_faces_stay_within_the_chord_error(height, chord_error):
    # The deepest point of a triangle inscribed in a sphere is the one nearest the sphere's centre.
    vertices, faces, _ = cap(height, chord_error)
    a, b, c = (vertices[faces[:, k]] - [0.0, 0.0, height - RADIUS] for k in range(3))
    normal = np.cross(b - a, c - a)
    distance = np.einsum("ij,ij->i", a, normal) / np.linalg.norm(normal, axis=1)
    depth = RADIUS - distance  # positive distance: the faces look outwards
    assert (depth > 0.0).all()
    # R - sqrt(R^2 - rho^2) against the bound's rho^2/(2 R)
    assert depth.max() <= chord_error * (1.0 + chord_error / RADIUS)


@pytest.mark.parametrize("height", HEIGHTS)
def test_the_rim_is_the_only_border(height):
    _, faces, rim = cap(height)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    directed = {tuple(edge) for edge in edges.tolist()}
    border = {edge for edge in directed if edge[::-1] not in directed}
    assert len(directed) == len(edges)
    assert border == set(zip(rim.tolist(), np.roll(rim, -1).tolist(), strict=True))


def law_of(name):
    """A smooth profile, one with an infinite curvature at the summit, a tip, and a table with a bulge."""
    rho = np.linspace(0.0, 0.9, 40)
    return {
        "quartic": mf.PowerCap(4, 0.5),
        "blunt": mf.PowerCap(12, 0.5),
        "pointed": mf.PowerCap(1.3, 0.4),
        "cone": mf.PowerCap(1, 0.3),
        "table": mf.AxisymmetricCap([rho, 0.5 * rho**2 + 0.004 * (1.0 - np.cos(20.0 * rho))]),
    }[name]


@pytest.mark.parametrize("chord_error", [2e-4, 1e-3])
@pytest.mark.parametrize("height", [0.005, 0.12])
@pytest.mark.parametrize("name", ["quartic", "blunt", "pointed", "cone", "table"])
def test_faces_of_any_profile_stay_within_the_chord_error(name, height, chord_error):
    law = law_of(name)
    shape = law.shape()
    h, R = np.array([height, 0.12]), np.array([RADIUS, RADIUS])
    rings = int(ring_count(h, R, chord_error, shape)[0])
    vertices = cap_vertices(h, R, rings, shape)[0]
    place = np.linalg.norm(vertices[:, :2], axis=1)
    np.testing.assert_allclose(height - vertices[:, 2], law.depth_at(place, RADIUS), atol=1e-12)
    assert (np.diff(np.unique(place.round(12))) > 0.0).all()
    # depth along the axis, which is at least that along the normal, at points of each face
    corner = vertices[cap_faces(rings)]
    share = np.array([[1, 1, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [2, 1, 0]])
    point = np.einsum("sk,fkx->fsx", share / share.sum(axis=1, keepdims=True), corner)
    depth = height - law.depth_at(np.linalg.norm(point[..., :2], axis=-1), RADIUS) - point[..., 2]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    depth *= (normal[:, 2] / np.linalg.norm(normal, axis=1))[:, None]
    assert np.abs(depth).max() <= chord_error
    if rings > 8:  # and the mesh is not much finer than it must be
        assert np.abs(depth).max() >= 0.1 * chord_error
