"""The JSON schema of a whole specification, and its file."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from metafem.errors import InvalidInput
from metafem.files.atomic import write_text
from metafem.files.schema.keys import given, refused, section
from metafem.files.schema.manual import remark
from metafem.files.specification.forms import section_forms, whole_schema

# Name of the schema in the specifications of the demos, relative to their folder.
SCHEMA_FILE = "metafem.schema.json"

# Language servers of TOML read draft 7 of JSON Schema; its first keys identify the file.
FIRST = {
    "$schema": "http://json-schema.org/draft-07/schema#",
    "title": "Specification of metafem",
}

MEANING = (
    "Specification of a surface for `metafem design`. Quantities are texts with their unit. "
    "The usual units are listed here; metafem reads others too."
)

# Radii are stated once: the radius of the lattice, or the radii to choose from.
ONE_RADIUS = {
    "if": given("radii"),
    "then": {"properties": {"lattice": refused(["radius"])}, "additionalProperties": True},
    "else": {
        "properties": {"lattice": given("radius")},
        "additionalProperties": True,
    },
}


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
    """Return the schema as the text of its file."""
    return json.dumps(schema(), indent=2, ensure_ascii=False) + "\n"


def write_schema(path: Path, force: bool = False) -> None:
    """Write the schema unless the file already holds it; with `force` a schema of metafem is replaced."""
    if path.is_file() and path.read_bytes() == schema_text().encode("utf-8"):
        return
    write_text(path, schema_text(), force=force, kind="schema")


def place_schema(folder: Path) -> str | None:
    """Write the schema next to a specification, and return a remark if another file is in its place."""
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
