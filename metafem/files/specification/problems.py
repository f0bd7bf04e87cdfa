"""Problems of a specification, from the errors of pydantic."""

from __future__ import annotations

from typing import Any

from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.specification.forms import Schema, all_keys, as_toml, sections_of, whole_schema
from metafem.files.specification.models import suggestion
from metafem.files.units import as_written

# Requirements by pydantic's name of the error; braces hold the violated bound.
MUST = {
    "float_type": "must be a number, without quotes and unit",
    "finite_number": "must be a finite number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false, without quotes",
    "string_type": "must be a text in quotes",
    "list_type": "must be a list in square brackets",
    "tuple_type": "must be a list in square brackets",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "too_short": "must have at least {min_length} entries",
    "too_long": "must have at most {max_length} entries",
}


def problem(detail: Any) -> InvalidInput:
    """Return one of pydantic's errors, with its key."""
    kind, given = detail["type"], detail["input"]
    keys, last, sections = _located(detail["loc"])
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{printable(part, 60)}" for part in keys)[1:]
    name = next((part for part in reversed(keys) if isinstance(part, str)), "")
    if kind == "value_error":
        reason: InvalidInput = detail["ctx"]["error"]
        return reason.at(key)
    if kind == "extra_forbidden":
        what = "section" if len(keys) == 1 else "key"
        return InvalidInput(f"is an unknown {what}{suggestion(name, tuple(last['properties']))}", key=key)
    if kind == "missing" and len(keys) == 1:
        return InvalidInput(f"is missing; write a section [{key}]", key=key)
    if kind == "missing":
        return InvalidInput("is missing", key=key, example=_example(keys[0], name))
    if kind == "union_tag_not_found":
        return InvalidInput("is missing", key=f"{key}.kind", example=f'kind = "{next(iter(sections))}"')
    if kind == "union_tag_invalid":
        tag, known = printable(str(detail["ctx"]["tag"]), 60), tuple(sections)
        return InvalidInput(f"is unknown{suggestion(tag, known)}", key=f"{key}.kind", value=f'"{tag}"')
    must, example = MUST.get(kind, "cannot be used"), _example(keys[0], name)
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        must, example = f"must be a section: write [{key}] on a line of its own", ""
    must = must.format(**detail.get("ctx", {}))
    value = (
        given if isinstance(given, float) else as_written(given)
    )  # a float may be a quantity that was read
    return InvalidInput(must, key=key, value=value, example=example)


def _located(place: tuple[Any, ...]) -> tuple[list[Any], Schema, dict[str, Schema]]:
    """Return the keys of a location, the section of the last key, and the sections of its value.

    pydantic includes the kind of a section in the location.
    """
    keys: list[Any] = []
    last = whole_schema()
    sections = {"": last}
    for part in place:
        if keys and part in sections:
            sections = {"": sections[part]}
            continue
        keys.append(part)
        if len(sections) == 1:
            last = next(iter(sections.values()))
        sections = sections_of(last["properties"].get(part, {}))
    return keys, last, sections


def _example(section: str, name: str) -> str:
    """Return a line with an example of a key, for the end of an error; "" for an unknown key."""
    for key in all_keys():
        if (key.section, key.name) == (section, name):
            return f"{name} = {as_toml(key.example)}"
    return ""
