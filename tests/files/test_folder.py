import json
from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.files.demo import demo_text
from metafem.files.folder import stored_hardness, write_all
from metafem.files.wanted_table import RESERVED


@pytest.fixture(scope="module")
def linear(tmp_path_factory):
    path = tmp_path_factory.mktemp("spec") / "linear.toml"
    text = demo_text("linear").replace("[8, 8]", "[3, 3]")
    path.write_text(text, encoding="utf-8")
    spec = mf.read_spec(path)
    return spec, mf.design(spec.target, spec.template, spec.model, spec.limits, rng=spec.seed)


def test_the_whole_folder(tmp_path, linear):
    spec, design = linear
    mf.save(design, tmp_path / "out", specification=spec, pages={"report.html": "<p>µ</p>"})
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "design.json", "heights.csv", "law.csv", "mould.csv", "block.stl", "surface.vtu", "spec.toml",
        "report.html",
    }  # fmt: skip
    assert {path.name for path in (tmp_path / "out").iterdir()} <= RESERVED
    record = json.loads((tmp_path / "out" / "design.json").read_text())
    assert record["specification"]["sha256"] == spec.sha256
    assert record["specification"]["seed"] == 0
    assert set(record["versions"]) >= {"python", "metafem", "numpy", "scipy", "numba", "manifold3d"}
    assert (tmp_path / "out" / "report.html").read_text(encoding="utf-8") == "<p>µ</p>"
    assert mf.read_spec(tmp_path / "out" / "spec.toml").sha256 == spec.sha256
    assert (tmp_path / "out" / "mould.csv").read_text().count("alignment") == 4


def test_a_design_loads_to_the_bit(tmp_path, linear):
    _, design = linear
    mf.save(design, tmp_path / "out")
    again = mf.load(tmp_path / "out")
    for name in ("position", "height", "radius"):
        np.testing.assert_array_equal(getattr(again.surface, name), getattr(design.surface, name))
    for name in ("load", "area", "separation", "approach", "stiffness", "residual"):
        np.testing.assert_array_equal(getattr(again.law, name), getattr(design.law, name))
    for name in ("misfit", "status", "target", "limits", "notes", "density", "fits"):
        assert getattr(again, name) == getattr(design, name)


def test_two_folders_of_one_design_are_equal(tmp_path, linear):
    spec, design = linear
    for name in ("a", "b"):
        mf.save(design, tmp_path / name, specification=spec)
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()


def test_without_a_block_the_part_is_left_out_and_said(tmp_path, linear):
    spec, _ = linear
    template = spec.template.replaced(block=None)
    mf.save(mf.design(spec.target, template, limits=spec.limits), tmp_path / "out")
    assert not (tmp_path / "out" / "block.stl").exists()
    assert "no block" in json.loads((tmp_path / "out" / "design.json").read_text())["notes"][0]


def test_a_part_that_cannot_be_made_leaves_nothing(tmp_path, linear):
    spec, _ = linear
    template = spec.template.replaced(position=0.2 * spec.template.position)
    with pytest.raises(mf.InvalidInput, match="overlap"):
        mf.save(mf.design(spec.target, template, limits=spec.limits), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_force_replaces_an_earlier_result(tmp_path, linear):
    _, design = linear
    mf.save(design, tmp_path / "out")
    with pytest.raises(mf.InvalidInput, match="exists"):
        mf.save(design, tmp_path / "out")
    mf.save(design, tmp_path / "out", force=True)
    assert mf.load(tmp_path / "out").misfit == design.misfit


def test_only_a_design_is_saved(tmp_path):
    with pytest.raises(mf.InvalidInput, match=r"must be a metafem\.Design"):
        mf.save("design", tmp_path / "out")


def test_a_folder_that_vanished_is_named(tmp_path, linear):
    with pytest.raises(mf.InvalidInput, match="cannot be written"):
        write_all(linear[1], tmp_path / "none")


@pytest.mark.parametrize(("damage", "message"), [
    (lambda text: text[: len(text) // 2], "damaged"),
    (lambda _: "", "damaged"),
    (lambda _: "[]", "not a design of this version"),
    (lambda _: '{"format": "else"}', "not a design of this version"),
    (lambda text: text.replace('"Design"', '"Limits"'), "damaged"),
    (lambda text: text.replace('"max_height"', '"maximum"'), "damaged"),
    (lambda text: text.replace('"max_height": 0.12', '"max_height": "high"'), "damaged"),
    (lambda text: text.replace('"Independent"', '"Dependent"'), "damaged"),
    (lambda _: '{"format": "metafem design 1", "design": 3}', "holds no design"),
    (lambda _: '{"format": "metafem design 1"}', "holds no design"),
])  # fmt: skip
def test_a_damaged_design_is_refused(tmp_path, linear, damage, message):
    mf.save(linear[1], tmp_path / "out")
    path = tmp_path / "out" / "design.json"
    path.write_text(damage(path.read_text()))
    with pytest.raises(mf.InvalidInput, match=message):
        mf.load(tmp_path / "out")


def test_a_folder_without_a_design_is_refused(tmp_path):
    with pytest.raises(mf.InvalidInput, match="no such file"):
        mf.load(tmp_path)


def test_the_hardness_of_the_specification_is_kept(tmp_path, linear):
    spec, design = linear
    mf.save(design, tmp_path / "with", specification=replace(spec, hardness=10.0))
    mf.save(design, tmp_path / "without")
    assert (stored_hardness(tmp_path / "with"), stored_hardness(tmp_path / "without")) == (10.0, None)


def test_a_design_without_its_specification_is_refused(tmp_path):
    (tmp_path / "design.json").write_text('{"format": "metafem design 1"}')
    with pytest.raises(mf.InvalidInput, match="lacks its specification"):
        stored_hardness(tmp_path)
