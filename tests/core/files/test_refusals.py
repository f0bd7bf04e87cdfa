"""Wrong input is refused with the key and the value that was given."""

import os
import tomllib
from functools import partial

import numpy as np
import pytest
from jsonschema import Draft7Validator

import metafem as mf
from metafem import files
from metafem.files.disk import SPECIFICATION, TABLE
from metafem.files.laws import columns_of
from metafem.files.result import written
from metafem.files.specification import model_named
from metafem.files.specification.forms import whole_schema
from tests.core.files.specs import SHAPE, spec, text
from tests.refusals import faults

MATERIAL = mf.Material(1.36)
POINTS = 'rescaled_load = ["0.1 mm^2", "0.2 mm^2"]\nrescaled_friction = ["0.8 mm", "1.5 mm"]'
SAMPLED = 'kind = "sampled"\nfile = "w.csv"'
LINEAR = 'kind = "linear"'
JKR = 'kind = "jkr"\nadhesion_energy = "9 mJ/m^2"'
TOOLS = 'radii = ["0.3 mm", "0.4 mm"]'
BLOCK = mf.Block(8.0, 7.0, 3.0)
PART = mf.Surface.square_lattice(0.2, (2, 3), 1.5, radius=0.526, material=MATERIAL, block=BLOCK)
PAIR = mf.Surface([[0.0, 0.0], [0.6, 0.0]], [0.1, 0.1], 0.526, MATERIAL, block=BLOCK)


def of_spec(tables=None, **sections):
    """Return a call that reads a specification with these sections."""

    def call(folder):
        spec(tables, **sections)

    call.sections = sections
    return call


def linear(keys):
    return of_spec(target=f"{LINEAR}\n{keys}")


def tools(keys, **sections):
    return of_spec(lattice=SHAPE, tools=keys, **sections)


def of_file(read, content, name="t.csv"):
    """Return a call that reads a file with this content."""

    def call(folder):
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        return read(folder / name)

    return call


def of_value(call, *given, **options):
    return lambda folder: call(*given, **options)


def large(size):
    """Return the content of a file of this size plus one byte."""
    return b" " * (size + 1)


quantity = files.quantity
length = partial(of_value, quantity, "limits.max_height", unit="mm")


def design_json(content, read=mf.load):
    return of_file(lambda path: read(path.parent), content, "design.json")


def calibration(path, **options):
    return files.read_calibration([path], **options)


def pipe(folder):
    os.mkfifo(folder / "pipe")
    mf.read_spec(folder / "pipe")


def planned(part, **options):
    """Return a call that plans the files of a part."""
    return lambda folder: files.planned(part, part, files.PartSection(**options))


REFUSALS = [
    # targets
    (linear("slope = -1"), "target.slope", "-1"),
    (linear("slope = 1979-05-27"), "target.slope", "1979-05-27"),
    (linear('slope = 6\nload_range = ["0.3 N", "0.2 N"]'), "target.load_range[1]", "0.2 N"),
    (of_spec(target=f'kind = "sampled"\n{POINTS}'), "target.rescaled_friction", "0.8 mm"),
    (of_spec(target='kind = "multilinear"\nslopes = [6, 7]\ncrossover_loads = [[]]\nload_range = ["1 N"]'),
     "target.crossover_loads[0]", "[]"),
    (of_spec(target='kind = "linear"\nfriction_coefficient = 1.5', friction=None), "friction_coefficient",
     "[friction]"),
    (of_spec(target='kind = "operating-points"\nload = ["1 N"]\nfriction_force = ["1 N"]', friction=None),
     "target.friction_force", "[friction]"),
    (linear(""), "target", "friction_coefficient"),
    (of_spec(target=f'{LINEAR}\nslope = 6\nfriction_coefficient = 1'), "target",
     "has slope and friction_coefficient"),
    (linear("slope = 6\nlinear = 3"), "target.linear", "unknown key"),
    # other sections
    (of_spec(friction='shear_strength = "1 MPa"\narea_ratio = -0.5'), "friction.area_ratio", "-0.5"),
    (of_spec(friction='shear_strength = "1 MPa"\narea_ratio = 87'), "friction.area_ratio", "0.85"),
    (of_spec(lattice=SHAPE), "lattice.radius", "526 um"), (of_spec(tools=TOOLS), "lattice.radius", "[tools]"),
    (of_spec(lattice='shape = [3000, 3000]\npitch = "1 mm"\nradius = "1 mm"'), "lattice.shape", "9,000,000"),
    (tools(f'{TOOLS}\nstep = "10 um"'), "tools.step", "radius_range"),
    (tools('radii = ["0 mm"]'), "tools.radii[0]", '"0 mm" must be greater'),
    (tools('radius_range = ["2 mm", "1 mm"]'), "tools.radius_range", "must increase"),
    (of_spec(sites="empty = [3, 65]"), "sites.empty", "the sites 1 to 64"),
    (of_spec(sites="empty = [3, 3]"), "sites.empty", "site 3 twice"),
    (of_spec(sites=f"empty = {list(range(1, 65))}"), "sites", "all 64"),
    (of_spec(sites='pinned = [3, 4]\nheights = ["1 um"]'), "sites.heights", "1 entries"),
    (of_spec(sites='pinned = [3]\nheights = ["300 um"]'), "sites.heights[0]", "must be at most 0.204"),
    (of_spec(sites='pinned = [3]\nheights = ["0 um"]'), "sites.heights[0]", "is no summit of a part"),
    (of_spec(cell='width = "5 mm"'), "cell.width", "5 mm"),
    (of_spec(contact='kind = "sphere"'), "contact.kind", "sphere"),
    (of_spec(limits='max_height = "600 um"'), "limits.max_height", "height 0.6 mm"),
    (of_spec(lattice='shape = [8, 8]\npitch = "0.75 mm"\nradius = "526 um"'), "limits.max_height",
     "0.156 mm high"),
    (of_spec(block='width = "20 mm"\nlength = "11 mm"\nthickness = "7 mm"'), "block.length", "20 by 11 mm"),
    (of_spec(part='alignment_height = "600 um"'), "part.alignment_height", '"600 um" exceeds'),
    (lambda folder: spec(block=None, model='kind = "layer"').design(), "layer", "[block]"),
    # tables that a specification names
    (of_spec({"a.csv": ""}, target=SAMPLED), "target.file", "a.csv"),
    (of_spec(target='kind = "sampled"\nfile = 3'), "target.file", "3"),
    (of_spec(target='kind = "sampled"\nfile = "a/.."'), "target.file", "a/.."),
    (of_spec({"w.csv": "load_N,area_mm2\n1,1\n"}, target=f'{SAMPLED}\nload = ["1 N"]'), "target.file",
     "load"),
    (of_spec({"law.csv": "load_N,area_mm2\n1,1\n"}, target='kind = "sampled"\nfile = "law.csv"'),
     "target.file", "law.csv"),
    (of_spec({"w.csv": "rho_mm,f_mm\n0,0\n1,1\n"}, target=SAMPLED, cap='kind = "profile"\nfile = "a/w.csv"'),
     "file", "w.csv"),
]  # fmt: skip


def of(table, folder):
    """Return a table of refusals whose calls have a folder."""
    return [(partial(call, folder), key, value) for call, key, value in table]


# Names, types and choices of keys, which the schema refuses too.
KEYS = [
    (of_spec(limit=""), "limit", "limits"), (of_spec(limits=None), "limits", "[limits]"),
    (of_spec(lattice="shape = [8, 8]"), "lattice.pitch", "1.5 mm"),
    (of_spec(target="slope = 6"), "target.kind", "operating-points"),
    (of_spec(target='kind = "linaer"'), "target.kind", '"linaer"'),
    (linear('slope = "6"'), "target.slope", '"6"'),
    (of_spec(lattice='shape = 8\npitch = "1 mm"'), "lattice.shape", "must be a valid list"),
    (of_spec(lattice='shape = [8.5, 8]\npitch = "1 mm"'), "lattice.shape[0]", "8.5 must be a valid integer"),
    (of_spec(sites="empty = [0]"), "sites.empty[0]", "0 must be greater than or equal to 1"),
    (tools("radii = []"), "tools.radii", "[] must have at least 1 item"),
    (of_spec(model='kind = "flat"'), "model.kind", '"flat"'),
    (of_spec(limits="max_height = 120"), "limits.max_height", "120 needs a unit"),
    (of_spec(contact=f'{JKR}\ncap.kind = "jkr"'), "contact.cap.kind", '"jkr"'),
]  # fmt: skip


def test_what_the_parser_refuses_is_marked_by_the_schema(tmp_path):
    editor = Draft7Validator(whole_schema())
    assert editor.is_valid(tomllib.loads(text()))
    assert faults(of(KEYS, tmp_path)) == []
    for call, key, _ in KEYS:
        assert not editor.is_valid(tomllib.loads(text(**call.sections))), key


def test_wrong_input_is_refused_by_its_key_and_value(tmp_path):
    assert faults(of(REFUSALS, tmp_path)) == []


# Refusals at the other borders.
BORDERS = {
    "units": [
        (length(120.0), "limits.max_height", "120"), (length(["1 mm"]), "limits.max_height", "1 mm"),
        (length("120 foo"), "limits.max_height", "foo"), (length("120 MPa"), "limits.max_height", "120 MPa"),
        (length("1,5 mm"), "limits.max_height", "decimals with a point"),
        (length("1e999 mm"), "limits.max_height", "1e999"),
        (length("9**9**9 mm"), "limits.max_height", "9**9**9"),
        (of_value(quantity, "--misfit", "3", "%"), "--misfit", '"5 %"'),
        (of_value(quantity, "area_ratio", "85 %", "1"), "area_ratio", "85 %"),
    ],
    "texts": [
        (of_file(mf.read_spec, "[lattice]\nshape = [8"), "t.csv", "line 2"),
        (of_value(files.parsed, "a = '\ud800'"), "spec.toml", "line 1 is not UTF-8"),
        (of_value(files.parsed, "a = " + "[" * 9000), "spec.toml", "recursion"),
        (of_value(files.parsed, " " * (SPECIFICATION + 1)), "spec.toml", "0.25 MiB"),
        (of_file(mf.read_spec, large(SPECIFICATION)), "t.csv", "0.25 MiB"),
        (of_file(lambda path: mf.read_spec(path).design(), text(limits='max_height = "600 um"')), "t.csv",
        "limits.max_height"),
        (pipe, "pipe", "a device or a pipe"), (mf.read_spec, "read", "a folder"),
        (of_value(mf.read_spec, "a\0"), r"a\x00", "no such file"),
        (lambda folder: mf.read_spec(folder / "none"), "none", "no such file"),
        (design_json("[" * 100_000), "design.json", "recursion"), (design_json("{"), "design.json", "line 1"),
    ],
    "names": [
        (of_value(files.contact_named, "jkrr 4"), "jkrr", "jkr?"),
        (of_value(files.contact_named, "hertz 3"), "contact.3", "unknown"),
        (of_value(files.contact_named, "jkr -1 N/m"), "adhesion_energy", "-1"),
        (of_value(model_named, "layr"), "model", "layr"),
        (of_value(files.demo_text, "lineal"), "lineal", "linear"),
    ],
    "results": [
        (design_json("[]"), "design.json", "metafem design 2"),
        (design_json('{"format": "metafem design 1"}'), "design.json", "metafem design 2"),
        (of_file(mf.load, "", "design.json"), "design.json", "a file"),
        (design_json('{"format": "metafem design 2", "design": 3}'), "design.json", "design = 3"),
        (design_json('{"format": "metafem design 2", "hardness": -1}', files.stored_hardness),
        "hardness", "-1"),
        (lambda folder: mf.save("design", folder / "out"), "design", "'design'"),
        (of_value(written, mf.Profile(np.square, extent=0.3)), "square", "function as a table"),
        (lambda folder: files.study_path(folder, "interaction", False), "design.json", "no such file"),
        (of_file(files.read_parameters, "{}"), "t.csv", "metafem calibrate"),
        (planned(PART.replaced(height=[0.1, 0.1, 0.0, 0.1, 0.1, 0.1])), "(1.5, -0.75)", "height 0 mm"),
        (planned(PART.replaced(height=[0.1, 0.6, 0.1, 0.1, 0.1, 0.1])), "(0, -0.75)", "height 0.6"),
        (planned(PART.replaced(block=mf.Block(6.8, 7.0, 3.0)), alignment_height="0.4 mm"),
        "part.alignment_height", "6.8 by 7 mm"),
        (planned(PAIR.replaced(position=[[0, 0]], height=[0.1], radius=[0.5]), alignment_height="0.3 mm"),
        "part.alignment_height", "two sites"),
        (planned(PAIR, alignment_height="0.2 mm"), "overlap", "(0.6, 0) mm"),
    ],
}  # fmt: skip


@pytest.mark.parametrize("border", BORDERS)
def test_other_borders_refuse_by_key_and_value(border, tmp_path):
    for i, row in enumerate(BORDERS[border]):
        (tmp_path / f"{i}").mkdir()
        assert faults(of([row], tmp_path / f"{i}")) == []


# Tables that each reader refuses, by line, column and entry.
SURFACE = "x_mm,y_mm,height_um,radius_um"
IMAGES = "image,load_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2"
FIRST = f"{IMAGES}\na,.05,1,3,0,0,.1,.01\n"
TABLES = {
    partial(files.read_surface, material=MATERIAL): [
        ("", "t.csv", "empty"), ("x_mm:y_mm\n", "t.csv", "x_mm:y_mm"),
        (f"{SURFACE}\n0,0,5\n", "line 2", "3 entries"),
        ("x_mm,y_mm,height,radius_um\n", "height", "height_um"),
        ("x_mm,y_mm,height_N,radius_um\n", "height_N", '"N"'),
        ("x_mm,y_mm,height_um,height_mm\n", "height", "two columns"), (f"{SURFACE}\n", "t.csv", "summit"),
        (f"{SURFACE}\n# a\n0,0,nan,5\n", "line 3: height_um", "'nan'"),
        (f"{SURFACE}\n0,0,1e999,5\n", "height_um", "1e999"),
        (f"{SURFACE}\n0,0,5,5\n\n1,0,5,-5\n", "line 4: radius_um", "-5"),
        (f'{SURFACE}\n0,0,"0\n,5",5\n', "line 3", r"0\n,5"), (b"x_mm,\0\n", "t.csv", "null"),
        ("x_mm,y_mm,height_um\n0,0,5\n", "radius_um", "--radius"),
        (f"{SURFACE},cap\n0,0,5,5,cone\n", "cap", "cone"),
        (f"{SURFACE},cap\n0,0,5,5,power x\n", "cap", "power x"),
    ],
    partial(files.read_surface, material=MATERIAL, radius=0.5, friction=mf.Friction(1.0)): [
        (f"{SURFACE}\n0,0,5,5\n", "radius", "--radius"),
    ],
    partial(files.read_measured_law, material=MATERIAL): [
        ("load_N,friction_force_N\n1,1\n", "t.csv", "--area-ratio"),
        ("load_N,area_mm2,friction_force_sd_mN\n1,1,1\n", "friction_force_sd_mN", "without friction_force"),
    ],
    partial(files.read_measured_law, material=MATERIAL, sites=np.arange(2)): [(FIRST, "site", "3")],
    files.read_sites: [
        ("x_mm,y_mm,depth_mm\n", "t.csv", "heights.csv"), ("site,x_mm,y_mm\n1.5,1,1\n", "site", "'1.5'"),
        ("site,x_mm,y_mm\n1,1,1\n1,2,2\n", "line 3: site", "'1' is"), (large(TABLE), "t.csv", "64 MiB"),
    ],
    partial(columns_of, kind="sampled"): [
        ("load_N,area_mm2\n0,2\n", "line 2: load_N", "0"),
        ("load_N,area_mm2,area_sd_mm2,relative_error\n1,2,1,1\n", "relative_error", "area_sd"),
        ("load_N,load_sd_N,area_mm2\n1,2,3\n", "t.csv", "sample 1"),
    ],
    partial(columns_of, kind="profile"): [
        ("rho_mm,f_um\n0.1,1\n0.2,3\n", "line 2: rho_mm", "0.1"),
        ("rho_mm,f_um\n0,0\n1,3\n2,2\n", "line 4: f_um", "2"),
    ],
    partial(columns_of, kind="tabulated"): [
        ("indentation_um,load_mN,area_mm2\n5,1,2\n5,2,3\n", "line 3: indentation_um", "5"),
    ],
    files.read_contacts: [
        (f"{IMAGES}\n,.05,1,3,0,0,.1,.01\n", "line 2: image", "empty"),
        (f"{FIRST}a,.05,0,4,1,0,.1,.01\n", "line 3: contact", "'0'"),
        (f"{FIRST}a,.05,1,4,1,0,.1,.01\n", "line 3: contact", "'1'"),
        (f"{FIRST}b,.05,2,4,1,0,.1,.01\n", "t.csv", "image a"),
        (f"{FIRST}a,.05,2,4,1,0,-.2,.01\n", "line 3: area_mm2", "-.2"),
        (f"{FIRST}a,.05,2,4,1,0,,.01\n", "line 3: area_mm2", "area_error_mm2"),
        (f"{FIRST}a,.05,2,4,,0,.1,.01\n", "line 3: x_mm", "empty"),
        (f"{FIRST}a,.06,2,4,1,0,.1,.01\n", "line 2: load_N", "'.05'"),
        (f"{FIRST}b,.05,1,3,1,0,.1,.01\n", "line 2: x_mm", "'0'"),
        (f"{FIRST}a,.05,2,3,1,0,.1,.01\n", "line 2: site", "'3'"),
        ("image,load_N,contact,x_mm,y_mm,area_error_mm2,area_mm2,sheared_area_mm2\na,1,1,0,0,1,1,1\n",
        "line 2: sheared_area_mm2", "sheared_area_error is empty"),
    ],
    calibration: [
        ("load_mN,height_um\n1,2\n", "height_um", "load_mN,area_mm2"),
        ("area_mm2,area_before_mm2,area_sheared_mm2\n1,2,3\n", "area", "area_before"),
        ("load_mN,area_mm2\n1,2\n3,-4\n", "line 3: area_mm2", "-4"),
        (f"{IMAGES}\na,,1,3,0,0,.1,.01\n", "t.csv", "no image has a load"),
    ],
    partial(files.read_forces, ["1.tif", "s.tif:1", "s.tif:2"]): [
        ("image,load_mN\n1.tif,\n", "line 2: load_mN", "empty"),
        ("image,load_mN\ns.tif,5\n", "t.csv", "s.tif is not among the images 1.tif, s.tif:1"),
        ("image,load_mN\n1.tif,5\n1.tif,6\n", "line 2: image", "1.tif"),
        ("image,load_mN,sheared_image\n1.tif,5,1.tif\n", "line 2: image", "1.tif"),
    ],
}  # fmt: skip


@pytest.mark.parametrize("read", TABLES)
def test_a_wrong_table_is_refused_by_its_line_column_and_entry(read, tmp_path):
    rows = [(of_file(read, content), key, value) for content, key, value in TABLES[read]]
    assert faults(of(rows, tmp_path)) == []
