import io
import math

import numpy as np
import pytest

import metafem as mf
from metafem.files.part.block import alignment_asperities, alignment_positions, block_mesh, stl_bytes
from metafem.files.part.cap import CHORD_ERROR

MATERIAL = mf.Material(1.36)


def surface(height=0.1, shape=(2, 3), pitch=1.5, block=(8.0, 7.0, 3.0)):
    return mf.Surface.square_lattice(
        height, shape, pitch, radius=0.526, material=MATERIAL, block=mf.Block(*block) if block else None
    )


def test_alignment_stands_one_pitch_outside_the_corners():
    places = alignment_positions(surface(shape=(2, 3)))
    assert {tuple(place) for place in places} == {(x, y) for x in (-3.0, 3.0) for y in (-2.25, 2.25)}


def test_alignment_asperities_are_the_tallest():
    with pytest.raises(mf.InvalidInput, match="must exceed the tallest summit"):
        alignment_asperities(surface(0.2), surface(), 0.2)


def test_one_site_has_no_pitch():
    with pytest.raises(mf.InvalidInput, match="at least two sites"):
        alignment_positions(surface(shape=(1, 1)))


def test_the_part_is_closed_and_has_its_volume():
    heights = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.526])
    mesh = block_mesh(surface(heights), alignment_height=None)
    exact = 8.0 * 7.0 * 3.0 + math.pi * float((heights**2 * (3 * 0.526 - heights)).sum()) / 3.0
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    # chord error over the caps' area 2 pi R h
    assert 0.0 < exact - mesh.volume < CHORD_ERROR * 0.526 * 2.0 * math.pi * 0.526 * heights.sum()
    assert mesh.bounds.tolist() == [[-4.0, -3.5, -3.0], [4.0, 3.5, 0.526]]


def test_alignment_uses_the_corners_of_the_template():
    template = surface()
    part = template.replaced(
        position=template.position[:2], height=template.height[:2], radius=template.radius[:2]
    )
    mesh = block_mesh(part, 0.4, template)
    summits = mesh.vertices[mesh.vertices[:, 2] == 0.4]
    assert {tuple(place) for place in summits[:, :2]} == {tuple(p) for p in alignment_positions(template)}


def test_each_cap_has_its_own_radius():
    radius, height = np.array([0.3, 0.526, 0.8, 0.8, 0.3, 0.526]), np.linspace(0.1, 0.2, 6)
    part = surface(height).replaced(radius=radius)
    found = block_mesh(part, 0.25, surface())
    caps = found.vertices[found.vertices[:, 2] > 1e-9]
    distance = np.linalg.norm(caps[:, None, :2] - part.position, axis=2)
    own = distance.argmin(axis=1)
    centre = np.column_stack([part.position, height - radius])
    inner = distance.min(axis=1) < 0.75  # not of the alignment
    to_centre = np.linalg.norm(caps - centre[own], axis=1)
    np.testing.assert_allclose(to_centre[inner], radius[own][inner], rtol=1e-12)
    # the holes of the alignment are made by the smallest tool that is large enough
    for top, tool in ((0.25, 0.3), (0.4, 0.526), (0.6, 0.8)):
        assert alignment_asperities(part, surface(), top).radius.tolist() == [tool] * 4
    with pytest.raises(mf.InvalidInput, match=r"part\.alignment_height = 0\.9 mm exceeds the largest radius"):
        alignment_asperities(part, surface(), 0.9)


def test_the_stl_is_closed_after_rounding_and_deterministic():
    import trimesh

    part = surface(np.linspace(0.05, 0.2, 6))
    written = stl_bytes(block_mesh(part))
    assert written == stl_bytes(block_mesh(part))
    again = trimesh.load(io.BytesIO(written), file_type="stl")
    assert again.is_volume
    assert again.bounds[1, 2] == np.float32(0.2)


@pytest.mark.parametrize(("part", "alignment", "message"), [
    (surface(block=None), None, "no block"),
    (surface([0.1, 0.1, 0.0, 0.1, 0.1, 0.1]), None, r"asperity 2 at \(1.5, -0.75\) mm has the height 0 mm"),
    (surface([0.1, 0.1, 0.1, -0.1, 0.1, 0.1]), None, "asperity 3 .* height -0.1 mm"),
    (surface([0.1, 0.6, 0.1, 0.1, 0.1, 0.1]), None, "asperity 1 .* height 0.6 mm"),
    (surface(pitch=0.6), None, "asperity 0 .* and asperity 1 .* overlap"),
    (surface(pitch=4.0), None, "asperity 0 .* leaves the block"),
    (surface(block=(6.8, 7, 3)), 0.4, "alignment asperity 0 .* leaves the block"),
])  # fmt: skip
def test_what_cannot_be_made_is_refused_by_asperity(part, alignment, message):
    with pytest.raises(mf.InvalidInput, match=message):
        block_mesh(part, alignment)
