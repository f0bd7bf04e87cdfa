import json
from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.files.atomic import MANIFEST, write_text
from metafem.files.result.folder import same_design, stored_hardness, write_all
from metafem.files.specification.models import demo_text
from metafem.files.specification.named_tables import RESERVED


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
        "design.json", "heights.csv", "law.csv", "mould.csv", "mould.svg", "mould.stl", "block.stl",
        "surface.vtu", "spec.toml", "report.html", MANIFEST,
    }  # fmt: skip
    assert {path.name for path in (tmp_path / "out").iterdir()} <= RESERVED | {MANIFEST}
    record = json.loads((tmp_path / "out" / "design.json").read_text())
    assert record["specification"]["sha256"] == spec.sha256
    assert record["specification"]["seed"] == 0
    assert set(record["versions"]) >= {"python", "metafem", "numpy", "scipy", "numba", "meshio"}
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


def test_without_a_block_the_part_is_left_out_with_a_note(tmp_path, linear):
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


WRONG = [
    ("sites.int64", [0, 0, 1, 2, 3, 4, 5, 6, 7], "design: sites must hold 9 different sites"),
    ("sites.int64", [9, 0, 1, 2, 3, 4, 5, 6, 7], "design: sites must be from 0 to 8"),
    ("sites.int64", [1.5, 0, 1, 2, 3, 4, 5, 6, 7], "design.sites = .* is not an array of int64"),
    ("sites", None, "design.sites = None must be an instance of ndarray"),
    ("misfit", "small", "design.misfit = 'small' must be a valid number"),
    ("misfit", -1.0, "design: misfit = -1 must be at least 0"),
    ("misfit", True, "design.misfit = True must be a valid number"),
    (
        "status",
        {"type": "Status", "name": "CONVERGED"},
        "design.status = .* must be an instance of DesignStatus",
    ),
    ("parameters.scale", "large", "design.parameters = .* must be a valid number"),
    ("template.pitch", 3, "design.template, a Surface, has missing or unknown members: pitch"),
    ("surface.height.float64", ["0.1"], "design.surface.height = .* is not an array of float64"),
    ("surface.position.float64", [[i, 0.0] for i in range(9)], "surface.position must be that of the"),
    ("law.rescaled_load.float64", [1.0], "design.law: area has"),
    ("law.model", {"type": "Hertz"}, "design.law.model = .* must be an instance of Model"),
    ("law.material.composite_modulus", 2.0, "law.material and law.friction must be those"),
    (
        "law.notes",
        [{"type": "Note", "text": 3, "level": {"type": "Level", "name": "WARNING"}}],
        "a valid string",
    ),
    ("fits", [[1, 2]], "design.fits"),
    ("fits", [], "design: fits must hold the branches of the height density"),
    ("density.scale", -1.0, "design.density: scale = -1 must be greater than 0"),
    ("limits.max_height", 1e308, "design.limits: max_height = 1e\\+308 is outside the range"),
    ("notes", "all well", "design.notes = 'all well' must be a valid tuple"),
    (
        "target",
        {"type": "Friction", "shear_strength": 0.4, "area_ratio": 0.85},
        "design.target = .* must be an instance of Target",
    ),
]


@pytest.mark.parametrize(("place", "value", "message"), WRONG)
def test_a_damaged_member_is_named(tmp_path, linear, place, value, message):
    mf.save(linear[1], tmp_path / "out")
    path = tmp_path / "out" / "design.json"
    record = json.loads(path.read_text())
    *parents, last = place.split(".")
    member = record["design"]
    for parent in parents:
        member = member[parent]
    member[last] = value
    path.write_text(json.dumps(record))
    with pytest.raises(mf.InvalidInput, match=message) as error:
        mf.load(tmp_path / "out")
    assert str(error.value).startswith(f"{path} is damaged: design")
    assert len(str(error.value).splitlines()) == 1


def test_a_law_whose_loads_fall_or_areas_are_negative_is_refused(linear):
    law = linear[1].law
    with pytest.raises(mf.InvalidInput, match="the loads of a law must not decrease"):
        replace(law, rescaled_load=law.rescaled_load[::-1].copy())
    with pytest.raises(mf.InvalidInput, match=r"area\[0\] = -.* is impossible"):
        replace(law, area=-law.area)


def test_the_hardness_of_the_specification_is_kept(tmp_path, linear):
    spec, design = linear
    mf.save(design, tmp_path / "with", specification=replace(spec, hardness=10.0))
    mf.save(design, tmp_path / "without")
    assert (stored_hardness(tmp_path / "with"), stored_hardness(tmp_path / "without")) == (10.0, None)
    (tmp_path / "design.json").write_text('{"format": "metafem design 1"}')
    with pytest.raises(mf.InvalidInput, match="is damaged: 'specification'"):
        stored_hardness(tmp_path)


def test_force_removes_old_studies(tmp_path, linear):
    spec, design = linear
    folder = tmp_path / "out"
    mf.save(design, folder, specification=spec)
    write_text(folder / "interaction.nc", "of the old design")
    with pytest.raises(mf.InvalidInput, match="exists"):
        mf.save(design, folder)
    mf.save(design, folder, force=True)
    assert mf.load(folder).misfit == design.misfit
    assert not (folder / "interaction.nc").exists()
    assert not (folder / "spec.toml").exists()


def test_a_changed_specification_of_a_folder_is_designed_into_it(tmp_path, linear):
    spec, design = linear
    folder = tmp_path / "out"
    mf.save(design, folder, specification=spec)
    text = spec.text.replace("seed = 0", "seed = 1")
    (folder / "spec.toml").write_text(text, encoding="utf-8")
    with pytest.raises(mf.InvalidInput, match=r"spec\.toml was changed since metafem wrote it"):
        mf.save(design, folder, specification=spec, force=True)
    again = mf.read_spec(folder / "spec.toml")
    mf.save(again.design(), folder, specification=again, force=True)
    assert (folder / "spec.toml").read_text(encoding="utf-8") == text
    mf.save(design, folder, specification=spec, force=True)


def test_a_full_disk_is_reported_and_leaves_nothing(tmp_path, linear):
    resource = pytest.importorskip("resource")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, hard))
    try:
        with pytest.raises(mf.InvalidInput, match="cannot be written: File too large"):
            mf.save(linear[1], tmp_path / "out")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert list(tmp_path.iterdir()) == []


def test_a_design_that_was_replaced_is_noticed(tmp_path, linear):
    _, design = linear
    mf.save(design, tmp_path / "out")
    still = same_design(tmp_path / "out")
    still()
    mf.save(replace(design, misfit=0.5 * design.misfit), tmp_path / "out", force=True)
    with pytest.raises(mf.InvalidInput, match="was replaced in the meantime"):
        write_text(tmp_path / "out" / "report.html", "of the old design", still=still)
    assert not (tmp_path / "out" / "report.html").exists()


def test_loading_names_the_earlier_folder_of_a_killed_run(tmp_path, linear):
    mf.save(linear[1], tmp_path / "out")
    (tmp_path / "out").rename(tmp_path / "out.old")
    with pytest.raises(mf.InvalidInput, match="no such file; name a result folder"):
        mf.load(tmp_path)
    with pytest.raises(mf.InvalidInput, match=r"design\.json: no such file; .* complete as .*out\.old"):
        mf.load(tmp_path / "out")


def test_a_file_is_no_result_folder(tmp_path, linear):
    mf.save(linear[1], tmp_path / "out")
    with pytest.raises(mf.InvalidInput, match=r"design\.json is a file; name a result folder .* here .*out$"):
        mf.load(tmp_path / "out" / "design.json")
    with pytest.raises(mf.InvalidInput, match='folder = "" is an empty name'):
        mf.save(linear[1], "")


def test_the_numbers_of_notes_are_kept(tmp_path, linear):
    notes = (mf.Note("a", quantity="q", value=0.1, bound=0.2, remedies=("offset",)), mf.Note("b"))
    mf.save(replace(linear[1], notes=notes), tmp_path / "noted")
    kept = mf.load(tmp_path / "noted").notes
    assert [vars(note) for note in kept] == [vars(note) for note in notes]
