"""Each key of a specification becomes a value."""

import json
import math
import pickle
import tomllib

import numpy as np
import pytest
from jsonschema import Draft7Validator
from pydantic import create_model

import metafem as mf
from metafem import files
from metafem.explorer import form as page_form
from metafem.files.specification import forms, read
from metafem.files.specification import sections as own
from metafem.files.specification.forms import Sections, as_toml, section_forms, whole_schema
from metafem.models.model import contact_of, with_contact
from tests.core.files.specs import SHAPE, spec, text

MATERIAL, FRICTION = mf.Material(1.36, 0.5), mf.Friction(0.358, 0.85)
CAP_TABLE = "rho_mm,f_um\n0,0\n0.2,39.5\n0.4,184\n0.6,600\n"
CAP = mf.Profile([[0.0, 0.2, 0.4, 0.6], [0.0, 39.5e-3, 0.184, 0.6]])
CONTACT_TABLE = "indentation_um,load_mN,area_mm2\n0,0,0\n5,0.46,0.0083\n20,3.7,0.033\n90,35,0.15\n"
CONTACT = mf.TabulatedContact([0.005, 0.02, 0.09], [0.00046, 0.0037, 0.035], [0.0083, 0.033, 0.15])
TABLES = {"cap.csv": CAP_TABLE, "contact.csv": CONTACT_TABLE}

AREAS = 'rescaled_load = ["0.1 mm^2", "0.2 mm^2"]\n'
POINTS = 'rescaled_friction = ["0.8 mm^2", "1.5 mm^2"]'
FORCES = 'load = ["136 mN", "0.272 N"]\n'
COEFFICIENT = 0.358 * 0.85 / 1.36  # friction coefficient of the slope 1

# Keys of a target, and its value.
TARGETS = [
    ('kind = "linear"\nslope = 6.87\nload_range = ["0.05 mm^2", "200000 um^2"]',
     mf.LinearLaw(6.87, (0.05, 0.2))),
    ('kind = "linear"\nslope = 6.87\nload_range = ["68 mN", "0.272 N"]', mf.LinearLaw(6.87, (0.05, 0.2))),
    ('kind = "linear"\nfriction_coefficient = 1.5', mf.LinearLaw(1.5 / COEFFICIENT)),
    ('kind = "bilinear"\nslopes = [7, 12.5]\ncrossover_load = "0.038 mm2"\n'
     'load_range = ["0.02 mm^2", "0.1 mm^2"]',
     mf.BilinearLaw((7.0, 12.5), 0.038, (0.02, 0.1))),
    ('kind = "bilinear"\nfriction_coefficients = [1.2, 1.9]\ncrossover_load = "0.0544 N"',
     mf.BilinearLaw((1.2 / COEFFICIENT, 1.9 / COEFFICIENT), 0.04)),
    ('kind = "multilinear"\nslopes = [9.5, 7.0, 8.0]\ncrossover_loads = [["0.07 mm2", "0.18 mm2"],'
     '"0.2 mm2"]\nload_range = ["0.03 mm^2", "0.26 mm^2"]',
     mf.MultilinearLaw([9.5, 7.0, 8.0], [(0.07, 0.18), 0.2], (0.03, 0.26))),
    ('kind = "multilinear"\nfriction_coefficients = [2, 1.5]\ncrossover_loads = [["0.136 N", "0.272 N"]]\n'
     'load_range = ["0.068 N", "0.408 N"]',
     mf.MultilinearLaw([2.0 / COEFFICIENT, 1.5 / COEFFICIENT], [(0.1, 0.2)], (0.05, 0.3))),
]  # fmt: skip


def numbers(target):
    """Return all numbers of a target, in the order of its members."""
    members = [member for member in vars(target).values() if isinstance(member, (float, tuple, np.ndarray))]
    return np.hstack([np.ravel(member) for member in members])


def test_each_kind_of_target_is_read():
    for keys, expected in TARGETS:
        found = spec(target=keys).target
        assert type(found) is type(expected), keys
        np.testing.assert_allclose(numbers(found), numbers(expected), rtol=1e-14, err_msg=keys)


def test_a_target_is_stated_in_the_units_in_which_it_was_given():
    for keys, end in (
        ('kind = "linear"\nslope = 6.87\nload_range = ["68 mN", "0.272 N"]',
         "slope 6.87 from 0.068 to 0.272 N"),
        ('kind = "linear"\nfriction_coefficient = 1.5\nload_range = ["0.05 mm^2", "0.2 mm^2"]',
         "friction coefficient 1.5 from 0.068 to 0.272 N"),
        ('kind = "bilinear"\nslopes = [7, 9]\ncrossover_load = "0.04 N"\nload_range = ["0.03 N", "0.1 N"]',
         "slopes 7 and 9 through the origin from 0.03 to 0.1 N"),
        ('kind = "power"\nexponent = 1.2\nload_range = ["0.136 N", "0.544 N"]',
         "exponent 1.2 from 0.136 to 0.544 N"),
    ):  # fmt: skip
        assert spec(target=keys).target.title.endswith(end)


# Sections, a member of the specification or of its template, and its value.
DEGREE = math.pi / 180.0
MEMBERS = [
    ({}, "material", MATERIAL),
    ({"material": 'young_modulus = "1020 kPa"'}, "material", mf.Material.from_young(1.02, 0.5)),
    ({"material": 'composite_modulus = "2 MPa"\npoisson_ratio = 0.3'}, "material", mf.Material(2.0, 0.3)),
    ({}, "friction", FRICTION), ({"friction": None}, "friction", None),
    ({}, "block", mf.Block(20.0, 20.0, 7.2)),
    ({"block": 'width = "30 mm"\nlength = "2 cm"\nthickness = "7.2 mm"'}, "block", mf.Block(30.0, 20.0, 7.2)),
    ({"block": None}, "block", None), ({"cell": ""}, "cell", mf.PeriodicCell(12.0, 12.0)),
    ({"cell": 'width = "16 mm"\nlength = "15 mm"'}, "cell", mf.PeriodicCell(16.0, 15.0)),
    ({}, "limits", mf.Limits(0.12, offset=0.084)),
    ({"limits": 'max_height = "120 um"\nmin_height = "10 um"\nheight_step = "6 um"\nheight_sd = "0.9 um"'},
     "limits", mf.Limits(0.12, 0.01, height_step=0.006, height_sd=0.0009)),
    ({}, "hardness", None),
    ({"checks": 'hardness = "10 MPa"'}, "hardness", 10.0), ({}, "part", files.PartSection()),
    ({"part": 'alignment_height = "400 um"\nchord_error = "1 um"'}, "part",
     files.PartSection(alignment_height="0.4 mm", chord_error="0.001 mm")),
    ({"sites": 'empty = [18, 4]\npinned = [10, 13]\nheights = ["150 um", "0.12 mm"]'}, "limits",
     mf.Limits(0.12, offset=0.084, pinned={3: None, 17: None, 9: 0.15, 12: 0.12})),
    ({}, "tools", None), ({"lattice": SHAPE, "tools": 'radii = ["526 um", "0.3 mm"]'}, "tools", (0.526, 0.3)),
    ({"lattice": SHAPE, "tools": 'radius_range = ["0.2 mm", "0.8 mm"]'}, "tools", mf.RadiusRange(0.2, 0.8)),
    ({"lattice": SHAPE, "tools": 'radius_range = ["0.2 mm", "0.8 mm"]\nstep = "25 um"'}, "tools",
     mf.RadiusRange(0.2, 0.8, 0.025)),
    ({"block": None}, "model", mf.Automatic(1e-3)),
    ({}, "cap", mf.Sphere()),
    *(({"contact": 'kind = "elastic"', "cap": keys}, "cap", cap) for keys, cap in {
        'kind = "sphere"': mf.Sphere(), 'kind = "paraboloid"': mf.Paraboloid(),
        'kind = "power"\nexponent = 4.0\ncoefficient = 0.3': mf.Power(4, 0.3),
        'kind = "profile"\nfile = "cap.csv"': mf.Profile(CAP.profile),
    }.items()),
]  # fmt: skip


def test_each_key_becomes_a_value():
    for sections, name, expected in MEMBERS:
        found = spec(TABLES, **sections)
        value = getattr(found, name) if hasattr(found, name) else getattr(found.template, name)
        assert value == expected, sections


def test_the_lattice_has_its_sites_with_summits_at_the_largest_height():
    template = spec(lattice='shape = [2, 3]\npitch = "2 mm"\nradius = "0.5 mm"', layout="").template
    assert template.position.tolist() == [[x, y] for y in (-1.0, 1.0) for x in (-2.0, 0.0, 2.0)]
    assert set(template.radius) == {0.5}
    np.testing.assert_allclose(template.height, 0.204, rtol=1e-15)
    tools = spec(lattice=SHAPE, tools='radii = ["526 um", "0.3 mm"]').template
    assert (tools.count, set(tools.radius)) == (64, {0.3})


def test_each_model_has_its_name():
    names = "independent half-space layer block resolved automatic"
    assert list(files.MODELS) == names.split()
    models = [
        *(mf.Independent(), mf.Interacting(), mf.Interacting(substrate=mf.BondedLayer())),
        *(mf.Interacting(substrate=mf.fe.Block3D()), mf.BoundaryElements(0.008)),
        mf.Automatic(1e-3, mf.BondedLayer()),
    ]
    assert [spec(model=f'kind = "{name}"').model for name in files.MODELS] == models
    assert spec().model == models[-1]
    folder, template = mf.Independent(contact=mf.Elastic()), spec().template
    assert files.chosen_model(folder, None, None, template) is folder
    assert files.chosen_model(folder, "independent", None, template) == folder
    assert files.chosen_model(folder, None, "hertz", template) == mf.Independent()
    assert files.chosen_model(mf.Interacting(), "independent", "elastic", template) == folder
    assert with_contact(mf.Interacting(), mf.KogutEtsion(10.0)).order == 1  # it has no profile
    assert with_contact(mf.Interacting(), mf.Elastic()).order == 3


# Words of each contact law, the keys of its section, and the law.
LAWS = {
    "hertz": ("", mf.Hertz()),
    "elastic": ("", mf.Elastic()),
    "jkr 9 mJ/m^2": ('adhesion_energy = "9 mJ/m^2"', mf.JKR(9e-6)),
    "jkr 27mJ/m^2": (
        'adhesion_energy = "0.027 N/m"', mf.JKR(2.7e-5)
    ),
    "kogut-etsion 10 MPa": ('hardness = "10 MPa"', mf.KogutEtsion(10.0)),
    "jackson-green 4000kPa": ('yield_strength = "4 MPa"', mf.JacksonGreen(4.0)),
    "tabulated contact.csv": ('file = "contact.csv"', CONTACT),
}  # fmt: skip


def test_each_contact_law_is_read_from_words_and_from_its_section(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, table in TABLES.items():
        (tmp_path / name).write_text(table, "utf-8")
    assert list(dict.fromkeys(words.split()[0] for words in LAWS)) == list(
        files.section_forms()["contact"]["kinds"]
    )
    for words, (keys, law) in LAWS.items():
        assert files.contact_named(words) == law, words
        model = spec(TABLES, contact=f'kind = "{words.split()[0]}"\n{keys}').model
        assert contact_of(model) == law, words
    rows = 'rho = ["0 um", "0.2 mm", "0.4 mm", "0.6 mm"]\nf = ["0 um", "39.5 um", "184 um", "600 um"]'
    assert spec(cap=f'kind = "profile"\n{rows}').template.cap == CAP


# Tables of a sampled target, with its loads, values, relative errors and weights.
SAMPLES = [
    ("load_mN,friction_force_N,weight\n136,0.24344,1\n272,0.6086,2\n", [0.8, 2.0], None, [1.0, 2.0]),
    ("Normal load [mN];Friction (N)\n136;0,24344\n272;0,6086\n", [0.8, 2.0], None, [1.0, 1.0]),
    ("rescaled_load_mm2,rescaled_friction_mm2,relative_error\n0.1,0.8,.01\n0.2,1.6,.02\n", [0.8, 1.6],
     [0.01, 0.02], [1e4, 2500]),
    ("load_mN,area_mm2,area_sd_mm2\n136,0.8,0.008\n272,1.5,0.03\n", [0.8, 1.5], [0.01, 0.02], [1e4, 2500]),
    # the exponent is 2, so that 1 % of the load is 2 % of the friction
    ("load_mN,area_mm2,load_sd_mN\n272,3.2,2.72\n136,0.8,1.36\n", [0.8, 3.2], [0.02, 0.02], [2500, 2500]),
    # means of repeated loads have smaller errors, or larger weights
    ("load_N,area_mm2,area_sd_mm2\n.272,1,.01\n.136,.4,.004\n.272,2,.02\n", [0.4, 1.5],
     [0.01, 0.01 / math.sqrt(2)], [1e4, 2e4]),
    ("load_N,area_mm2,weight\n.272,1,3\n.136,.4,2\n.272,2,4\n", [0.4, 1.5], None, [2, 7]),
    ("load_N,area_mm2\n.272,1\n.136,.4\n.272,2\n", [0.4, 1.5], None, [1, 2]),
]  # fmt: skip


def test_tables_of_a_target_are_read_with_their_units_and_errors(tmp_path):
    for table, values, error, weight in SAMPLES:
        found = spec({"w.csv": table}, target='kind = "sampled"\nfile = "w.csv"').target
        np.testing.assert_allclose(found.rescaled_load, [0.1, 0.2], rtol=1e-14, err_msg=table)
        np.testing.assert_allclose(found.rescaled_friction, values, rtol=1e-14, err_msg=table)
        assert (found.relative_error is None) == (error is None)
        if error is not None:
            np.testing.assert_allclose(found.relative_error, error, rtol=1e-12, err_msg=table)
        if weight is not None:
            np.testing.assert_allclose(found.weight, weight, rtol=1e-12, err_msg=table)


def test_tables_are_kept_beside_the_specification(tmp_path):
    table = SAMPLES[0][0].encode()
    for name, copy in (("wanted.csv", "wanted.csv"), ("sub/w.csv", "w.csv"), ("../C:w µ.csv", "w µ.csv")):
        given = text(target=f'kind = "sampled"\nfile = "{name}"  # of June').replace("\n", "\r\n")
        found = files.parsed(given, {name: table})
        assert found.files == {"spec.toml": given.encode(), copy: table}
        for each, content in found.files.items():
            (tmp_path / each).write_bytes(content)
        again = mf.read_spec(tmp_path / "spec.toml")
        assert (again.files, again.target) == (found.files, found.target)


def test_a_file_is_read_as_its_text(tmp_path):
    raw = text().replace("\n", "\r\n").encode("utf-8-sig")
    (tmp_path / "a.toml").write_bytes(raw)
    found, same = mf.read_spec(tmp_path / "a.toml"), files.parsed(raw.decode())
    assert found.text == same.text == raw.decode()
    assert found.files == same.files == {"spec.toml": raw}
    assert (found.target, found.template, found.limits) == (same.target, same.template, same.limits)
    assert files.toml_table("[layout]\nseed = 3") == {"layout": {"seed": 3}}


def test_the_published_surfaces_are_demos():
    assert files.DEMOS == ("operating-points", "linear", "bilinear")
    points, linear, bilinear = (files.parsed(files.demo_text(name)) for name in files.DEMOS)
    assert linear.target == mf.LinearLaw(6.87)
    assert linear.limits == mf.Limits(0.12, offset=0.084, height_step=0.006, height_sd=0.0009)
    assert bilinear.target == mf.BilinearLaw((7.15, 12.52), 0.038)
    assert points.target == mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])
    for demo, modulus, friction, top in (
        (points, 1.36, (0.37, 0.85), 0.27), (linear, 1.36, (0.358, 0.85), 0.204),
        (bilinear, 1.52, (0.225, 0.92), 0.17),
    ):  # fmt: skip
        pair = {"material": mf.Material(modulus, 0.5), "friction": mf.Friction(*friction)}
        lattice = mf.Surface.square_lattice(
            top, (8, 8), 1.5, radius=0.526, block=mf.Block(20.0, 20.0, 7.2), **pair
        )
        assert demo.template.replaced(height=lattice.height) == lattice
        np.testing.assert_allclose(demo.template.height, top, rtol=1e-15)
        assert (demo.model, demo.part.alignment_height) == (mf.Independent(), 0.4)


def test_a_design_uses_all_keys():
    lattice = 'shape = [4, 4]\npitch = "1.5 mm"'
    found = spec(
        target='kind = "linear"\nslope = 4.5', lattice=lattice, tools='radii = ["526 um", "300 um"]',
        sites='empty = [6]\npinned = [3]\nheights = ["100 um"]', layout='seed = 3\ntilt = "0.1 deg"',
    )  # fmt: skip
    result = found.design()
    assert dict(result.pinned) == {5: None, 2: 0.1}
    limits = mf.Limits(0.12, offset=0.084, pinned={5: None, 2: 0.1})
    same = mf.design(found.target, found.template, found.model, limits, rng=3, tools=[0.526, 0.3])
    same = mf.arrange(same, 0.1 * DEGREE, rng=3)
    np.testing.assert_array_equal(result.surface.height, same.surface.height)
    draft = found.design(draft=True)
    assert (draft.target, dict(draft.pinned)) == (found.target, {5: None, 2: 0.1})


def test_all_problems_are_listed_and_survive_a_process():
    with pytest.raises(mf.InvalidInput) as caught:
        files.parsed(text().replace('"1.5 mm"', "1.5").replace('"120 um"', "120"), name="mine.toml")
    error = caught.value
    assert [problem.key for problem in error.problems] == ["lattice.pitch", "limits.max_height"]
    assert str(error) == "\n".join(f"mine.toml: {problem}" for problem in error.problems)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


# Keys of the manual that exclude others, and a table that is not there.
COMMON = {"load", "friction_force", "friction_coefficient", "friction_coefficients", "file", "radius"}
FIRST = {*("composite_modulus", "radius_range", "step", "lowest_force", "highest_force"), *COMMON}
SECOND = {
    *("young_modulus", "rescaled_load", "rescaled_friction", "lowest", "highest", "slope", "slopes", "file"),
    *("radius", "radii"),
}
THIRD = FIRST - {"radius"} | {"radii"}
KEYS = [
    key for name, form in files.section_forms().items() if "." not in name
    for keys in form["keys"].values() for key in keys
]  # fmt: skip
KINDS = sorted({key["kind"] for key in KEYS if key["section"] == "target"})


def made(kind, law, left_out):
    """Return the text of a specification of the manual's examples."""
    lines, chosen = [], {"target": kind, "contact": law}
    for section in Sections.model_fields:
        absent = {"file"} if section == "contact" else left_out
        keys = [
            key for key in KEYS if key["section"] == section
            and key["kind"] in (None, chosen.get(section)) and key["name"] not in absent
        ]  # fmt: skip
        lines += [f"[{section}]"] if keys or section in chosen else []
        lines += [f'kind = "{chosen[section]}"'] if section in chosen else []
        lines += [f"{key['name']} = {as_toml(key['example'])}" for key in keys]
    return "\n".join(lines).replace('"layer"', '"layer"' if law == "hertz" else '"independent"')


@pytest.mark.parametrize("left_out", [FIRST, SECOND, THIRD], ids=["either", "or", "one radius"])
def test_the_examples_of_the_manual_make_specifications_that_follow_the_schema(left_out):
    editor = Draft7Validator(whole_schema())
    for kind, law in [
        *((kind, "hertz") for kind in KINDS),
        *(("linear", law) for law in files.section_forms()["contact"]["kinds"]),
    ]:
        files.parsed(made(kind, law, left_out))
        assert list(editor.iter_errors(tomllib.loads(made(kind, law, left_out)))) == []


def test_the_manual_lists_every_section_kind_and_key():
    whole = files.manual()
    for name, form in files.section_forms().items():
        assert f"\n[{name}] " in whole or "." in name
        assert all(f'\nkind = "{kind}"' in whole for kind in form["kinds"])
    assert all(f"\n{key['name']} = {as_toml(key['example'])}" in whole for key in KEYS)


def test_forms_describe_the_values_of_keys():
    kinds = {"quantity": str, "text": str, "number": float, "integer": int, "truth": bool, "section": dict}
    for key in KEYS:
        entries = key["example"] if key["listed"] else [key["example"]]
        entries = [part for entry in entries for part in (entry if isinstance(entry, list) else [entry])]
        assert key["example"] is None or {type(entry) for entry in entries} == {kinds[key["value"]]}, key
        assert not key["units"] or all(entry.split(" ")[1] in key["units"] for entry in entries)
        assert not key["names"] or set(entries) <= set(key["names"])
    assert [key["name"] for key in KEYS if key["pairs"]] == ["crossover_loads"]
    forms = files.section_forms()
    needed = [key["name"] for key in forms["target"]["keys"]["sampled"] if key["needed"]]
    assert needed == ["rescaled_load", "rescaled_friction"]
    assert list(forms["contact.cap"]["kinds"]) == ["hertz", "elastic"]


@pytest.fixture
def wider(monkeypatch):
    """The sections of a specification, in which `checks` has one key more."""

    class Wider(own.ChecksSection):
        gap: own.measured("mm", gt=0.001, le=0.5) | None = own.optional("between", "20 um")

    checks = (Wider, own.key("further checks", default=Wider()))
    for module in (forms, read):
        monkeypatch.setattr(module, "Sections", create_model("Wider", __base__=Sections, checks=checks))
    for cached in (whole_schema, section_forms):
        cached.cache_clear()
    yield
    monkeypatch.undo()
    for cached in (whole_schema, section_forms):
        cached.cache_clear()


@pytest.mark.usefixtures("wider")
def test_a_field_of_a_section_is_all_that_a_new_key_needs():
    (part,) = [each for each in page_form.form() if each["name"] == "checks"]
    field = part["keys"][""][-1]
    assert (field["label"], field["example"], "um" in field["units"]) == ("gap", "20 um", True)
    assert "between; greater than 0.001 mm, at most 0.5 mm" in field["help"]
    assert 'gap = "20 um"' in files.manual()
    assert files.parsed(text() + '[checks]\ngap = "30 um"').sections.checks.gap == pytest.approx(0.03)
    for given, words in (("1 um", "greater than 0.001 mm"), ("501 um", "less than or equal to 0.5 mm")):
        with pytest.raises(mf.InvalidInput) as caught:
            files.parsed(text() + f'[checks]\ngap = "{given}"')
        assert f'checks.gap = "{given}" must be {words}' in str(caught.value)


def test_the_schema_describes_every_key():
    found = whole_schema()
    Draft7Validator.check_schema(found)
    for name in ("target", "lattice"):
        assert name in found["required"]
    for name in files.DEMOS:
        assert "#:schema ./metafem.schema.json\n" in files.demo_text(name)
        assert Draft7Validator(found).is_valid(tomllib.loads(files.demo_text(name)))
    assert json.loads(files.schema_text()) == found
