import math

import numpy as np
import pytest

import metafem as mf
from metafem.files import PartOptions, planned
from metafem.files.part.block import block_mesh, mould_mesh, triangle_count
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
    mould = mould_mesh(block, part, BLOCK, FINE)
    assert block.closed
    assert mould.closed
    assert len(block.faces) == triangle_count(part.height, part.radius, FINE)
    plate = 8.0 * 7.0 * (3.0 + float(part.height.max()))
    # the facets cut the same off the part and the mould's cavities
    assert block.volume + mould.volume == pytest.approx(8.0 * 7.0 * 3.0 + plate, rel=1e-12)
    shell = FINE * 2.0 * math.pi * float((part.radius * part.height).sum())  # chord error over the caps' area
    assert 0.0 < 8.0 * 7.0 * 3.0 + exact_caps(part) - block.volume < shell


def test_caps_that_nearly_touch_are_closed():
    height, radius = 0.1, 0.526
    base = math.sqrt(height * (2.0 * radius - height))
    part = mf.Surface([[0.0, 0.0], [2.0 * base * (1.0 + 1e-9), 0.0]], [height] * 2, radius, MATERIAL)
    assert block_mesh(part, BLOCK, FINE).closed


def test_the_mould_is_seen_from_its_open_face():
    part = lattice(np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.4]))
    mould = mould_mesh(block_mesh(part, BLOCK, FINE), part, BLOCK, FINE)
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
    "law",
    [
        mf.PowerCap(4),
        mf.PowerCap(1.5, 0.4),
        mf.AxisymmetricCap([np.linspace(0.0, 0.6, 20), np.linspace(0.0, 0.6, 20) ** 2]),
    ],
    ids=["quartic", "pointed", "table"],
)
def test_caps_of_any_profile_are_closed_and_have_their_volume(law):
    part = lattice(np.array([0.01, 0.05, 0.08, 0.1, 0.11, 0.12]))
    made = planned(part, part, PartOptions(chord_error=1e-3), law)
    shape = law.shape()
    block = block_mesh(part, BLOCK, 1e-3, shape)
    mould = mould_mesh(block, part, BLOCK, 1e-3, shape)
    assert block.closed
    assert mould.closed
    assert len(block.faces) == made.triangles
    volume = 8.0 * 7.0 * 3.0 + float(shape.volume(part.height, part.radius).sum())
    assert block.volume == pytest.approx(
        volume, abs=1e-3 * float(shape.largest_area(part.height, part.radius).sum())
    )
    rim = block.vertices[8:][block.vertices[8:, 2] == 0.0]
    reach = np.linalg.norm(rim[:, None, :2] - part.position, axis=2).min(axis=1)
    np.testing.assert_allclose(reach.max(), shape.foot_radius(part.height, part.radius).max(), rtol=1e-12)
