"""The JSON schema of specifications: valid, and in agreement with the parser."""

import copy
import json
import re
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft7Validator
from pydantic import ValidationError

from metafem import read_spec
from metafem.errors import InvalidInput
from metafem.files import DEMOS, all_keys, demo_text, place_schema, schema_text, write_schema
from metafem.files.schema.document import SCHEMA_FILE, schema
from metafem.files.specification.contents import Sections
from metafem.files.specification.named_tables import in_folder, with_tables

SCHEMA = schema()
EDITOR = Draft7Validator(SCHEMA)
LINEAR = demo_text("linear")
KEYS = all_keys()

# Relations between the values of keys, which a schema cannot express.
RELATIONS = re.compile("entries of|must increase|an error above 0")

TABLES = {
    "wanted.csv": "load_N,friction_force_N\n0.1,0.2\n0.2,0.4\n",
    "cap.csv": "rho_mm,f_um\n0,0\n0.2,39\n0.4,184\n",
    "contact.csv": "indentation_um,load_mN,area_mm2\n5,0.46,0.0083\n20,3.7,0.033\n",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tables")
    for name, text in TABLES.items():
        (folder / name).write_text(text, "utf-8")
    return folder


def parsed(table, folder):
    """Return whether the parser accepts the names, types, units and choices of a specification."""
    try:
        filled, _ = with_tables("", table, in_folder(folder))
        sections = Sections.model_validate(filled)
    except InvalidInput:
        return False
    except ValidationError as error:
        return all(RELATIONS.search(detail["msg"]) for detail in error.errors())
    return not any(problem.key == "lattice.radius" for problem in sections.build()[1])


def test_the_schema_is_valid_and_its_text_is_read_back():
    Draft7Validator.check_schema(SCHEMA)
    assert json.loads(schema_text()) == SCHEMA


@pytest.mark.parametrize("name", DEMOS)
def test_demos_follow_the_schema_that_they_name(name):
    text = demo_text(name)
    assert f"\n#:schema ./{SCHEMA_FILE}\n" in text[: text.index("\n[")]
    assert list(EDITOR.iter_errors(tomllib.loads(text))) == []


def test_every_key_is_described_with_its_example_and_default():
    for key in KEYS:
        found = SCHEMA["properties"][key.section]["properties"][key.name]
        assert key.meaning in found["description"], key
        assert found.get("examples") is None or key.example in found["examples"]
    properties = SCHEMA["properties"]
    assert properties["material"]["properties"]["poisson_ratio"]["description"].startswith(
        "optional, default 0.5: "
    )
    assert properties["target"]["properties"]["kind"]["enum"][:2] == ["operating-points", "linear"]
    assert "bilinear" in properties["target"]["properties"]["crossover_load"]["description"]


def made(kind, law):
    """Return a specification of the examples of all keys, without those that others exclude."""
    table = {}
    for section in Sections.model_fields:
        chosen = {"target": kind, "contact": law}.get(section)
        members = {"kind": chosen} if chosen else {}
        for key in KEYS:
            if key.section == section and key.kind in (None, chosen):
                members[key.name] = copy.deepcopy(key.example)
        table[section] = members
    for section, name in (("material", "young_modulus"), ("radii", "range")):
        table[section].pop(name, None)
    for name in ("load", "friction_force", "file", "friction_coefficient", "friction_coefficients"):
        table["target"].pop(name, None)
    table["contact"].pop("file", None)
    del table["lattice"]["radius"]
    return table


KINDS = sorted({key.kind for key in KEYS if key.section == "target"})
LAWS = sorted({key.kind for key in KEYS if key.section == "contact"} | {"hertz", "sphere"})
EXAMPLES = [*(made(kind, "hertz") for kind in KINDS), *(made("linear", law) for law in LAWS)]


@pytest.mark.parametrize("table", EXAMPLES, ids=[*KINDS, *LAWS])
def test_examples_of_every_kind_follow_the_schema(table, folder):
    assert list(EDITOR.iter_errors(table)) == []
    assert parsed(table, folder)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("slope = 6.87", "slop = 6.87"),
        ("slope = 6.87", ""),
        ("slope = 6.87", "slope = 6.87\nfriction_coefficient = 1.5"),
        ("slope = 6.87", 'slope = "6.87"'),
        ("slope = 6.87", "slopes = [6.87, 7.0]"),
        ('kind = "linear"', 'kind = "linar"'),
        ('kind = "linear"', 'kind = "bilinear"'),
        ('kind = "linear"', ""),
        ('= "1.36 MPa"', "= 1.36"),
        ('= "1.36 MPa"', '= "1.36"'),
        ('= "1.36 MPa"', '= "1.36 mm"'),
        ('= "1.36 MPa"', '= "1,36 MPa"'),
        ('composite_modulus = "1.36 MPa"', ""),
        ('composite_modulus = "1.36 MPa"', 'composite_modulus = "1.36 MPa"\nyoung_modulus = "1 MPa"'),
        ("[8, 8]", "[8, 8, 8]"),
        ("[8, 8]", "[8.5, 8]"),
        ("[8, 8]", "8"),
        ('pitch = "1.5 mm"', ""),
        ('pitch = "1.5 mm"', 'pitch = ["1.5 mm"]'),
        ('radius = "526 um"', ""),
        ("[limits]", '[radii]\ntools = ["526 um"]\n[limits]'),
        ("[limits]", "[robust]\n[limits]"),
        ("[limits]", "[limit]"),
        ('max_height = "120 um"', 'max_hight = "120 um"'),
        ("seed = 0", "seed = -1"),
        ("seed = 0", "seed = true"),
        ("seed = 0", 'tilt = "0.1 mm"'),
        ('kind = "independent"', 'kind = "layers"'),
        ('formats = ["stl"]', 'formats = ["step"]'),
        ('formats = ["stl"]', 'chord_error = "0 um"'),
        ("[model]", '[contact]\nkind = "jkr"\n[model]'),
        ("[model]", '[contact]\nkind = "jkr"\nadhesion_energy = "9 mJ/m^2"\ncap.kind = "jkr"\n[model]'),
        ("[model]", '[contact]\nkind = "power"\nexponent = true\n[model]'),
        ("[model]", '[contact]\nkind = "profile"\nrho = ["0 um", "1 um"]\n[model]'),
        ("[model]", '[contact]\nkind = "hertz"\nfile = "cap.csv"\n[model]'),
    ],
)
def test_errors_are_marked_by_the_schema_and_refused_by_the_parser(old, new, tmp_path):
    text = f'{LINEAR}formats = ["stl"]\n'
    assert text.count(old) == 1
    table = tomllib.loads(text.replace(old, new))
    assert not EDITOR.is_valid(table)
    path = tmp_path / "bad.toml"
    path.write_text(text.replace(old, new), "utf-8")
    with pytest.raises(InvalidInput):
        read_spec(path)


VALUES = [
    *("1 mm", "2mm", " 3 um ", "-1 um", "0 um", "1e3 nm", "1.2.3 mm", "1 mx", "5"),
    *("2 mm^2", "2 mm2", "2 mm²", "2 N", "3 MPa", "3 N/mm**2", "0.1 deg", "9 mJ/m^2"),
    *(1.5, 3, -2, True, False, "", "stl", "layer", "hertz"),
    *([], [1, 2], [3], ["1 mm"], ["1 mm", "2 mm"], ["1 N", "2 N"], ["stl"], ["1 mm^2", ["1 N", "2 N"]]),
    *({}, {"kind": "sphere"}, {"kind": "power", "exponent": 3}, {"kind": "jkr", "adhesion_energy": "1 N/m"}),
]


@st.composite
def changed(draw):
    """Return one of the examples with one to three changes."""
    table = copy.deepcopy(draw(st.sampled_from(EXAMPLES)))
    for _ in range(draw(st.integers(1, 3))):
        section = draw(st.sampled_from(sorted(table)))
        members = table[section]
        if not isinstance(members, dict):
            continue
        change = draw(st.sampled_from(["value", "key", "drop", "rename", "kind", "section"]))
        names = sorted(members)
        if change == "value" and names:
            name = draw(st.sampled_from(names))
            members[name] = draw(st.sampled_from(VALUES)) if name != "file" else members[name]
        elif change == "key":
            key = draw(st.sampled_from([key for key in KEYS if key.section == section] or KEYS))
            members[key.name] = copy.deepcopy(key.example)
        elif change == "drop" and names:
            del members[draw(st.sampled_from(names))]
        elif change == "rename" and names:
            name = draw(st.sampled_from(names))
            members[f"{name}s"] = members.pop(name)
        elif change == "kind" and "kind" in members:
            members["kind"] = draw(st.sampled_from([*KINDS, *LAWS]))
        elif change == "section":
            del table[section]
            if draw(st.booleans()):
                table[f"{section}s"] = members
    return table


@given(table=changed())
def test_schema_and_parser_agree(folder, table):
    assert EDITOR.is_valid(table) == parsed(table, folder)


def test_a_schema_is_replaced_only_if_metafem_wrote_it(tmp_path):
    path = tmp_path / SCHEMA_FILE
    write_schema(path)
    assert path.read_text("utf-8") == schema_text()
    write_schema(path)  # it holds the schema already
    assert place_schema(tmp_path) is None
    older = schema_text().replace('"additionalProperties": false', '"additionalProperties": true')
    path.write_text(older, "utf-8")
    assert "metafem spec --schema -o" in place_schema(tmp_path)
    assert path.read_text("utf-8") == older
    with pytest.raises(InvalidInput, match="exists"):
        write_schema(path)
    write_schema(path, force=True)
    assert path.read_text("utf-8") == schema_text()
    path.write_text("{}", "utf-8")
    with pytest.raises(InvalidInput, match="not written by metafem"):
        write_schema(path, force=True)


def test_a_schema_that_cannot_be_written_is_an_error(tmp_path):
    with pytest.raises(InvalidInput):
        place_schema(tmp_path / "missing")
