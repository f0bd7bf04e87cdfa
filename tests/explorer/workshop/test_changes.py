"""Fields change the specification as its text would be changed by hand."""

import tomllib

import numpy as np
import pytest

from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.text.fields import with_field
from metafem.explorer.workshop.changes import with_choice, with_section, without_section
from metafem.explorer.workshop.form import SECTIONS, contents, form
from metafem.files import demo_text, parsed, section_forms

TEXT = demo_text("operating-points")


@pytest.mark.parametrize(
    ("key", "given", "value"),
    [
        ("limits.max_height", "130 um", "130 um"),
        ("limits.max_height", " 130 ", "130 um"),
        ("limits.max_height", "", None),
        ("target.rescaled_load", "0.1 mm^2, 0.3 mm^2", ["0.1 mm^2", "0.3 mm^2"]),
        ("lattice.shape", "6, 10", [6, 10]),
        ("lattice.shape", "8 x 12", [8, 12]),
        ("friction.area_ratio", "0.9", 0.9),
        ("friction.area_ratio", "0,9", 0.9),
        ("layout.follow_law", "true", True),
        ("sites.empty", "3, 17", [3, 17]),
        ("model.kind", "layer", "layer"),
        ("part.formats", "stl, obj", ["stl", "obj"]),
    ],
)
def test_a_typed_text_becomes_the_value_of_its_key_alone(key, given, value):
    section, name = key.split(".")
    before, after = tomllib.loads(TEXT), tomllib.loads(with_field(TEXT, key, given))
    assert after.get(section, {}).get(name) == value
    before.setdefault(section, {}).pop(name, None)
    after.setdefault(section, {}).pop(name, None)
    assert after == before


@pytest.mark.slow
def test_what_is_shown_is_what_was_typed():
    """Typing what a field shows changes nothing, for the example of every key of every kind."""
    examples = {
        (kind, field["key"]): field["example"]
        for part in form()
        for kind, fields in part["keys"].items()
        for field in fields
    }
    for section in (each for each in section_forms() if each.name in SECTIONS):
        for kind in section.kinds or [""]:
            text = TEXT
            if section.name == "contact.cap":
                text = with_field(text, "contact.kind", "jkr")
            text = with_field(text, f"{section.name}.kind", kind) if kind else text
            for key in section.keys[kind]:
                if key.value == "section":
                    continue
                shown = examples[kind, f"{section.name}.{key.name}"]
                changed = with_field(text, f"{section.name}.{key.name}", shown)
                values = contents(changed, {})["values"]
                assert values[f"{section.name}.{key.name}"] == shown
                table = tomllib.loads(changed)
                for part in section.name.split("."):
                    table = table[part]
                assert table[key.name] == key.example


@pytest.mark.parametrize("section", [form for form in section_forms() if "." not in form.name])
def test_each_kind_and_each_choice_gives_a_specification_that_can_be_read(section):
    tables = {"wanted.csv": b"load_N,friction_force_N\n0.1,0.2\n0.2,0.5\n"}
    tables |= {"cap.csv": b"rho_um,f_um\n0,0\n200,39\n400,184\n600,600\n"}
    tables |= {"contact.csv": b"indentation_um,load_mN,area_mm2\n5,0.46,0.0083\n20,3.7,0.033\n90,35,0.15\n"}
    for kind in section.kinds or [""]:
        text = with_field(TEXT, f"{section.name}.kind", kind) if kind else with_section(TEXT, section.name)
        parsed(text, tables)
        for choice in {key.choice for key in section.keys[kind]} - {None}:
            parsed(with_choice(text, section.name, choice), tables)


@pytest.mark.parametrize("kind", ["operating-points", "sampled", "linear", "bilinear", "multilinear"])
def test_a_target_that_is_given_in_other_units_keeps_its_law(kind):
    text = with_field(TEXT, "target.kind", kind)
    before = parsed(text)
    forces = with_choice(text, "target", 1, before)
    back = with_choice(forces, "target", 0, parsed(forces))
    for found in (parsed(forces).target, parsed(back).target):
        for name in ("rescaled_load", "rescaled_friction", "slope", "slopes"):
            wanted = getattr(before.target, name, None)
            if wanted is not None:
                np.testing.assert_allclose(getattr(found, name), wanted, rtol=1e-6)
    assert "force" in forces or "coefficient" in forces


@pytest.mark.parametrize("section", [each.name for each in section_forms() if each.optional])
def test_an_optional_section_is_added_and_removed(section):
    text = without_section(with_field(TEXT, "contact.kind", "jkr"), section)
    assert Document(text).value(section) is None
    added = with_section(text, section)
    assert Document(added).value(section)
    assert with_section(added, section) == added
    if section != "sites":
        parsed(added)
    assert tomllib.loads(without_section(added, section)) == tomllib.loads(text)


def test_radii_to_choose_from_replace_the_radius_and_give_it_back():
    text = with_section(TEXT, "tools")
    assert "radius" not in tomllib.loads(text)["lattice"]
    assert parsed(text).tools == (0.3, 0.526)
    assert tomllib.loads(without_section(text, "tools"))["lattice"]["radius"] == "526 um"


def test_a_text_that_cannot_be_read_locks_the_fields():
    found = contents("[limits\n", {"": "whatever"})
    assert found["broken"].startswith("not valid TOML")
    assert found["problems"] == {}


def test_the_form_has_all_sections_without_the_model_which_is_in_the_header():
    assert {*SECTIONS, "model"} == {section.name for section in section_forms()}
    assert [part["name"] for part in form() if part["open"]] == ["target", "lattice", "limits"]


def test_every_key_has_a_field():
    keys = {field["key"] for part in form() for fields in part["keys"].values() for field in fields}
    assert keys == {
        f"{section.name}.{key.name}"
        for section in section_forms()
        for keys in section.keys.values()
        for key in keys
        if key.value != "section" and section.name in SECTIONS
    }


@pytest.mark.parametrize(
    ("key", "given", "words"),
    [
        ("limits.min_height", "2", "Needs a unit; write for example 10 um."),
        ("limits.max_height", "-1 um", "Must be greater than 0 um."),
        ("friction.area_ratio", "0.9 mm", "Must be a number without a unit"),
        ("lattice.shape", "8, a", "Entry 2 = 'a' must be"),
        ("target.kind", "linar", 'Is unknown; did you mean linear? (known: '),
    ],
)  # fmt: skip
def test_a_problem_at_its_field_leaves_out_what_stands_there(key, given, words):
    text = TEXT.replace('kind = "operating-points"', f'kind = "{given}"')
    text = text if key == "target.kind" else with_field(TEXT, key, given)
    found = contents(text, answered(State(text), 1).reasons)
    assert found["problems"][key].startswith(words)


def test_fields_have_help_and_the_default_among_their_options():
    fields = {field["key"]: field for part in form() for keys in part["keys"].values() for field in keys}
    assert fields["limits.max_height"]["help"].startswith("Largest height (limits.max_height): ")
    assert fields["limits.max_height"]["help"].endswith(f"Example: {fields['limits.max_height']['example']}.")
    mixed = fields["tools.mixed"]["options"]
    assert [value for value, _ in mixed] == ["", "true", "false"]
    assert mixed[0][1] in ("default (yes)", "default (no)")
