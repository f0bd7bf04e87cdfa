"""Keys and sections of a specification, as parts of a JSON schema that editors understand."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from metafem.files.samples import COLUMNS
from metafem.files.schema.manual import remark
from metafem.files.specification.forms import KeyForm, Schema, SectionForm, as_toml, section_forms


def section(form: SectionForm, description: str) -> Schema:
    """Return the schema of a section.

    It contains all keys of all kinds once, so that an editor completes them and marks a single wrong key;
    conditions state which keys a kind requires and excludes.
    """
    found: dict[str, list[KeyForm]] = {}
    for keys in form.keys.values():
        for each in keys:
            found.setdefault(each.name, []).append(each)
    properties = {name: _merged(of_kinds) for name, of_kinds in found.items()}
    whole = {"description": description, "type": "object", "additionalProperties": False}
    if not form.kinds:
        return {**whole, **_needed(form.keys[""], fewest=form.fewest), "properties": properties}
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
    """Return the schema that requires keys; it states that others are allowed, as some editors need it."""
    return {"required": list(names), "additionalProperties": True}


def refused(names: Iterable[str]) -> Schema:
    """Return the schema that refuses keys."""
    return {"properties": dict.fromkeys(sorted(names), False), "additionalProperties": True}


def _needed(keys: Sequence[KeyForm], kind: str = "", fewest: int = 0) -> Schema:
    """Return which keys a section needs, and which exclude each other."""
    needed = [key.name for key in keys if not key.optional]
    found: Schema = {"required": needed} if needed else {}
    if fewest:
        found["minProperties"] = fewest
    return {**found, **_choice(keys, kind)}


def _choice(keys: Sequence[KeyForm], kind: str) -> Schema:
    """Return the condition that one choice of a section's keys is present: the first one if no key is."""
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
    """Return one schema of a key that several kinds have."""
    values = [_value(key) for key in keys]
    if any(other != values[0] for other in values):
        raise TypeError(f"{keys[0].name} has several types")
    texts: dict[str, list[str]] = {}
    for key in keys:
        words = remark(key.meaning, key.optional, key.default)
        if key.example is not None:
            words = f"{words}\n\nExample: {as_toml(key.example)}"
        texts.setdefault(words, []).append(key.kind or "")
    examples = [key.example for key in keys if key.example is not None]
    unique = [example for i, example in enumerate(examples) if example not in examples[:i]]
    description = "\n\n".join(f"{', '.join(kinds)}: {text}" for text, kinds in texts.items())
    return {**values[0], "description": description.removeprefix(": "), "examples": unique}


def _value(key: KeyForm) -> Schema:
    """Return the schema of the value of a key."""
    if key.value == "section":
        inner = next(form for form in section_forms() if form.name == f"{key.section}.{key.name}")
        return section(inner, "")
    schema: Schema = without_own_words(key.schema)
    return schema


def without_own_words(part: Any) -> Any:
    """Return a part of a schema without the words that only metafem knows."""
    if isinstance(part, list):
        return [without_own_words(each) for each in part]
    if not isinstance(part, dict):
        return part
    return {name: without_own_words(each) for name, each in part.items() if name != "x-units"}
