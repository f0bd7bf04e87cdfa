"""The table of a specification: its edits, its text, what is typed into its fields, and its form."""

import itertools

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.fields import shown, typed_value
from metafem.explorer.form import contents, form
from metafem.explorer.history import State
from metafem.explorer.kinds import KINDS, with_kind_near, with_units
from metafem.explorer.table import (
    value_of,
    with_field,
    with_only,
    with_section,
    with_values,
    without_section,
    written,
)
from metafem.files import demo_text, of_table, section_forms, toml_table
from tests.explorer.scenes import changed

LINEAR, POINTS = (State(demo_text(name)).table for name in ("linear", "operating-points"))
MULTILINEAR, ADHESIVE = with_section(LINEAR, "target", "multilinear"), with_section(LINEAR, "contact", "jkr")
TEXTS = [
    demo_text("operating-points"),
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
        state = State(text)
        new = state.edited(with_values(state.table, {key: value}))
        assert repr(state.table) == repr(toml_table(text))  # an edit leaves the table that it is given
        section, _, last = key.partition(".")
        wanted = {**state.table, section: {**state.table.get(section, {}), last: value}}
        for table in (new.table, toml_table(new.text)):  # of the edit, and of its text
            assert repr(sorted_table(table)) == repr(sorted_table(wanted))
        assert new.edited(with_values(new.table, {key: value})) is new
        assert value_of(with_values(new.table, {key: None}), key) is None
        assert state.edited(with_values(state.table, {key: value_of(state.table, key)})) is state
    assert State("[layout]\nseed = 1").edited({"layout": {"seed": True}}).text == "[layout]\nseed = true\n"


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


def test_a_table_is_written_in_the_order_of_the_manual():
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
    values |= {"lattice.radius": None, "tools.radii": ["300 um", "526 um"]}
    assert changed(text, with_values, values) == WRITTEN
    only = {"checks": {"hardness": "1 MPa"}, "limits": {"max_height": "1 um"}}
    assert with_values(only, {"checks.hardness": None}) == {"limits": {"max_height": "1 um"}}
    assert written(with_values(only, {"limits.max_height": None})).startswith("[limits]\n")


@pytest.mark.parametrize("section", [name for name in section_forms() if "." not in name])
def test_each_kind_and_choice_of_a_section_can_be_read_and_removed(section):
    tables = {
        "wanted.csv": b"load_N,friction_force_N\n0.1,0.2\n0.2,0.5\n",
        "cap.csv": b"rho_um,f_um\n0,0\n200,39\n400,184\n600,600\n",
        "contact.csv": b"indentation_um,load_mN,area_mm2\n5,0.46,0.0083\n20,3.7,0.033\n90,35,0.15\n",
    }
    given = section_forms()[section]
    for kind, keys in given["keys"].items():
        table = with_field(POINTS, f"{section}.kind", kind) if kind else with_section(POINTS, section)
        assert set(table.get(section, ())) <= {"kind", *(key["name"] for key in keys)}
        of_table(table, source=tables)
        for choice in {key["choice"] for key in keys} - {None}:
            of_table(with_section(table, section, kind, choice), source=tables)
        for key in (key for key in keys if key["value"] != "section"):  # each takes its example
            name, example = f"{section}.{key['name']}", shown(key["example"])
            new = with_field(table, name, example)
            assert value_of(new, name) == key["example"] == typed_value(key, example)
            assert contents(State(written(new)), {})["values"].get(name, example) == example
            assert with_field(new, name, example) is new
    if given["optional"]:
        table = without_section(with_field(POINTS, "contact.kind", "jkr"), section)
        assert section not in table
        added = with_section(table, section)
        assert with_section(added, section, added[section].get("kind", "")) == added
        assert without_section(added, section) == table


def test_tools_replace_the_radius_and_a_kind_the_keys_of_another():
    table = with_section(POINTS, "tools")
    assert "radius" not in table["lattice"]
    assert of_table(table).tools == (0.3, 0.526)
    assert without_section(table, "tools")["lattice"]["radius"] == "526 um"
    elastic = with_section(ADHESIVE, "contact.cap", "elastic")
    assert elastic["contact"]["cap"] == {"kind": "elastic"}
    assert of_table(elastic).model.contact == mf.JKR(9e-6, mf.Elastic())


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
        new = with_field(MULTILINEAR, key, typed)
        assert value_of(new, key) == value, (key, typed)
        assert with_values(new, {key: None}) == with_values(MULTILINEAR, {key: None})
    mixed = with_field(MULTILINEAR, "target.load_range", "0.1 N, 0.4 mm^2")  # no unit is assumed
    mixed = with_field(mixed, "target.load_range", "0.1, 0.4")
    assert mixed["target"]["load_range"] == ["0.1", "0.4"]
    assert "composite_modulus" not in with_field(LINEAR, "material.young_modulus", "1 MPa")["material"]
    assert with_field(ADHESIVE, "contact.cap.kind", "elastic") != ADHESIVE


def test_a_problem_is_at_its_key_with_a_value_that_can_be_used():
    for key, typed, reason, offers in (
        ("limits.min_height", "12", "unit", {"limits.min_height": "10 um"}),
        ("limits.max_height", "120 kg", "mm", {"limits.max_height": "120 um"}),
        ("lattice.pitch", "1,500 mm", "decimals", {"lattice.pitch": "1.5 mm"}),
        ("lattice.shape", "8, a", "ntry 2 of lattice.shape", {}),
        ("material.poisson_ratio", "0.7", "0.5", {"material.poisson_ratio": "0.5"}),
        ("model.kind", "rigid", "nknown", {}),
    ):
        state = State("").edited(with_field(LINEAR, key, typed))
        answer = answered(state, 1)
        assert list(answer.problems) == [key]
        assert key in answer.problems[key]
        assert reason in answer.problems[key]
        assert answer.offers == offers
        assert contents(state, answer.problems)["problems"] == answer.problems
    assert "line 1" in answered(State("[limits"), 1).problems[""]


def test_the_form_has_a_field_for_each_key_and_the_names_of_messages():
    fields = {field["key"]: field for part in form() for keys in part["keys"].values() for field in keys}
    assert fields.keys() == {
        f"{section}.{key['name']}"
        for section, found in section_forms().items()
        for keys in found["keys"].values()
        for key in keys
        if key["value"] != "section" and section != "model"
    }
    parts = {part["name"]: part for part in form()}
    assert [parts["contact.cap"]["inner"], parts["contact"]["inner"]] == [
        {"key": "contact.kind", "kind": "jkr"}, None,
    ]  # fmt: skip
    largest = fields["limits.max_height"]
    assert largest["help"].startswith("Max height (limits.max_height): ")
    assert largest["help"].endswith(f"Example: {largest['example']}.")
    assert fields["part.feed"]["placeholder"] == "20 mm/min"
    broken = contents(State("[limits\n"), {"": "whatever"})
    assert ("not valid TOML" in broken["broken"], broken["problems"]) == (True, {})


@pytest.mark.parametrize("kinds", ["sampled linear bilinear", "power multilinear band"])
def test_a_target_of_another_kind_is_near_the_law(kinds):
    design, state = of_table(POINTS).design(), State("").edited(POINTS)
    for kind in kinds.split():
        found = of_table(with_kind_near(state, design, kind)).design()
        assert found.status is not mf.DesignStatus.MISSED
        high = min(found.law.rescaled_load[-1], design.law.rescaled_load[-1])
        load = np.linspace(0.3 * high, high, 20)
        one, other = (np.interp(load, each.law.rescaled_load, each.law.area) for each in (found, design))
        assert np.sqrt(((one / other - 1.0) ** 2).mean()) < 0.2, kind


def test_units_and_crossovers_stay_with_another_kind_and_examples_serve_without_a_design():
    state = State("").edited(with_only(LINEAR, "target", {"kind": "linear", "friction_coefficient": 1.55}))
    design = of_table(state.table).design()
    keys = {kind: with_kind_near(state, design, kind)["target"] for kind in KINDS}
    assert keys["operating-points"].keys() == {"kind", "load", "friction_force"}
    assert all(load.endswith(" N") for load in keys["sampled"]["load"] + keys["power"]["load_range"])
    assert keys["bilinear"].keys() == {"kind", "friction_coefficients", "crossover_load"}
    assert keys["linear"] == {"kind": "linear", "friction_coefficient": 1.55}
    for table, known in ((LINEAR, None), (with_values(LINEAR, {"limits.max_height": "120"}), design)):
        found = with_kind_near(State("").edited(table), known, "power")
        assert found == with_section(table, "target", "power")


@pytest.mark.parametrize("kind", ["operating-points", "linear", "bilinear", "multilinear"])
def test_a_target_in_other_units_keeps_its_law(kind):
    state = State("").edited(with_field(POINTS, "target.kind", kind))
    before = of_table(state.table)
    forces = state.edited(with_units(state, "target", 1, before))
    back = with_units(forces, "target", 0, of_table(forces.table))
    assert {"friction_force", "friction_coefficient", "friction_coefficients"} & forces.table["target"].keys()
    for found in (of_table(forces.table).target, of_table(back).target):
        for name in ("rescaled_load", "rescaled_friction", "slope", "slopes"):
            if (wanted := getattr(before.target, name, None)) is not None:
                np.testing.assert_allclose(getattr(found, name), wanted, rtol=1e-6)
