"""The JSON schema of a specification, the descriptions of its keys, and the manual."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from metafem.errors import InvalidInput
from metafem.files.atomic import write_text
from metafem.files.specification.contents import Sections

Schema = dict[str, Any]

# Name of the schema's file, to which the specifications of the demonstrations refer.
SCHEMA_FILE = "metafem.schema.json"

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

    Attributes
    ----------
    section, name : str
    kind : str or None
        The kind of section that has this key; None for a section without kinds.
    meaning : str
    example : object
        A valid value, as tomllib reads it.
    optional : bool
    default : object
        Default of an optional key; None for a key without a default.
    schema : dict
        JSON schema of the value; the usual units of a quantity are its "x-units".
    choice : int or None
        Number of the alternative set to which the key belongs; a section needs the keys of one set.
    """

    section: str
    kind: str | None
    name: str
    example: Any
    meaning: str
    optional: bool
    default: Any
    schema: Schema
    choice: int | None = None

    @property
    def needed(self) -> bool:
        """Whether the key is required, or belongs to the first alternative set of keys."""
        return not self.optional or self.choice == 0

    @property
    def listed(self) -> bool:
        """Whether the value is a list."""
        return self.schema.get("type") == "array"

    @property
    def pairs(self) -> bool:
        """Whether an entry of the list can itself be a list of two values."""
        return self.listed and "anyOf" in self._entry

    @property
    def value(self) -> str:
        """Kind of the value or of a list's entries: quantity, number, integer, truth, text or section."""
        if sections_of(self.schema):
            return "section"
        return "quantity" if self.units else PLAIN[self._single["type"]]

    @property
    def units(self) -> tuple[str, ...]:
        """Usual units of a quantity; empty for other values."""
        return tuple(self._single.get("x-units", ()))

    @property
    def names(self) -> tuple[str, ...]:
        """The allowed texts; empty if all texts are allowed."""
        return tuple(self._single.get("enum", ()))

    @property
    def _entry(self) -> Schema:
        return self.schema["items"] if self.listed else self.schema

    @property
    def _single(self) -> Schema:
        return self._entry["anyOf"][0] if "anyOf" in self._entry else self._entry


@dataclass(frozen=True)
class SectionForm:
    """The description of a section.

    Attributes
    ----------
    name : str
    meaning : str
    optional : bool
    kinds : mapping of str to str
        One sentence on each kind; empty for a section without kinds.
    keys : mapping of str to tuple of KeyForm
        Keys by kind, in the order of the manual; the kind is "" in a section without kinds.
    """

    name: str
    meaning: str
    optional: bool
    kinds: dict[str, str]
    keys: dict[str, tuple[KeyForm, ...]]


@cache
def whole_schema() -> Schema:
    """Return the JSON schema of a specification, by which editors complete keys and mark errors.

    Examples
    --------
    >>> "max_height" in whole_schema()["$defs"]["LimitsSection"]["properties"]
    True
    """
    # language servers for TOML read draft 7 of JSON Schema
    return {"$schema": "http://json-schema.org/draft-07/schema#", **Sections.model_json_schema()}


def schema_text() -> str:
    """Return the text of the schema's file."""
    return json.dumps(whole_schema(), indent=2, ensure_ascii=False) + "\n"


def write_schema(path: Path, force: bool = False) -> None:
    """Write the schema unless the file already contains it; `force` replaces another schema of metafem."""
    if not path.is_file() or path.read_bytes() != schema_text().encode("utf-8"):
        write_text(path, schema_text(), force=force)


def place_schema(folder: Path) -> str | None:
    """Write the schema next to a specification; return a remark if another file already has its name."""
    path = folder / SCHEMA_FILE
    try:
        write_schema(path)
    except InvalidInput:
        if not os.path.lexists(path):
            raise
        renew = f"`metafem spec --schema > {path}` renews it"
        return f"{path} exists and differs from the schema of this version; {renew}"
    return None


@cache
def section_forms() -> tuple[SectionForm, ...]:
    """Return the descriptions of all sections, in the order of the manual.

    If the value of a key is itself a section, such as ``contact.cap``, that section follows.

    Examples
    --------
    >>> forms = {form.name: form for form in section_forms()}
    >>> forms["limits"].keys[""][0].units[:3], forms["contact"].kinds["hertz"]
    (('nm', 'um', 'mm'), 'Elastic paraboloids with the curvature of each summit.')
    """
    whole, found = whole_schema(), list[SectionForm]()
    for name, given in whole["properties"].items():
        found += _forms(name, given, name not in whole["required"])
    return tuple(found)


def all_keys() -> tuple[KeyForm, ...]:
    """Return the descriptions of all keys, except the keys of nested sections."""
    forms = (form for form in section_forms() if "." not in form.name)
    return tuple(key for form in forms for keys in form.keys.values() for key in keys)


def sections_of(schema: Schema) -> dict[str, Schema]:
    """Return the schemas of the sections that a value can be, by kind; empty if it is not a section.

    A section without kinds has the kind "". `schema` may be that of an optional value, which allows null.
    """
    schema = not_null(schema)
    kinds = {part: kind for kind, part in schema.get("discriminator", {}).get("mapping", {}).items()}
    parts = [part["$ref"] for part in schema.get("oneOf", [schema]) if "$ref" in part]
    return {kinds.get(part, ""): whole_schema()["$defs"][part.rpartition("/")[2]] for part in parts}


def not_null(schema: Schema) -> Schema:
    """Return the schema of a value, from which null is removed if it is allowed."""
    null = {"type": "null"}
    if null not in schema.get("anyOf", ()):
        return schema
    (value,) = (part for part in schema["anyOf"] if part != null)
    return {**value, **{name: part for name, part in schema.items() if name != "anyOf"}}


def as_toml(value: Any) -> str:
    """Return the TOML text of an example."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {as_toml(member)}' for key, member in value.items())}}}"
    return json.dumps(value)


def _forms(name: str, schema: Schema, optional: bool) -> list[SectionForm]:
    sections = sections_of(schema)
    keys = {kind: tuple(_keys(name, kind, section)) for kind, section in sections.items()}
    kinds = {kind: section["description"].splitlines()[0] for kind, section in sections.items() if kind}
    found = [SectionForm(name, schema.get("description", ""), optional, kinds, keys)]
    for key in (key for of_kind in keys.values() for key in of_kind if key.value == "section"):
        found += _forms(f"{name}.{key.name}", {**key.schema, "description": key.meaning}, key.optional)
    return found


def _keys(section: str, kind: str, schema: Schema) -> list[KeyForm]:
    choices = {name: i for i, names in enumerate(schema["x-choices"]) for name in names}
    found = []
    for name, given in schema["properties"].items():
        if kind and name == "kind":
            continue
        optional, default = name not in schema.get("required", ()), given.get("default")
        example = given.get("examples", [None])[0]
        about = {"description", "examples", "default", "title"}
        value = {word: part for word, part in not_null(given).items() if word not in about}
        words = given.get("description", "")
        default = None if default == [] else default
        form = (section, kind or None, name, example, words, optional, default)
        found.append(KeyForm(*form, value, choices.get(name)))
    return found


def manual() -> str:
    """Return the text that `metafem spec` prints.

    Examples
    --------
    >>> text = manual()
    >>> print(text[text.index("[checks]") :], end="")
    [checks]                                        # optional: further checks
    hardness = "10 MPa"                             # optional: H, which decides on a plastic law
    """
    lines = [HEAD]
    for form in section_forms():
        if "." in form.name:
            continue
        lines.append(_line(f"[{form.name}]", form.meaning, form.optional, None))
        for kind, keys in form.keys.items():
            if kind:
                lines += ["", _line(f'kind = "{kind}"', form.kinds[kind], False, None)]
            lines += [
                _line(f"{key.name} = {as_toml(key.example)}", key.meaning, key.optional, key.default)
                for key in keys
            ]
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def remark(meaning: str, optional: bool, default: Any) -> str:
    """Return the meaning of a key or section, preceded by "optional" and the default where these apply."""
    told = "optional: " if optional and not meaning.startswith(CHOICES) else ""
    if default is not None:
        told = f"optional, default {f'{default:g}' if isinstance(default, float) else as_toml(default)}: "
    return f"{told}{meaning}"


def _line(start: str, meaning: str, optional: bool, default: Any) -> str:
    return f"{start:<{COLUMN - 1}} # {remark(meaning, optional, default)}"
