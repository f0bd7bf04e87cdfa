import io
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh

import metafem as mf
from metafem.files.part.block import block_mesh
from metafem.files.part.formats import WRITERS, stl_size

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


@pytest.fixture(scope="module")
def mesh():
    part = mf.Surface.square_lattice(
        np.linspace(0.05, 0.2, 6), (2, 3), radius=0.526, material=mf.Material(1.36)
    )
    return block_mesh(part, mf.Block(8.0, 7.0, 3.0), 1e-3)


@pytest.fixture(scope="module")
def written(mesh, tmp_path_factory):
    folder = tmp_path_factory.mktemp("part")
    for kind, write in WRITERS.items():
        write(mesh, folder / f"block.{kind}", "block")
    return folder


@pytest.mark.parametrize("kind", ["stl", "obj"])
def test_solids_are_closed_when_others_read_them(mesh, written, kind):
    again = trimesh.load(written / f"block.{kind}", file_type=kind)
    assert again.is_volume
    assert len(again.faces) == len(mesh.faces)
    assert again.volume == pytest.approx(
        trimesh.Trimesh(mesh.vertices, mesh.faces).volume, rel=1e-6
    )  # single precision
    assert np.float32(again.bounds[1, 2]) == np.float32(0.2)


def test_stl_states_its_unit_and_size(mesh, written):
    content = (written / "block.stl").read_bytes()
    assert content[:80].rstrip() == b"metafem block; units: mm"
    assert len(content) == stl_size(len(mesh.faces))


def test_obj_states_its_unit(written):
    assert "# units: mm" in (written / "block.obj").read_text().splitlines()


def test_3mf_holds_the_mesh_in_millimetres(mesh, written):
    with zipfile.ZipFile(written / "block.3mf") as archive:
        assert archive.testzip() is None
        assert archive.namelist() == ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]
        assert "/3D/3dmodel.model" in archive.read("_rels/.rels").decode()
        model = ElementTree.parse(io.BytesIO(archive.read("3D/3dmodel.model"))).getroot()
    assert model.attrib["unit"] == "millimeter"
    vertices = [[float(v.attrib[k]) for k in "xyz"] for v in model.iter(f"{CORE}vertex")]
    faces = [[int(t.attrib[k]) for k in ("v1", "v2", "v3")] for t in model.iter(f"{CORE}triangle")]
    np.testing.assert_allclose(vertices, mesh.vertices, rtol=1e-8, atol=1e-12)
    np.testing.assert_array_equal(faces, mesh.faces)


def test_the_same_mesh_makes_the_same_files(mesh, written, tmp_path):
    for kind, write in WRITERS.items():
        write(mesh, tmp_path / "again", "block")
        assert (tmp_path / "again").read_bytes() == (written / f"block.{kind}").read_bytes()
