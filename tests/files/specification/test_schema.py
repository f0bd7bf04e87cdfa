"""The manual and the JSON schema of specifications: valid, and in agreement with the parser."""

import copy
import json
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft7Validator
from pydantic import ValidationError

from metafem import read_spec
from metafem.errors import InvalidInput
from metafem.files import DEMOS, all_keys, demo_text, manual, place_schema, schema_text, write_schema
from metafem.files.specification.contents import Sections
from metafem.files.specification.forms import as_toml
from metafem.files.specification.named_tables import in_folder, with_tables
from metafem.files.specification.schema import SCHEMA_FILE, schema
from tests.files.specification.wrong import LINEAR, WRONG

SCHEMA = schema()
EDITOR = Draft7Validator(SCHEMA)
KEYS = all_keys()

# A relation between the values of keys, which a schema cannot express.
RELATION = "an error above 0"

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
        filled = copy.deepcopy(table)
        with_tables("", filled, in_folder(folder))
        sections = Sections.model_validate(filled)
    except InvalidInput:
        return False
    except ValidationError as error:
        return all(RELATION in detail["msg"] for detail in error.errors())
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


# Keys of the manual that exclude others, and a table that is not there.
COMMON = {
    *("load", "friction_force", "friction_coefficient", "friction_coefficients", "file", "radius", "caps"),
    "shear_strengths",  # which adhesive laws exclude
}
EXPONENTS = {"exponent_range", "exponent_step", "coefficient"}
FIRST = {
    *("composite_modulus", "radius_range", "step", "mixed", "lowest_force", "highest_force"),
    *(COMMON | EXPONENTS),
}
SECOND = {
    *("young_modulus", "rescaled_load", "rescaled_friction", "lowest", "highest", "slope", "slopes", "file"),
    *("radius", "radii", "caps", "shear_strengths", *EXPONENTS),
}
THIRD = FIRST - {"radius"} | {"radii", "caps"}


def made(kind, law, left_out):
    """Return the text of a specification of the manual's examples."""
    lines, chosen = [], {"target": kind, "contact": law}
    for section in Sections.model_fields:
        absent = {"file"} if section == "contact" else left_out
        keys = [
            key for key in KEYS
            if key.section == section and key.kind in (None, chosen.get(section)) and key.name not in absent
        ]  # fmt: skip
        if keys or section in chosen:
            lines.append(f"[{section}]")
        if section in chosen:
            lines.append(f'kind = "{chosen[section]}"')
        lines += [f"{key.name} = {as_toml(key.example)}" for key in keys]
    text = "\n".join(lines)
    return text if law == "hertz" else text.replace('"layer"', '"independent"')


KINDS = sorted({key.kind for key in KEYS if key.section == "target"})
LAWS = sorted({key.kind for key in KEYS if key.section == "contact"} | {"hertz", "sphere"})
PAIRS = [*((kind, "hertz") for kind in KINDS), *(("linear", law) for law in LAWS)]
EXAMPLES = [tomllib.loads(made(*pair, FIRST)) for pair in PAIRS]


@pytest.mark.parametrize("left_out", [FIRST, SECOND, THIRD], ids=["either", "or", "one radius"])
@pytest.mark.parametrize("pair", PAIRS, ids=map("-".join, PAIRS))
def test_the_examples_of_the_manual_make_specifications(tmp_path, pair, left_out):
    (tmp_path / "spec.toml").write_text(made(*pair, left_out), "utf-8")
    read_spec(tmp_path / "spec.toml")
    table = tomllib.loads(made(*pair, left_out))
    assert list(EDITOR.iter_errors(table)) == []


def test_the_manual_lists_every_section_kind_and_key():
    text = manual()
    for name, field in Sections.model_fields.items():
        assert f"[{name}]" in text
        assert field.description in text
    assert all(f'\nkind = "{kind}"' in text for kind in [*KINDS, *LAWS])
    assert all(key.meaning and f"\n{key.name} = {as_toml(key.example)}" in text for key in KEYS)
    lines = {line.split("=")[0].strip(): line for line in text.splitlines()}
    assert "# optional, default 0.5: " in lines["poisson_ratio"]
    assert "# optional: " in lines["hardness"]
    assert "# either: " in lines["slope"]
    assert "optional" not in lines["max_height"]


# Relations and numbers that a schema cannot express.
BEYOND = {
    *("out of range", "bad slope", "bad block", "bad radius", "bad limits", "endless shape"),
    *("absurd shape", "alignment of one", "mixed range", "falling loads", "no tilt", "weight alone"),
    *("nan", "truncated"),
}


@pytest.mark.parametrize("case", sorted(WRONG.keys() - BEYOND))
def test_errors_are_marked_by_the_schema(case):
    old, new, _ = WRONG[case]
    assert not EDITOR.is_valid(tomllib.loads(LINEAR.replace(old, new)))


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
