"""Types of keys and sections, from the definitions that read them, as parts of a JSON schema."""

from __future__ import annotations

import types
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

from metafem.files.samples import COLUMNS
from metafem.files.schema.quantities import pattern
from metafem.files.specification.fields import OneOf, Reader, Section
from metafem.files.specification.manual import as_toml, default_of, kind_of, remark

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo

Schema = dict[str, Any]

# Types of values without units, and what TOML calls them.
PLAIN = {float: "number", int: "integer", bool: "boolean", str: "string"}

# Names of bounds in annotations and in JSON schemas.
BOUNDS = {"ge": "minimum", "min_length": "minItems", "max_length": "maxItems"}


def section(model: type[Section], description: str) -> Schema:
    """Return the schema of a section without kinds."""
    return {
        "description": description,
        "type": "object",
        **_members(model),
        "properties": {name: key(field) for name, field in model.model_fields.items()},
        "additionalProperties": False,
    }


def kinds(models: Iterable[type[Section]], description: str) -> Schema:
    """Return the schema of a section of several kinds.

    All keys of all kinds stand in it once, so that an editor completes them and marks a single wrong key;
    what one kind needs and excludes follows as a condition.
    """
    of_kind = {kind_of(model): model for model in models}
    words = [(model.__doc__ or "").splitlines()[0] for model in of_kind.values()]
    found: dict[str, dict[str, Schema]] = {}
    for kind, model in of_kind.items():
        for name, field in model.model_fields.items():
            if name != "kind":
                found.setdefault(name, {})[kind] = key(field)
    kind_key = {
        "description": "\n".join(f"- {kind}: {text}" for kind, text in zip(of_kind, words, strict=True)),
        "type": "string",
        "enum": list(of_kind),
        "x-taplo": {"docs": {"enumValues": words}},
    }
    return {
        "description": description,
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": kind_key, **{name: _merged(name, of) for name, of in found.items()}},
        "additionalProperties": False,
        "allOf": [
            {
                "if": {**given("kind"), "properties": {"kind": {"enum": [kind]}}},
                "then": {
                    "allOf": [
                        refused(name for name in found if name not in model.model_fields),
                        _members(model),
                    ]
                },
            }
            for kind, model in of_kind.items()
        ],
    }


def key(field: FieldInfo) -> Schema:
    """Return the schema of a key."""
    optional = not field.is_required()
    sections = [part for part in get_args(field.annotation) if _is_section(part)]
    told = remark(field.description or "", optional, default_of(field))
    shown = field.examples or []
    description = f"{told}\n\nExample: {as_toml(shown[0])}" if shown else told
    value = kinds(sections, "") if sections else _value(field.annotation, field.metadata)
    return {**value, "description": description, "examples": shown}


def _members(model: type[Section]) -> Schema:
    """Return which keys a section needs, and which exclude each other."""
    needed = [name for name, field in model.model_fields.items() if field.is_required() and name != "kind"]
    schema: Schema = {"required": needed} if needed else {}
    if model.fewest:
        schema["minProperties"] = model.fewest
    return {**schema, **_choice(model)}


def _choice(model: type[Section]) -> Schema:
    """Return the condition that one of a section's choices of keys is given: the first, if none is begun."""
    every = {name for choice in model.choices for name in choice}
    found: Schema = {}
    for choice in model.choices:
        others = every - set(choice)
        if choice == ("file",):
            others |= COLUMNS[kind_of(model)].plain
        rule = {**given(*choice), **refused(sorted(others))}
        begun = {"anyOf": [given(name) for name in choice]}
        found = {"if": begun, "then": rule, "else": found} if found else rule
    return found


def _merged(name: str, of_kind: Mapping[str, Schema]) -> Schema:
    """Return one schema of a key that several kinds have."""
    parts = list(of_kind.values())
    types_ = [
        {word: part[word] for word in part if word not in ("description", "examples")} for part in parts
    ]
    if any(other != types_[0] for other in types_):
        raise TypeError(f"{name} has several types")
    texts: dict[str, list[str]] = {}
    for kind, part in of_kind.items():
        texts.setdefault(part["description"], []).append(kind)
    description = "\n\n".join(f"{', '.join(kinds)}: {text}" for text, kinds in texts.items())
    examples = [example for i, part in enumerate(parts) for example in part.get("examples", [])]
    unique = [example for i, example in enumerate(examples) if example not in examples[:i]]
    return {**parts[0], "description": description, "examples": unique}


def given(*names: str) -> Schema:
    """Return the schema that needs keys; that others are allowed is what some editors want stated."""
    return {"required": list(names), "additionalProperties": True}


def refused(names: Iterable[str]) -> Schema:
    """Return the schema that refuses keys."""
    return {"properties": dict.fromkeys(names, False), "additionalProperties": True}


def _value(annotation: Any, metadata: Iterable[Any]) -> Schema:
    """Return the schema of a type with its annotations."""
    metadata = [part for item in metadata for part in getattr(item, "metadata", [item])]
    bounds: Schema = {
        BOUNDS[name]: getattr(item, name) for item in metadata for name in BOUNDS if hasattr(item, name)
    }
    for item in metadata:
        reader = getattr(item, "func", None)
        if isinstance(reader, Reader):
            positive = any(getattr(other, "gt", None) == 0.0 for other in metadata)
            text = {"type": "string", "pattern": pattern(reader.units, positive)}
            pair = {"type": "array", "items": text, "minItems": 2, "maxItems": 2}
            return {"anyOf": [text, pair]} if reader.pairs else text
        if isinstance(item, OneOf):
            bounds["enum"] = list(item.names)
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _value(parts[0], [*parts[1:], *metadata])
    if origin in (Union, types.UnionType):
        (part,) = [part for part in parts if part is not type(None)]
        return _value(part, metadata)
    if origin is Literal:
        return {"type": "string", "enum": list(parts)}
    if origin is list or (origin is tuple and parts[-1] is Ellipsis):
        return {"type": "array", "items": _value(parts[0], []), **bounds}
    if origin is tuple:  # of one type throughout
        return {
            "type": "array",
            "items": _value(parts[0], []),
            "minItems": len(parts),
            "maxItems": len(parts),
        }
    return {"type": PLAIN[annotation], **bounds}


def _is_section(part: Any) -> bool:
    return isinstance(part, type) and issubclass(part, Section)
