"""The text of a specification: its values, its kinds, what is typed into its fields, and its comments."""

import itertools
import tomllib

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.editor import placed
from metafem.explorer.fields import shown, typed_value, with_field
from metafem.explorer.form import contents, form
from metafem.explorer.history import State
from metafem.explorer.kinds import KINDS, with_choice, with_kind, with_section, without_section
from metafem.explorer.table import Document, label_of, loses_comments, order_of, title_of
from metafem.files import demo_text, parsed, section_forms

LINEAR, POINTS = demo_text("linear"), demo_text("operating-points")
MULTILINEAR = Document(LINEAR).with_kind("target", "multilinear")
ADHESIVE = Document(LINEAR).with_kind("contact", "jkr")
TEXTS = [
    POINTS,
    "# one\ntarget = {kind = 'linear', slope=6.87}\nlimits={ max_height=\"120 um\" } # two",
    "target.kind = 'linear'\ntarget.slope = 6.87 # steep\n\nlimits . max_height = '120 um'",
    "[\"limits\"]\n'max_height' = '''1\n[part] um'''\n[ layout ]\n\tseed=1\n",
    "top = 2020-01-01\n[limits]\n'a b' = {x = [{}, {y = nan}]}\n[[mine]]\nx = -inf\n[[mine]]\n",
    "\ufeff[limits]\r\nmax_height = '120 um'\r\n",
    "",
]
VALUES = {
    "limits.offset": "µ'\"\\\n",
    "layout.seed": 2**63 - 1,
    "target.weight": [1e-300, 2.5],
    "layout.mine": True,
    "target.crossover_loads": [["0.1 mm^2", "0.2 mm^2"], "0.3 mm^2"],
}


def test_a_value_that_is_set_is_read_back_and_all_others_stay():
    for text, (key, value) in itertools.product(TEXTS, VALUES.items()):
        document = Document(text)
        new = document.with_values({key: value})
        section, _, last = key.partition(".")
        old = {each: dict(keys) if isinstance(keys, dict) else keys for each, keys in document.table.items()}
        assert repr(sorted_table(Document(new).table)) == repr(
            sorted_table({**old, section: {**old.get(section, {}), last: value}})
        )
        assert Document(new).with_values({key: value}) == new
        gone = Document(Document(new).with_values({key: None}))
        assert gone.value(key) is None
        assert document.with_values({key: document.value(key)}) == document.text


def sorted_table(value):
    """Return a table as nested pairs, in which nan equals nan."""
    return (
        sorted((name, sorted_table(each)) for name, each in value.items())
        if isinstance(value, dict)
        else value
    )


WRITTEN = """[target]
kind = "linear"
slope = 6.5

[lattice]
pitch = "1.5 mm"
shape = [8, 8]

[tools]
radii = ["300 um", "526 um"]

[limits]
max_height = "120 um"
min_height = "10 um"
offset = "50 um"

[contact]
kind = "jkr"
adhesion_energy = "9 mJ/m^2"

[contact.cap]
kind = "elastic"

[mine]
b = 1
a = "µ"
"""


def test_a_changed_text_is_written_in_the_order_of_the_manual_and_ends_comments():
    text = """mine = {b = 1, a = 'µ'}
    [limits] # of the shop
    offset = '50 um'
    max_height = "120 um"
    [contact]
    cap.kind = 'elastic'
    kind = 'jkr'
    adhesion_energy = '9 mJ/m^2'
    [lattice]
    pitch = "1.5 mm"
    shape = [
        8, 8]
    radius = "526 um"
    """
    values = {"target.slope": 6.5, "target.kind": "linear", "limits.min_height": "10 um"}
    new = Document(text).with_values({**values, "lattice.radius": None, "tools.radii": ["300 um", "526 um"]})
    assert new == WRITTEN
    assert loses_comments(text, new)
    only = "[checks]\nhardness = '1 MPa'\n[limits]\nmax_height = '1 um'\n"
    assert Document(only).with_values({"checks.hardness": None}) == '[limits]\nmax_height = "1 um"\n'
    assert Document(only).with_values({"limits.max_height": None}).startswith("[limits]\n")
    for line, own in (("a = '#' # mine", True), ('a = "\\"# a"', False), ("b = [1, # mine\n2]", True)):
        text = f"{line}\n{LINEAR}"
        new = Document(text).with_values({"limits.max_height": "117 um"})
        assert loses_comments(text, new) == own
        assert not loses_comments(text, text + "# more")


@pytest.mark.parametrize("section", order_of(""))
def test_each_kind_and_choice_of_a_section_can_be_read_and_removed(section):
    tables = {
        "wanted.csv": b"load_N,friction_force_N\n0.1,0.2\n0.2,0.5\n",
        "cap.csv": b"rho_um,f_um\n0,0\n200,39\n400,184\n600,600\n",
        "contact.csv": b"indentation_um,load_mN,area_mm2\n5,0.46,0.0083\n20,3.7,0.033\n90,35,0.15\n",
    }
    given = section_forms()[section]
    for kind in given.kinds or [""]:
        text = with_field(POINTS, f"{section}.kind", kind) if kind else with_section(POINTS, section)
        assert set(Document(text).section(section)) <= {"kind", *(key.name for key in given.keys[kind])}
        parsed(text, tables)
        for choice in {key.choice for key in given.keys[kind]} - {None}:
            parsed(with_choice(text, section, choice), tables)
        for key in given.keys[kind]:  # each takes its example
            if key.value != "section":
                name = f"{section}.{key.name}"
                changed = with_field(text, name, shown(key.example))
                assert Document(changed).value(name) == key.example == typed_value(key, shown(key.example))
                assert contents(changed, {})["values"].get(name, shown(key.example)) == shown(key.example)
                assert with_field(changed, name, shown(key.example)) == changed
    if given.optional:
        text = without_section(with_field(POINTS, "contact.kind", "jkr"), section)
        assert Document(text).value(section) is None
        added = with_section(text, section)
        assert Document(added).value(section)
        assert with_section(added, section) == added
        assert tomllib.loads(without_section(added, section)) == tomllib.loads(text)


def test_tools_replace_the_radius_and_a_kind_the_keys_of_another():
    text = with_section(POINTS, "tools")
    assert "radius" not in tomllib.loads(text)["lattice"]
    assert parsed(text).tools == (0.3, 0.526)
    assert tomllib.loads(without_section(text, "tools"))["lattice"]["radius"] == "526 um"
    elastic = Document(ADHESIVE).with_kind("contact.cap", "elastic")
    assert Document(elastic).value("contact.cap") == {"kind": "elastic"}
    assert parsed(elastic).model.contact == mf.JKR(9e-6, mf.Elastic())


TYPED = [
    ("lattice.shape", "7x8", [7, 8]),
    ("lattice.shape", "12 12", [12, 12]),
    ("target.slopes", "9, 8.5, 7", [9, 8.5, 7]),
    ("material.poisson_ratio", " .45 ", 0.45),
    ("material.poisson_ratio", "0,45", 0.45),
    ("target.load_range", '"0.1 N"; "0.4 N"', ["0.1 N", "0.4 N"]),
    ("target.load_range", "0,1; 0,4 mm^2", ["0.1 mm^2", "0.4 mm^2"]),
    ("target.load_range", "0.1, 0.4", ["0.1 mm^2", "0.4 mm^2"]),
    ("target.crossover_loads", "[0.07, 0.1], 0,15", [["0.07 mm^2", "0.1 mm^2"], "0.15 mm^2"]),
    ("limits.max_height", "0,13 mm", "0.13 mm"),
    ("limits.max_height", ".5", "0.5 um"),
    ("limits.max_height", "1,300", "1,300"),  # or one thousand three hundred
    ("limits.max_height", "13x", "13x"),
    ("limits.min_height", "12", "12"),  # which had no unit before
    ("limits.max_height", "", None),
    ("model.kind", "layer", "layer"),
]


def test_what_is_typed_becomes_the_value_of_its_key_alone():
    for key, typed, value in TYPED:
        section, name = key.split(".")
        before, after = tomllib.loads(MULTILINEAR), tomllib.loads(with_field(MULTILINEAR, key, typed))
        assert after.get(section, {}).get(name) == value, (key, typed)
        before.setdefault(section, {}).pop(name, None)
        after.setdefault(section, {}).pop(name, None)
        assert after == before
    mixed = with_field(MULTILINEAR, "target.load_range", "0.1 N, 0.4 mm^2")  # no unit is assumed
    mixed = with_field(mixed, "target.load_range", "0.1, 0.4")
    assert Document(mixed).value("target.load_range") == ["0.1", "0.4"]
    other = with_field(LINEAR, "material.young_modulus", "1 MPa")
    assert "composite_modulus" not in tomllib.loads(other)["material"]
    assert with_field(ADHESIVE, "contact.cap.kind", "elastic") != ADHESIVE


def test_a_problem_is_at_its_key_and_its_line_in_the_words_of_the_page():
    for key, typed, reason, offers in (
        ("limits.min_height", "12", "unit", {"limits.min_height": "10 um"}),
        ("limits.max_height", "120 kg", "mm", {"limits.max_height": "120 um"}),
        ("lattice.pitch", "1,500 mm", "decimals", {"lattice.pitch": "1.5 mm"}),
        ("lattice.shape", "8, a", 'Entry 2 = "a"', {}),
        ("material.poisson_ratio", "0.7", "0.5", {"material.poisson_ratio": "0.5"}),
        ("model.kind", "rigid", "nknown", {}),
    ):
        text = with_field(LINEAR, key, typed)
        answer = answered(State(text), 1)
        assert list(answer.problems) == list(answer.reasons) == [key]
        assert reason in answer.reasons[key]
        assert key in answer.problems[key]
        assert key not in answer.reasons[key]
        assert answer.offers == offers
        assert contents(text, answer.reasons)["problems"].get(key, answer.reasons[key]) == answer.reasons[key]
        (problem,) = placed(text, answer.problems)
        assert problem["key"] == key
        assert text.splitlines()[problem["line"] - 1].startswith(key.split(".")[1])

    text = 'target.kind = "linear"\na.b = 1\n# a.c = 2\n[a]\n[contact.cap]\nkind = "hertz"\n'
    lines = {"target.kind": 1, "a.b": 2, "a": 4, "a.c": 4, "contact.cap.kind": 6, "limits.offset": 0}
    for key, line in lines.items():
        assert placed(text, {key: "is wrong"})[0]["line"] == line, key
    (problem,) = placed(LINEAR, {}, "slope 2 is not above the bound")
    assert LINEAR.splitlines()[problem["line"] - 1] == "[target]"
    assert placed("[limits", answered(State("[limits"), 1).problems)[0]["line"] == 1


def test_the_form_has_a_field_for_each_key_and_the_names_of_messages():
    fields = {field["key"]: field for part in form() for keys in part["keys"].values() for field in keys}
    assert fields.keys() == {
        f"{section.name}.{key.name}"
        for section in section_forms().values()
        for key in section.every
        if key.value != "section" and section.name != "model"
    }
    assert [part["name"] for part in form() if part["open"]] == ["target", "lattice", "limits"]
    assert all(part["title"] == title_of(part["name"]) for part in form())
    assert all(field["label"] == label_of(field["key"]) for field in fields.values())
    largest = fields["limits.max_height"]
    assert largest["help"].startswith("Largest height (limits.max_height): ")
    assert largest["help"].endswith(f"Example: {largest['example']}.")
    (target,) = [part for part in form() if part["name"] == "target"]
    assert {kind: target["kind_names"][kind] for kind in target["kinds"]} == {
        kind: KINDS[kind][0] for kind in section_forms()["target"].kinds
    }
    broken = contents("[limits\n", {"": "whatever"})
    assert (broken["broken"][:14], broken["problems"]) == ("not valid TOML", {})


@pytest.mark.parametrize("kinds", ["sampled linear bilinear", "power multilinear band"])
def test_a_target_of_another_kind_is_near_the_law(kinds):
    design = parsed(POINTS).design()
    for kind in kinds.split():
        found = parsed(with_kind(State(POINTS), design, kind)).design()
        assert found.status is not mf.DesignStatus.MISSED
        high = min(found.law.rescaled_load[-1], design.law.rescaled_load[-1])
        load = np.linspace(0.3 * high, high, 20)
        one, other = (np.interp(load, each.law.rescaled_load, each.law.area) for each in (found, design))
        assert np.sqrt(((one / other - 1.0) ** 2).mean()) < 0.2, kind


def test_units_and_crossovers_stay_with_another_kind_and_examples_serve_without_a_design():
    text = Document(LINEAR).with_kind("target", "linear", {"friction_coefficient": 1.55})
    design = parsed(text).design()
    keys = {kind: tomllib.loads(with_kind(State(text), design, kind))["target"] for kind in KINDS}
    assert keys["operating-points"].keys() == {"kind", "load", "friction_force"}
    assert all(load.endswith(" N") for load in keys["sampled"]["load"] + keys["power"]["load_range"])
    assert keys["bilinear"].keys() == {"kind", "friction_coefficients", "crossover_load"}
    assert keys["linear"] == {"kind": "linear", "friction_coefficient": 1.55}
    for state, known in ((State(LINEAR), None), (State(LINEAR.replace('"120 um"', '"120"')), design)):
        assert with_kind(state, known, "power") == Document(state.text).with_kind("target", "power")


def test_operating_points_of_a_bilinear_law_have_its_crossover():
    values = {"slopes": [6.0, 9.0], "crossover_load": "0.08 mm^2", "load_range": ["0.04 mm^2", "0.2 mm^2"]}
    text = Document(demo_text("bilinear")).with_kind("target", "bilinear", values)
    found = parsed(with_kind(State(text), parsed(text).design(), "operating-points")).target
    row = int(np.abs(found.rescaled_load - 0.08).argmin())
    assert found.rescaled_load[row] == pytest.approx(0.08)
    assert found.rescaled_friction[row] == pytest.approx(0.48, rel=0.03)
    slopes = np.diff(found.rescaled_friction) / np.diff(found.rescaled_load)
    assert slopes[row] / slopes[row - 1] == pytest.approx(1.5, rel=0.1)


@pytest.mark.parametrize("kind", ["operating-points", "linear", "bilinear", "multilinear"])
def test_a_target_in_other_units_keeps_its_law(kind):
    text = with_field(POINTS, "target.kind", kind)
    before = parsed(text)
    forces = with_choice(text, "target", 1, before)
    back = with_choice(forces, "target", 0, parsed(forces))
    assert "force" in forces or "coefficient" in forces
    for found in (parsed(forces).target, parsed(back).target):
        for name in ("rescaled_load", "rescaled_friction", "slope", "slopes"):
            if (wanted := getattr(before.target, name, None)) is not None:
                np.testing.assert_allclose(getattr(found, name), wanted, rtol=1e-6)
