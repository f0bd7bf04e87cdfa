"""The JSON schema of a specification; editors use its file to complete keys and to mark errors."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from metafem.errors import InvalidInput
from metafem.files.atomic import write_text
from metafem.files.laws import COLUMNS
from metafem.files.specification.forms import (
    KeyForm,
    Schema,
    SectionForm,
    as_toml,
    section_forms,
    whole_schema,
)
from metafem.files.specification.manual import remark

# Name of the schema's file, to which the specifications of the demonstrations refer.
SCHEMA_FILE = "metafem.schema.json"

# First keys of the schema, which identify its file. Language servers for TOML read draft 7 of JSON Schema.
FIRST = {
    "$schema": "http://json-schema.org/draft-07/schema#",
    "title": "Specification of metafem",
}

MEANING = (
    "Specification of a surface for `metafem design`. Quantities are texts with their unit. "
    "The usual units are listed here; metafem reads others too."
)


def schema() -> dict[str, Any]:
    """Return the JSON schema of a specification.

    Examples
    --------
    >>> found = schema()["properties"]["limits"]
    >>> found["required"], "max_hight" in found["properties"]
    (['max_height'], False)
    """
    whole = whole_schema()
    return {
        **FIRST,
        "description": MEANING,
        "type": "object",
        "required": whole["required"],
        "properties": {
            form.name: section(form, remark(form.meaning, form.optional, None))
            for form in section_forms()
            if "." not in form.name
        },
        "additionalProperties": False,
        **ONE_RADIUS,
    }


def schema_text() -> str:
    """Return the text of the schema's file."""
    return json.dumps(schema(), indent=2, ensure_ascii=False) + "\n"


def write_schema(path: Path, force: bool = False) -> None:
    """Write the schema unless the file already contains it; `force` replaces another schema of metafem."""
    if path.is_file() and path.read_bytes() == schema_text().encode("utf-8"):
        return
    write_text(path, schema_text(), force=force)


def place_schema(folder: Path) -> str | None:
    """Write the schema next to a specification; return a remark if another file already has its name."""
    path = folder / SCHEMA_FILE
    try:
        write_schema(path)
    except InvalidInput:
        if not os.path.lexists(path):
            raise
        return (
            f"{path} exists and differs from the schema of this version; "
            f"`metafem spec --schema -o {path} --force` renews it"
        )
    return None


def section(form: SectionForm, description: str) -> Schema:
    """Return the schema of a section.

    It contains each key of all kinds once, so that an editor can complete every key, and marks only the key
    that is wrong. Conditions state which keys a kind requires and which it excludes.
    """
    found: dict[str, list[KeyForm]] = {}
    for keys in form.keys.values():
        for each in keys:
            found.setdefault(each.name, []).append(each)
    properties = {name: _merged(of_kinds) for name, of_kinds in found.items()}
    whole = {"description": description, "type": "object", "additionalProperties": False}
    if not form.kinds:
        return {**whole, **_needed(form.keys[""]), "properties": properties}
    words = list(form.kinds.values())
    kind = {
        "description": "\n".join(f"- {name}: {text}" for name, text in form.kinds.items()),
        "type": "string",
        "enum": list(form.kinds),
        "x-taplo": {"docs": {"enumValues": words}},
    }
    conditions = [
        {
            "if": {**given("kind"), "properties": {"kind": {"enum": [name]}}},
            "then": {"allOf": [refused(set(found) - {key.name for key in keys}), _needed(keys, name)]},
        }
        for name, keys in form.keys.items()
    ]
    return {**whole, "required": ["kind"], "properties": {"kind": kind, **properties}, "allOf": conditions}


def given(*names: str) -> Schema:
    """Return the schema that requires the keys `names`.

    It states explicitly that other keys are allowed, because some editors need this.
    """
    return {"required": list(names), "additionalProperties": True}


def refused(names: Iterable[str]) -> Schema:
    """Return the schema that refuses the keys `names`."""
    return {"properties": dict.fromkeys(sorted(names), False), "additionalProperties": True}


def _needed(keys: Sequence[KeyForm], kind: str = "") -> Schema:
    """Return the schema of the keys that a section requires, and of those that exclude each other."""
    needed = [key.name for key in keys if not key.optional]
    found: Schema = {"required": needed} if needed else {}
    return {**found, **_choice(keys, kind)}


def _choice(keys: Sequence[KeyForm], kind: str) -> Schema:
    """Return the condition that one alternative set of keys is present.

    If no key of these sets is present, editors report the keys of the first set as missing.
    """
    choices: dict[int, list[str]] = {}
    for key in keys:
        if key.choice is not None:
            choices.setdefault(key.choice, []).append(key.name)
    every = {name for names in choices.values() for name in names}
    found: Schema = {}
    for _, names in sorted(choices.items()):
        others = every - set(names)
        if names == ["file"]:
            others |= COLUMNS[kind].plain
        rule = {**given(*names), **refused(others)}
        begun = {"anyOf": [given(name) for name in names]}
        found = {"if": begun, "then": rule, "else": found} if found else rule
    return found


def _merged(keys: Sequence[KeyForm]) -> Schema:
    """Return one schema for a key that belongs to several kinds; its description covers all of them."""
    texts: dict[str, list[str]] = {}
    for key in keys:
        words = remark(key.meaning, key.optional, key.default)
        if key.example is not None:
            words = f"{words}\n\nExample: {as_toml(key.example)}"
        texts.setdefault(words, []).append(key.kind or "")
    examples = [key.example for key in keys if key.example is not None]
    unique = [example for i, example in enumerate(examples) if example not in examples[:i]]
    description = "\n\n".join(f"{', '.join(kinds)}: {text}" for text, kinds in texts.items())
    return {**_value(keys[0]), "description": description.removeprefix(": "), "examples": unique}


def _value(key: KeyForm) -> Schema:
    """Return the schema of the value of a key."""
    if key.value == "section":
        inner = next(form for form in section_forms() if form.name == f"{key.section}.{key.name}")
        return section(inner, "")
    return key.schema


# Condition that radii are stated once, either by the key lattice.radius or by the section [tools].
ONE_RADIUS = {
    "if": {
        **given("tools"),
        "properties": {"tools": {"anyOf": [given("radii"), given("radius_range")]}},
    },
    "then": {"properties": {"lattice": refused(["radius"])}, "additionalProperties": True},
    "else": {
        "properties": {"lattice": given("radius")},
        "additionalProperties": True,
    },
}
