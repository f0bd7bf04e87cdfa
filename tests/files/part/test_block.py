import math

import numpy as np
import pytest

import metafem as mf
from metafem.files import PartOptions, planned
from metafem.files.part.block import (
    block_mesh,
    cap_faces,
    cap_vertices,
    mould_mesh,
    ring_count,
    triangle_count,
)
from metafem.files.part.caps import alignment_positions

MATERIAL = mf.Material(1.36)
BLOCK = mf.Block(8.0, 7.0, 3.0)
FINE = 2e-4


def lattice(height=0.1):
    return mf.Surface.square_lattice(height, (2, 3), 1.5, radius=0.526, material=MATERIAL, block=BLOCK)


def scattered(seed, radii):
    """Caps at random places that do not overlap."""
    rng = np.random.default_rng(seed)
    found = []
    while len(found) < 25:
        place, radius = rng.uniform((-3.4, -2.9), (3.4, 2.9)), rng.choice(radii)
        height = radius * rng.uniform(0.02, 1.0)
        base = math.sqrt(height * (2.0 * radius - height))
        if all(math.dist(place, other) > base + width for other, _, _, width in found):
            found.append((place, height, radius, base))
    place, height, radius, _ = zip(*found, strict=True)
    return mf.Surface(place, height, radius, MATERIAL, block=BLOCK)


def volume(mesh):
    """Enclosed volume by the divergence theorem."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def exact_caps(part):
    return math.pi * float((part.height**2 * (3.0 * part.radius - part.height)).sum()) / 3.0


@pytest.mark.parametrize(
    "part",
    [
        lattice(np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.526])),
        lattice(),
        *(scattered(seed, [0.3]) for seed in range(4)),
        *(scattered(seed, [0.2, 0.5]) for seed in range(4, 10)),
    ],
)
def test_part_and_mould_are_closed_and_fill_a_box_together(part):
    block = block_mesh(part, BLOCK, FINE)
    mould = mould_mesh(block, part, BLOCK)
    assert block.closed
    assert mould.closed
    assert len(block.faces) == triangle_count(part.height, part.radius, FINE)
    plate = 8.0 * 7.0 * (3.0 + float(part.height.max()))
    # the facets cut the same off the part and the mould's cavities
    assert volume(block) + volume(mould) == pytest.approx(8.0 * 7.0 * 3.0 + plate, rel=1e-12)
    shell = FINE * 2.0 * math.pi * float((part.radius * part.height).sum())  # chord error over the caps' area
    assert 0.0 < 8.0 * 7.0 * 3.0 + exact_caps(part) - volume(block) < shell


def test_caps_that_nearly_touch_are_closed():
    height, radius = 0.1, 0.526
    base = math.sqrt(height * (2.0 * radius - height))
    part = mf.Surface([[0.0, 0.0], [2.0 * base * (1.0 + 1e-9), 0.0]], [height] * 2, radius, MATERIAL)
    assert block_mesh(part, BLOCK, FINE).closed


def test_the_mould_is_seen_from_its_open_face():
    part = lattice(np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.4]))
    mould = mould_mesh(block_mesh(part, BLOCK, FINE), part, BLOCK)
    deepest = mould.vertices[mould.vertices[8:, 2].argmin() + 8]
    assert deepest.tolist() == [-1.5, 0.75, -0.4]
    assert mould.vertices[:, 2].max() == 0.0
    assert mould.vertices[:, 2].min() == -3.4


def test_alignment_uses_the_corners_of_the_template():
    template = lattice()
    part = template.replaced(
        position=template.position[:2], height=template.height[:2], radius=template.radius[:2]
    )
    whole = planned(part, template, PartOptions(0.4)).surface
    vertices = block_mesh(whole, BLOCK, FINE).vertices
    summits = vertices[vertices[:, 2] == 0.4]
    assert {tuple(place) for place in summits[:, :2]} == {tuple(p) for p in alignment_positions(template)}


def test_each_cap_has_its_own_radius():
    radius, height = np.array([0.3, 0.526, 0.8, 0.8, 0.3, 0.526]), np.linspace(0.1, 0.2, 6)
    part = lattice(height).replaced(radius=radius)
    vertices = block_mesh(part, BLOCK, FINE).vertices
    caps = vertices[vertices[:, 2] > 1e-9]
    own = np.linalg.norm(caps[:, None, :2] - part.position, axis=2).argmin(axis=1)
    centre = np.column_stack([part.position, height - radius])
    np.testing.assert_allclose(np.linalg.norm(caps - centre[own], axis=1), radius[own], rtol=1e-12)


@pytest.mark.parametrize(
    "shape",
    [
        mf.Power(4),
        mf.Power(1.5, 0.4),
        mf.Profile([np.linspace(0.0, 0.6, 20), np.linspace(0.0, 0.6, 20) ** 2]),
    ],
    ids=["quartic", "pointed", "table"],
)
def test_caps_of_any_profile_are_closed_and_have_their_volume(shape):
    part = lattice(np.array([0.01, 0.05, 0.08, 0.1, 0.11, 0.12])).replaced(cap=shape)
    made = planned(part, part, PartOptions(chord_error=1e-3))
    block = block_mesh(part, BLOCK, 1e-3)
    mould = mould_mesh(block, part, BLOCK)
    assert block.closed
    assert mould.closed
    assert len(block.faces) == made.triangles
    assert volume(block) + volume(mould) == pytest.approx(8.0 * 7.0 * (3.0 + 3.12), rel=1e-12)
    exact = 8.0 * 7.0 * 3.0 + float(shape.volume(part.height, part.radius).sum())
    assert volume(block) == pytest.approx(
        exact, abs=1e-3 * float(shape.largest_area(part.height, part.radius).sum())
    )
    rim = block.vertices[8:][block.vertices[8:, 2] == 0.0]
    reach = np.linalg.norm(rim[:, None, :2] - part.position, axis=2).min(axis=1)
    np.testing.assert_allclose(reach.max(), shape.foot_radius(part.height, part.radius).max(), rtol=1e-12)


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


def cap_of(name):
    """A smooth profile, one with an infinite curvature at the summit, and a table with a bulge."""
    rho = np.linspace(0.0, 0.9, 40)
    return {
        "quartic": mf.Power(4, 0.5),
        "blunt": mf.Power(12, 0.5),
        "pointed": mf.Power(1.3, 0.4),
        "table": mf.Profile([rho, 0.5 * rho**2 + 0.004 * (1.0 - np.cos(20.0 * rho))]),
    }[name]


@pytest.mark.parametrize("chord_error", [2e-4, 1e-3])
@pytest.mark.parametrize("height", [0.005, 0.12])
@pytest.mark.parametrize("name", ["quartic", "blunt", "pointed", "table"])
def test_faces_of_any_profile_stay_within_the_chord_error(name, height, chord_error):
    shape = cap_of(name)
    h, R = np.array([height, 0.12]), np.array([RADIUS, RADIUS])
    rings = int(ring_count(h, R, chord_error, shape)[0])
    vertices = cap_vertices(h, R, rings, shape)[0]
    place = np.linalg.norm(vertices[:, :2], axis=1)
    np.testing.assert_allclose(height - vertices[:, 2], shape.depth_at(place, RADIUS), atol=1e-12)
    assert (np.diff(np.unique(place.round(12))) > 0.0).all()
    # depth along the axis, which is at least that along the normal, at points of each face
    corner = vertices[cap_faces(rings)]
    share = np.array([[1, 1, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [2, 1, 0]])
    point = np.einsum("sk,fkx->fsx", share / share.sum(axis=1, keepdims=True), corner)
    depth = height - shape.depth_at(np.linalg.norm(point[..., :2], axis=-1), RADIUS) - point[..., 2]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    depth *= (normal[:, 2] / np.linalg.norm(normal, axis=1))[:, None]
    assert np.abs(depth).max() <= chord_error
    if rings > 8:  # and the mesh is not much finer than it must be
        assert np.abs(depth).max() >= 0.1 * chord_error
