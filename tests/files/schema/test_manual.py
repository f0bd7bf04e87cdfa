"""The manual of specifications, made from the classes that read them."""

import pytest

import metafem as mf
from metafem.files import Specification, all_keys, manual
from metafem.files.specification.contents import Sections
from metafem.files.specification.forms import as_toml

KEYS = all_keys()
KINDS = sorted({key.kind for key in KEYS if key.section == "target"})
LAWS = sorted({key.kind for key in KEYS if key.section == "contact"})

# Keys that exclude others, and a table that is not there.
FIRST = {
    "composite_modulus",
    "load",
    "friction_force",
    "friction_coefficient",
    "friction_coefficients",
    "file",
    "radius",
    "range",
    "step",
    "mixed",
}
SECOND = {
    "young_modulus",
    "rescaled_load",
    "rescaled_friction",
    "slope",
    "slopes",
    "file",
    "radius",
    "tools",
    "mixed",
}
THIRD = FIRST - {"radius"} | {"tools"}


@pytest.mark.parametrize("left_out", [FIRST, SECOND, THIRD], ids=["either", "or", "one radius"])
@pytest.mark.parametrize(
    ("kind", "law"), [*((kind, "hertz") for kind in KINDS), *(("linear", law) for law in LAWS)]
)
def test_the_examples_make_a_specification(tmp_path, kind, law, left_out):
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
    path = tmp_path / "spec.toml"
    text = "\n".join(lines)
    path.write_text(text if law == "hertz" else text.replace('"layer"', '"independent"'), "utf-8")
    assert isinstance(mf.read_spec(path), Specification)


def test_the_manual_lists_every_section_kind_and_key():
    text = manual()
    for name, field in Sections.model_fields.items():
        assert f"[{name}]" in text
        assert field.description in text
    assert all(f'\nkind = "{kind}"' in text for kind in [*KINDS, *LAWS])
    assert all(key.meaning and f"\n{key.name} = {as_toml(key.example)}" in text for key in KEYS)


def test_optional_keys_are_marked():
    lines = {line.split("=")[0].strip(): line for line in manual().splitlines()}
    assert "# optional, default 0.5: " in lines["poisson_ratio"]
    assert "# optional: " in lines["hardness"]
    assert "# either: " in lines["slope"]
    assert "optional" not in lines["max_height"]
