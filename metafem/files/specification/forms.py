"""The JSON schema of a specification, the descriptions of its keys, and the manual."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from metafem.files.specification.fields import BOUNDS, Section
from metafem.files.specification.sections import Sections

Schema = dict[str, Any]

# Column in which the comments of the manual begin; most examples are shorter.
COLUMN = 48

# First words of the meaning of a key in an alternative set of keys, of which one set is required.
CHOICES = ("either: ", "or: ", "with it: ")

HEAD = """\
# Every section and key of a specification for `metafem design`, each with an example value. This is a list,
# not a file to read: a specification has one kind of target, and one of the keys marked either and or.
# Sections and keys are required unless they are marked optional. Lengths, areas, forces, stresses and
# angles are written with their unit. `metafem demo linear` writes a whole example file.
# `metafem spec --schema` prints the JSON schema, by which an editor completes keys and marks errors.
# The misfit of a design is the rms of the relative difference between the law and the target or, if larger,
# the largest relative error of a fitted slope. For operating points, and for linear and bilinear laws with a
# load_range, it is the largest relative error. Above 1 % (and the errors of samples) the target is missed.
# Linear and bilinear laws without a load_range are compared with the law of their height density: above 1 %
# a note says so, above 10 % the target is missed.
"""

# The kind of a value without a unit, by its type in a JSON schema.
PLAIN = {"number": "number", "integer": "integer", "boolean": "truth", "string": "text"}


@dataclass(frozen=True)
class KeyForm:
    """The description of a key and of its value.

    `meaning` ends with the bounds, which are in `unit`. `value` is quantity, number, integer, truth, text or
    section, of the value or of a list's entries, which with `pairs` can be lists of two; `units` are the
    usual ones, `names` the allowed texts. `kind` is that of the section, or None. `choice` is the number of
    the alternative set to which the key belongs, or None; a section needs the keys of one set.
    """

    section: str
    kind: str | None
    name: str
    example: Any
    meaning: str
    optional: bool
    default: Any
    choice: int | None
    value: str
    unit: str
    units: tuple[str, ...]
    names: tuple[str, ...]
    listed: bool
    pairs: bool

    @property
    def needed(self) -> bool:
        """Whether the key is required, or belongs to the first alternative set of keys."""
        return not self.optional or self.choice == 0


@dataclass(frozen=True)
class SectionForm:
    """The description of a section: a sentence on each kind, if it has kinds, and its keys by kind or ""."""

    name: str
    meaning: str
    optional: bool
    kinds: dict[str, str]
    keys: dict[str, tuple[KeyForm, ...]]

    @property
    def every(self) -> tuple[KeyForm, ...]:
        """The keys of all kinds."""
        return tuple(key for keys in self.keys.values() for key in keys)


@cache
def whole_schema(sections: type[Section] = Sections) -> Schema:
    """Return the JSON schema of a specification, by which editors complete keys and mark errors.

    Examples
    --------
    >>> "max_height" in whole_schema()["$defs"]["LimitsSection"]["properties"]
    True
    """
    # language servers for TOML read draft 7 of JSON Schema
    return {"$schema": "http://json-schema.org/draft-07/schema#", **sections.model_json_schema()}


def schema_text() -> str:
    """Return the text of the schema's file."""
    return json.dumps(whole_schema(), indent=2, ensure_ascii=False) + "\n"


@cache
def section_forms(sections: type[Section] = Sections) -> dict[str, SectionForm]:
    """Return the descriptions of all sections by name, in the order of the manual.

    If the value of a key is itself a section, such as ``contact.cap``, that section follows.

    Examples
    --------
    >>> section_forms()["limits"].keys[""][0].units[:3], section_forms()["contact"].kinds["hertz"]
    (('nm', 'um', 'mm'), 'Elastic paraboloids with the curvature of each summit.')
    """
    whole = whole_schema(sections)
    every = (
        form
        for name, given in whole["properties"].items()
        for form in _forms(name, given, name not in whole["required"], whole["$defs"])
    )
    return {form.name: form for form in every}


def all_keys() -> tuple[KeyForm, ...]:
    """Return the descriptions of all keys, except the keys of nested sections."""
    return tuple(key for form in section_forms().values() if "." not in form.name for key in form.every)


def as_toml(value: Any) -> str:
    """Return the TOML text of an example."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {as_toml(member)}' for key, member in value.items())}}}"
    return json.dumps(value)


def _forms(name: str, given: Schema, optional: bool, every: Schema) -> Iterator[SectionForm]:
    """Yield the form of a section with a schema, and those of the sections that its keys hold."""
    value = _not_null(given)
    kinds = {part: kind for kind, part in value.get("discriminator", {}).get("mapping", {}).items()}
    places = [part["$ref"] for part in value.get("oneOf", [value])]
    defined = {kinds.get(part, ""): every[part.rpartition("/")[2]] for part in places}
    meanings = {kind: part["description"].splitlines()[0] for kind, part in defined.items() if kind}
    keys = {kind: tuple(_keys(name, kind, part)) for kind, part in defined.items()}
    yield SectionForm(name, given.get("description", ""), optional, meanings, keys)
    for kind, part in defined.items():
        for key in (key for key in keys[kind] if key.value == "section"):
            yield from _forms(f"{name}.{key.name}", part["properties"][key.name], key.optional, every)


def _keys(section: str, kind: str, schema: Schema) -> Iterator[KeyForm]:
    choices = {key: i for i, keys in reversed([*enumerate(schema["x-choices"])]) for key in keys}
    for name, given in schema["properties"].items():
        if kind and name == "kind":
            continue
        value = _not_null(given)
        listed = value.get("type") == "array"
        entry = value["items"] if listed else value
        single = (entry.get("anyOf") or [entry])[0]
        units, unit = tuple(single.get("x-units", ())), single.get("x-unit", "")
        bounds = [
            bound_words(each, single[name], unit) for each, (name, _) in BOUNDS.items() if name in single
        ]
        yield KeyForm(
            section,
            kind or None,
            name,
            given.get("examples", [None])[0],
            "; ".join([given.get("description", ""), *filter(None, [", ".join(bounds)])]),
            name not in schema.get("required", ()),
            None if given.get("default") == [] else given.get("default"),
            choices.get(name),
            "quantity" if units else PLAIN.get(single.get("type", ""), "section"),
            unit,
            units,
            tuple(single.get("enum", ())),
            listed,
            bool(listed and entry.get("anyOf")),
        )


def bound_words(name: str, bound: float, unit: str) -> str:
    """Return words on a bound of a value in a unit.

    Examples
    --------
    >>> bound_words("gt", 0.0, "mm"), bound_words("le", 32.0, "")
    ('greater than 0 mm', 'at most 32')
    """
    return f"{BOUNDS[name][1]} {bound:g} {unit}".rstrip()


def _not_null(schema: Schema) -> Schema:
    """Return the schema of a value, without null if it allows null."""
    values = [part for part in schema.get("anyOf", ()) if part != {"type": "null"}]
    return {**schema, **values[0], "anyOf": []} if len(values) == 1 else schema


def manual() -> str:
    """Return the text that `metafem spec` prints.

    Examples
    --------
    >>> text = manual()
    >>> print(text[text.index("[checks]") :].partition(";")[0])
    [checks]                                        # optional: further checks
    hardness = "10 MPa"                             # optional: H, which decides on a plastic law
    """
    lines = [HEAD]
    for form in section_forms().values():
        if "." in form.name:
            continue
        lines.append(_line(f"[{form.name}]", form.meaning, form.optional))
        for kind, keys in form.keys.items():
            lines += ["", _line(f'kind = "{kind}"', form.kinds[kind], False)] if kind else []
            for key in keys:
                start = f"{key.name} = {as_toml(key.example)}"
                lines.append(_line(start, key.meaning, key.optional, key.default))
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def _line(start: str, meaning: str, optional: bool, default: Any = None) -> str:
    told = "optional: " if optional and not meaning.startswith(CHOICES) else ""
    if default is not None:
        told = f"optional, default {f'{default:g}' if isinstance(default, float) else as_toml(default)}: "
    return f"{start:<{COLUMN - 1}} # {told}{meaning}"
