"""The files of a part: closed solids of the right volume, as STL."""

import math

import numpy as np
import pytest
import trimesh

import metafem as mf
from metafem.files import PartSection, part_notes, planned
from metafem.files.part import (
    USUAL,
    block_mesh,
    cap_faces,
    cap_vertices,
    mould_mesh,
    ring_count,
    with_alignment,
)

MATERIAL, BLOCK = mf.Material(1.36), mf.Block(8.0, 7.0, 3.0)
HEIGHTS = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.4])
PART = mf.Surface.square_lattice(HEIGHTS, (2, 3), 1.5, radius=0.526, material=MATERIAL, block=BLOCK)
LOW = PART.replaced(height=HEIGHTS * 0.3)
RHO = np.linspace(0.0, 0.6, 40)
TABLE = mf.Profile([RHO, 0.5 * RHO**2 + 0.004 * (1.0 - np.cos(20.0 * RHO))])


def cap_volume(cap, height, radius, foot):
    """The volume 2 pi int rho (h - f) drho of a cap, by quadrature."""
    node, weight = np.polynomial.legendre.leggauss(64)
    rho = 0.5 * foot * (node + 1.0)
    return math.pi * foot * (rho * (height - cap.depth_at(rho, radius))) @ weight


@pytest.mark.parametrize("part", [
    PART, PART.replaced(height=np.full(6, 0.526)),
    LOW.replaced(radius=np.array([0.3, 0.526, 0.6, 0.6, 0.3, 0.526])),
    LOW.replaced(cap=mf.Power(4)), LOW.replaced(cap=mf.Power(1.5, 0.4)), LOW.replaced(cap=TABLE),
], ids=["lattice", "hemispheres", "radii", "quartic", "pointed", "table"])  # fmt: skip
def test_part_and_mould_are_closed_and_fill_a_box_together(part):
    found = block_mesh(part, BLOCK, 1e-3)
    meshes = found, mould_mesh(found, part, BLOCK)
    block, mould = (trimesh.Trimesh(*mesh, process=False, validate=False) for mesh in meshes)
    assert block.is_volume
    assert mould.is_volume
    top = float(part.height.max())
    assert block.volume + mould.volume == pytest.approx(8.0 * 7.0 * (6.0 + top), rel=1e-12)
    foot = part.cap.foot_radius(part.height, part.radius)
    exact = 8.0 * 7.0 * 3.0 + sum(
        cap_volume(part.cap.one(i), *one)
        for i, one in enumerate(zip(part.height, part.radius, foot, strict=True))
    )
    shell = 2e-3 * math.pi * float((part.radius * part.height).sum())  # chord error over the area of spheres
    area = float((math.pi * foot * (foot + 2.0 * part.height)).sum())  # more than that of all caps
    assert exact - block.volume == pytest.approx(0.0, abs=shell + 1e-3 * area)
    assert block.vertices[:, 2].max() == pytest.approx(top, rel=1e-12)
    deepest = mould.vertices[8 + mould.vertices[8:, 2].argmin()]  # from the open face: x is mirrored
    place = part.position[part.height.argmax()]
    np.testing.assert_allclose(deepest, [-place[0], place[1], -top], atol=1e-12)
    assert (mould.vertices[:, 2].max(), mould.vertices[:, 2].min()) == (0.0, pytest.approx(-3.0 - top))


@pytest.mark.parametrize("cap", [mf.Sphere(), mf.Power(12), mf.Power(1.3, 0.4), TABLE])
def test_faces_of_a_cap_keep_the_chord_error(cap):
    for height, chord_error in ((0.005, 2e-4), (0.005, 1e-3), (0.12, 2e-4), (0.12, 1e-3)):
        h, R = np.array([height]), np.array([0.526])
        rings = int(ring_count(h, R, chord_error, cap)[0])
        vertices, faces = cap_vertices(height, 0.526, rings, cap), cap_faces(rings)
        across = np.linalg.norm(vertices[:, :2], axis=1)
        np.testing.assert_allclose(height - vertices[:, 2], cap.depth_at(across, 0.526), atol=1e-12)
        assert vertices[0].tolist() == [0.0, 0.0, height]
        np.testing.assert_allclose(across[-6 * rings :], cap.foot_radius(h, R)[0], rtol=1e-12)
        assert len(faces) == 6 * rings**2
        corner = vertices[faces]
        share = np.array([[1, 1, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]])
        point = np.einsum("sk,fkx->fsx", share / share.sum(axis=1, keepdims=True), corner)
        depth = height - cap.depth_at(np.linalg.norm(point[..., :2], axis=-1), 0.526) - point[..., 2]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        assert (normal[:, 2] > 0.0).all()  # outwards
        depth *= (normal[:, 2] / np.linalg.norm(normal, axis=1))[:, None]
        assert np.abs(depth).max() <= chord_error
        assert rings <= 8 or np.abs(depth).max() >= 0.1 * chord_error  # and not much finer than it must be


GAPS = [*((10.0**n, 0.1) for n in (-9, -6, -5, -3)), (1.0, 1e-12), (1.0, 1e-9)]


@pytest.mark.parametrize(("gap", "height"), GAPS)
def test_what_is_written_is_watertight_in_single_precision(gap, height, tmp_path):
    pair = mf.Surface([[0.0, 0.0], [0.6 + gap, 0.0]], [0.1, height], 0.5, MATERIAL, block=BLOCK)
    try:
        planned(pair, pair, PartSection(chord_error="2 um")).write(tmp_path)
    except mf.InvalidInput:
        assert min(gap, 2.0 * (0.5 * height) ** 0.5) < 1e-5  # a few units of the last place
        return
    for name in ("block.stl", "mould.stl"):
        assert trimesh.load(tmp_path / name).is_watertight


def test_the_files_of_a_plan_are_solids(tmp_path):
    part = planned(PART, PART, PartSection(chord_error="1 um"))
    assert part_notes(part) == ()
    triangles = len(block_mesh(PART, BLOCK, 1e-3)[1])
    files = {
        "block.stl": [[-4.0, -3.5, -3.0], [4.0, 3.5, 0.4]],
        "mould.stl": [[-4.0, -3.5, -3.4], [4.0, 3.5, 0.0]],
    }
    part.write(tmp_path)
    for name, bounds in files.items():
        solid = trimesh.load(tmp_path / name)
        assert solid.is_volume
        assert len(solid.faces) == triangles
        np.testing.assert_allclose(solid.bounds, bounds, rtol=1e-7)  # single precision
        assert (tmp_path / name).stat().st_size == 84 + 50 * triangles
    assert planned(PART, PART, PartSection()).chord_error == pytest.approx(4e-4 * 0.526, rel=1e-12)
    assert planned(PART.replaced(block=None), PART, PartSection()) is None
    assert part_notes(None)[0].text.startswith("no part was written")
    lattice = {"radius": 0.526, "material": MATERIAL, "block": mf.Block(160, 160, 7)}
    many = mf.Surface.square_lattice(0.2, (100, 100), 1.5, **lattice)
    coarse = planned(many, many, PartSection()).chord_error
    assert 6 * (ring_count(many.height, many.radius, coarse) ** 2).sum() == pytest.approx(USUAL, rel=0.5)


def test_alignment_asperities_stand_one_pitch_outside_and_are_the_tallest():
    corners = [(x, y) for y in (-2.25, 2.25) for x in (-3.0, 3.0)]
    radii = np.array([0.3, 0.526, 0.8, 0.8, 0.3, 0.526])
    part = LOW.replaced(radius=radii, friction=mf.Friction(0.4), cell=mf.PeriodicCell(4.5, 3.0))
    for top, tool in ((0.25, 0.3), (0.4, 0.526), (0.6, 0.8)):  # the smallest tool that is large enough
        whole = with_alignment(part, PART, top)
        assert (whole.radius[6:].tolist(), whole.height[6:].tolist()) == ([tool] * 4, [top] * 4)
        assert (whole.friction, whole.cell) == (None, None)
        np.testing.assert_array_equal(whole.position[6:], corners)
    assert with_alignment(part, PART, None) is part
    for wrong in (0.1, 0.12, 0.81):
        with pytest.raises(mf.InvalidInput) as error:
            with_alignment(part, PART, wrong)
        assert (error.value.key, error.value.value) == ("part.alignment_height", f"{wrong:g} mm")
    with pytest.raises(mf.InvalidInput, match=r"exceeds 0\.1806 mm, the largest height of a cap"):
        with_alignment(LOW.replaced(cap=TABLE), PART, 0.4)
