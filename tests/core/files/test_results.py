"""The result folder of a design: its files, keys, columns and guards."""

import csv
import io
import json
import math
import re
from dataclasses import replace

import meshio
import numpy as np
import pytest
import xarray as xr

import metafem as mf
from metafem import files
from metafem.caps import Caps
from metafem.files.disk import RESERVED
from metafem.files.part import drilling_program, mould_table, with_alignment
from metafem.files.result import from_record, written
from metafem.files.summits import write_surface
from metafem.models.curve import ModelError
from tests.core.files.specs import small
from tests.core.files.test_files import MIXED


def columns(table):
    """Return the columns of a table; those of numbers as arrays."""
    rows = list(csv.reader(line for line in io.StringIO(table) if not line.startswith("#")))
    assert len({len(row) for row in rows}) == 1
    found = dict(zip(rows[0], map(list, zip(*rows[1:], strict=True)), strict=True))
    return {name: number(column) for name, column in found.items()}


def number(column):
    try:
        return np.array(column, float)
    except ValueError:
        return column


# Names of the files of a folder.
NAMES = "block.stl design.json heights.csv law.csv mould.csv mould.gcode mould.stl report.html spec.toml"


@pytest.fixture
def folder(tmp_path):
    """The result folder of the small design."""
    spec, design = small()
    mf.save(design, tmp_path / "out", specification=spec, pages={"report.html": "<p>µ</p>"})
    return tmp_path / "out"


def test_the_folder_holds_all_files_and_the_record_its_keys(folder):
    spec, design = small()
    names = {path.name for path in folder.iterdir()}
    assert sorted(names) == [*NAMES.split(), "surface.vtu"]
    assert names <= RESERVED
    assert (folder / "spec.toml").read_text("utf-8") == spec.text
    assert (folder / "report.html").read_text("utf-8") == "<p>µ</p>"
    record = json.loads((folder / "design.json").read_text("utf-8"))
    assert list(record) == ["format", "versions", "hardness", "design"]
    assert list(record["versions"]) == ["python", "metafem", "numpy", "scipy", "numba", "meshio"]
    assert record["versions"]["numpy"] == np.__version__
    found = record["design"]
    assert found["surface"]["height"] == {"float64": design.surface.height.tolist()}
    assert found["sites"] == {"int64": design.sites.tolist()}
    assert found["law"]["area"] == {"float64": design.law.area.tolist()}
    assert found["status"] == {"type": "DesignStatus", "name": "EXACT", "message": design.status.value}
    assert files.stored_hardness(folder) == 10.0


def test_heights_law_and_mould_have_their_columns(folder):
    _, design = small()
    surface, law = design.surface, design.law
    heights = columns((folder / "heights.csv").read_text("utf-8"))
    assert list(heights) == ["site", "x_mm", "y_mm", "height_mm", "radius_mm"]
    expected = [design.sites + 1, *surface.position.T, surface.height, surface.radius]
    np.testing.assert_allclose(list(heights.values()), expected, rtol=1e-12)
    found = columns((folder / "law.csv").read_text("utf-8"))
    names = ("load", "area", "separation", "rescaled_load", "rescaled_friction", "friction_force")
    units = ("N", "mm2", "mm", "mm2", "mm2", "N")
    assert list(found) == [f"{name}_{unit}" for name, unit in zip(names, units, strict=True)]
    for column, name in zip(found.values(), names, strict=True):
        np.testing.assert_allclose(column, getattr(law, name), rtol=1e-12)
    holes = columns((folder / "mould.csv").read_text("utf-8"))
    assert list(holes) == ["number", "kind", "site", "x_mm", "y_mm", "depth_mm", "tool_radius_mm"]
    whole = with_alignment(surface, design.template, 0.4)
    n = surface.count
    assert holes["number"].tolist() == list(range(1, n + 5))
    assert holes["kind"] == ["asperity"] * n + ["alignment"] * 4
    assert holes["site"] == [*map(str, design.sites + 1), *[""] * 4]
    np.testing.assert_allclose(holes["x_mm"], -whole.position[:, 0], atol=5e-6)  # seen from the open face
    np.testing.assert_allclose(holes["y_mm"], whole.position[:, 1], atol=5e-6)
    np.testing.assert_allclose(holes["depth_mm"], [*surface.height, *[0.4] * 4], atol=5e-6)
    assert set(holes["tool_radius_mm"]) == {0.526}
    text = (folder / "mould.csv").read_text("utf-8")
    assert "-0.0000" not in text
    for words in ("in mm, seen from its open face", "Origin: centre of the block", "20 by 20 mm"):
        assert words in text
    assert "0.9 um" in mould_table(replace(design, limits=mf.Limits(0.12, height_sd=9e-4)), whole)


def holes_of(program):
    """Return the holes of a drilling program: X, Y and depth where the tool goes below 0, and its moves."""
    place, holes, state = {}, [], set()
    for line in program.splitlines():
        words = dict(re.findall(r"([A-Z])(-?[0-9.]+)", re.sub(r"\(.*?\)", "", line)))
        state |= {f"G{words['G']}"} if "G" in words else set()
        before, place = place, {**place, **{axis: float(words[axis]) for axis in "XYZ" if axis in words}}
        if place.get("Z", 1.0) < 0.0:
            assert words["G"] in "14"
            assert (before["X"], before["Y"]) == (place["X"], place["Y"])
            holes += [(place["X"], place["Y"], -place["Z"])] if words["G"] == "1" else []
        assert not {"X", "Y"} & words.keys() or place["Z"] == 5.0
    return np.array(holes), state


def test_the_program_drills_the_holes_of_the_table(folder):
    program = (folder / "mould.gcode").read_text("ascii")
    table = columns((folder / "mould.csv").read_text("utf-8"))
    found, state = holes_of(program)
    np.testing.assert_allclose(found.T, [table["x_mm"], table["y_mm"], table["depth_mm"]], atol=1e-4)
    assert {"G21", "G90", "G54"} <= state
    assert program.count("G4 P0.5") == len(found)
    assert re.findall(r"[TF]\d+|S\d+ M3|M\d+$", program, re.M)[-2:] == ["M5", "M30"]
    comments = " ".join(re.findall(r"^\(([^()]*)\)$", program, re.M))
    for words in (
        *(f"{len(found)} holes", "0.52600 mm", "deepest hole 0.40000 mm", "check this program"),
        *("Casting: 20 by 20 mm", "7.2 mm above the face", "Tolerance: not stated"),
    ):
        assert words in comments
    options = files.PartSection(feed="30 mm/min", spindle="6000 1/min", dwell="0 s", safe_height="2 mm")
    design = small()[1]
    surface = design.surface
    other = drilling_program(design, surface, options)["mould.gcode"]
    assert all(words in other for words in ("F30\n", "S6000 M3\n", "G0 Z2.00000"))
    assert "G4" not in other
    assert drilling_program(design, surface.replaced(cap=mf.Power(4)), options) == {}


def test_the_heads_for_the_workshop_have_the_tolerance_of_the_study(tmp_path):
    design, folder = small()[1], tmp_path / "made"
    mf.save(replace(design, limits=replace(design.limits, height_sd=9e-4)), folder)
    heads = [folder / name for name in ("mould.csv", "mould.gcode")]
    before = [path.read_text("ascii") for path in heads]
    assert all("Tolerance: standard deviation of the depths 0.9 um, from limits" in text for text in before)
    study = mf.studies.manufacturing(design.surface, [1e-4, 2e-4], draws=20)
    files.write_study(study, files.study_path(folder, "manufacturing", False))
    for path, old in zip(heads, before, strict=True):
        new = path.read_text("ascii")
        differing = [(a, b) for a, b in zip(old.splitlines(), new.splitlines(), strict=True) if a != b]
        ((_, line),) = differing
        assert re.fullmatch(
            r"# Tolerance: .*0\.2 um \[SD\].*|\(Tolerance: [^()]*0\.2 um \[SD\][^()]*\)", line
        )


def test_caps_cells_and_errors_have_columns_where_they_differ():
    heights = columns(files.heights_table(MIXED, np.arange(4)))
    assert list(heights)[4:] == ["radius_mm", "cap"]
    assert heights["cap"] == ["power 4.0 0.3", "sphere", "paraboloid", "power 4.0 0.3"]
    assert "0.147" in files.heights_table(MIXED, np.arange(4))  # 0.1 + 0.047 without its rounding error
    _, design = small()
    caps = design.surface.replaced(cap=mf.Power(4, 0.3))
    assert columns(mould_table(design, caps))["cap"] == ["power 4.0 0.3"] * caps.count
    lattice = design.surface.replaced(cell=mf.PeriodicCell(4.5, 5.0))
    law = mf.friction_law(lattice, load=[0.01, 0.02])
    table = columns(files.result_tables(replace(design, law=law), files.PartSection())["law.csv"])
    assert list(table)[6:] == ["nominal_pressure_MPa", "nominal_shear_stress_MPa"]
    np.testing.assert_allclose(table["nominal_pressure_MPa"], law.load / 22.5, rtol=1e-12)
    np.testing.assert_allclose(table["nominal_shear_stress_MPa"], law.friction_force / 22.5, rtol=1e-12)
    bare = mf.friction_law(design.surface.replaced(friction=None), load=[0.01])
    assert "friction_force_N" not in files.law_table(bare)


def test_tables_of_summits_are_read_with_other_units_separators_and_decimals(tmp_path):
    path, material = tmp_path / "heights.csv", mf.Material(1.36)
    for table in (
        "x_mm;y_mm;height_um;radius_mm\n0;0;120,5;0,5\n15e-1;0;94,3;0,5\n",
        "x_mm\ty_cm\theight_um\tradius_um\n0\t0\t120,5\t500\n1,5\t0\t94,3\t500\n",
        "# cold; d\nby,X (mm),y_mm,Height [nm],radius_mm\n  # first\na,0,0,120500,0.5\r\nb,1.5,0,94300,.5",
    ):
        path.write_bytes(table.encode("utf-8-sig"))
        surface = files.read_surface(path, material)
        assert surface == mf.Surface([[0.0, 0.0], [1.5, 0.0]], [0.1205, 0.0943], 0.5, material)


def test_the_field_file_holds_the_contacts_at_the_largest_load(folder, tmp_path):
    _, design = small()
    mesh = meshio.read(folder / "surface.vtu")
    surface, load = design.surface, design.law.load[-1]
    np.testing.assert_array_equal(mesh.points.T, [*surface.position.T, surface.height])
    data = mesh.point_data
    assert list(data) == ["site", "height", "radius", "load", "area", "contact_radius"]
    np.testing.assert_array_equal(data["site"], design.sites + 1)
    np.testing.assert_array_equal(data["radius"], surface.radius)
    np.testing.assert_allclose(data["load"].sum(), load, rtol=1e-12)
    np.testing.assert_allclose(data["area"].sum(), design.law.area[-1], rtol=1e-12)
    np.testing.assert_allclose(np.pi * data["contact_radius"] ** 2, data["area"], rtol=1e-12)
    hertz = 4.0 / 3.0 * 1.36 * data["contact_radius"] ** 3 / 0.526
    np.testing.assert_allclose(data["load"], hertz, rtol=1e-9)
    mixed = MIXED.replaced(cap=Caps.of([mf.Power(4), mf.Sphere(), mf.Power(4), mf.Sphere()]))
    law = mf.friction_law(mixed, mf.Independent(mf.Elastic()), load=[0.1])
    other = replace(design, surface=mixed, law=law, sites=np.arange(4), template=mixed)
    write_surface(other, tmp_path / "a.vtu")
    data = meshio.read(tmp_path / "a.vtu").point_data
    assert data["cap"].tolist() == [0, 1, 0, 1]


def through_json(value):
    return from_record(json.loads(written(value)))


CAPS = [mf.Hertz(), mf.Elastic()]
OF_MATERIALS = [
    *(mf.JKR(9e-6), mf.JKR(9e-6, mf.Elastic()), mf.KogutEtsion(10.0), mf.JacksonGreen(4.0)),
    mf.TabulatedContact([0.0, 0.01, 0.02, 0.04], [0.0, 0.1, 0.3, 0.8], [0.0, 0.01, 0.02, 0.05]),
]


def test_every_value_is_read_back_from_its_record():
    laws = [*CAPS, *OF_MATERIALS, *(law.for_material(mf.Material(1.0)) for law in OF_MATERIALS)]
    lattice = small()[1].surface.replaced(cell=mf.PeriodicCell(4.5, 4.5))
    values = [
        *(make() for make in files.MODELS.values()), *(mf.Independent(law) for law in laws), lattice, MIXED,
        mf.Surface([[1e-7, -1.0 / 3.0]], [1e7], 1e7 / 3.0, mf.Material(1e-30)),
        mf.LinearLaw(1.0 / 3.0), mf.LinearLaw(6.87, (0.1, 0.2)),
        mf.PowerLaw(1.2, (0.1, 0.4), 7.0),
        mf.BilinearLaw((7.15, 12.52), 0.038), mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26)),
        mf.SampledLaw([0.1, 0.2], [0.8, 1.5], weight=[1.0, 2.0]), mf.Band([0.1], [0.8], [0.9]),
        mf.Tool(0.3, mf.Power(4)),
        mf.RadiusRange(0.2, 0.8), mf.PowerRange(1.2, 6.0), mf.friction_law(lattice, load=[0.01, 0.02]),
        mf.friction_law(MIXED, mf.Independent(mf.Elastic()), load=[0.1]), mf.DesignStatus.EXACT,
    ]  # fmt: skip
    target, limits = mf.OperatingPoints([0.02], [0.2]), mf.Limits(0.12, height_step=0.006, height_sd=0.01)
    limits = replace(limits, pinned={8: 0.1, 3: None})
    for options in ({"limits": limits}, {"tools": [0.3, 0.526]}):
        values.append(mf.design(target, small()[1].template, **options))
        notes = through_json(values[-1]).notes
        assert [vars(note) for note in notes] == [vars(note) for note in values[-1].notes]
    for value in values:
        assert through_json(value) == value
    notes = (mf.Note("a", quantity="q", value=0.1, bound=0.2, remedies=("offset",)), mf.Note("b"))
    assert [vars(note) for note in through_json(notes)] == [vars(note) for note in notes]
    unknown = mf.friction_law(lattice, load=[0.01])
    error = through_json(replace(unknown, model_error=ModelError(math.nan, "no reason"))).model_error
    assert math.isnan(error)
    assert error.source == "no reason"


def test_a_damaged_member_is_named(folder):
    whole = (folder / "design.json").read_text("utf-8")
    n, site = small()[1].surface.count, small()[1].sites[0]
    for place, value, message in (
        ("sites.int64", [10**30] * n, "too large"),
        ("sites.int64", [0] * n, f"its Design cannot be made: sites must hold {n} different sites"),
        ("misfit", "small", "its Design"), ("misfit", -1.0, "misfit = -1"),
        ("status", {"type": "Status", "name": "FINE"}, "its Status cannot be made: 'FINE'"),
        ("template.pitch", 3, "its Surface cannot be made"),
        ("surface.position.float64", [[i, 0.0] for i in range(n)], "surface.position"),
        ("surface.height.float64", [[0.1], [0.1, 0.2]], "shape"),
        ("law.material.composite_modulus", 2.0, "law.material"),
        ("limits.max_height", 1e308, "its Limits cannot be made: max_height = 1e+308"),
        ("limits.type", "os.system", "its os.system cannot be made"),
        ("law.friction.way", 2, "its Friction cannot be made"),
        ("pinned", {f"{site}": None}, f"site {site}"),
    ):  # fmt: skip
        record = json.loads(whole)
        *parents, last = place.split(".")
        member = record["design"]
        for parent in parents:
            member = member[parent]
        member[last] = value
        (folder / "design.json").write_text(json.dumps(record), "utf-8")
        with pytest.raises(mf.InvalidInput) as error:
            mf.load(folder)
        (words,) = str(error.value).splitlines()
        assert words.startswith(f"{folder / 'design.json'} is damaged: ")
        assert message in words, place


def test_only_force_replaces_a_result_and_its_studies(folder):
    spec, design = small()
    files.write_text(folder / "interaction.nc", "of the old design")
    mf.save(replace(design, misfit=0.5 * design.misfit), folder, force=True)
    assert not {"interaction.nc", "spec.toml"} & {path.name for path in folder.iterdir()}
    assert files.stored_hardness(folder) is None
    (folder / "spec.toml").write_text(spec.text.replace("10 MPa", "20 MPa"), "utf-8")
    again = mf.read_spec(folder / "spec.toml")  # the changed file itself
    mf.save(design, folder, specification=again, force=True)
    assert files.stored_hardness(folder) == 20.0


def test_a_folder_that_cannot_be_used_is_named(folder, tmp_path):
    spec, _ = small()
    folder.rename(tmp_path / "out.old")
    with pytest.raises(mf.InvalidInput, match=r"design\.json: no such file; name a result folder"):
        mf.load(folder)
    close = spec.template.replaced(position=0.2 * spec.template.position)
    with pytest.raises(mf.InvalidInput, match="overlap"):
        mf.save(mf.design(spec.target, close, limits=spec.limits), tmp_path / "none")
    assert [path.name for path in tmp_path.iterdir()] == ["out.old"]
    bare = mf.design(spec.target, spec.template.replaced(block=None), limits=spec.limits)
    mf.save(bare, tmp_path / "bare")
    assert not (tmp_path / "bare/block.stl").exists()
    record = json.loads((tmp_path / "bare/design.json").read_text("utf-8"))
    assert record["hardness"] is None


def test_studies_are_kept_by_name_and_become_plain_data(folder):
    path = files.study_path(folder, "interaction", False)
    study = xr.Dataset(
        {"slope": (("load",), [1.0, math.nan], {"units": "mm"}), "count": ((), 3)},
        attrs={"study": "interaction", "notes": "", "draws": 20},
    )
    files.write_study(study, path)
    assert files.stored_studies(folder).keys() == {"interaction"}
    with pytest.raises(mf.InvalidInput, match="exists"):
        files.study_path(folder, "interaction", False)
    assert files.study_data(study) == {
        "study": "interaction", "notes": [], "draws": 20,
        "coords": {}, "dims": {"load": 2},
        "data_vars": {
            "slope": {"dims": ["load"], "attrs": {"units": "mm"}, "data": [1.0, None]},
            "count": {"dims": [], "attrs": {}, "data": 3},
        },
    }  # fmt: skip
    assert files.plain_data({"a": (np.arange(2), math.inf)}) == {"a": [[0, 1], None]}
    path.rename(folder / "fidelity.nc")
    with pytest.raises(mf.InvalidInput, match=r"fidelity\.nc is not a study 'fidelity'"):
        files.stored_studies(folder)
