"""All sections of a specification; what they can hold, for errors, the page, the manual and editors."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from itertools import pairwise
from typing import Any

import metafem as mf
from metafem.errors import InvalidInput, printable
from metafem.files.specification import sections, suggestion
from metafem.files.specification.sections import BOUNDS, Section, key, optional
from metafem.files.specification.targets import AnyTarget
from metafem.files.units import as_written

# A JSON schema, and the description of a section or of a key by the names in `section_forms`.
Schema = dict[str, Any]
Form = dict[str, Any]

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
"""

# The kind of a value without a unit, by its type in a JSON schema.
PLAIN = {"number": "number", "integer": "integer", "boolean": "truth", "string": "text"}


class Sections(Section):
    """All sections of a specification."""

    target: AnyTarget = key("the target friction law, of one of these kinds")
    material: sections.MaterialSection = key("the elastomer")
    friction: sections.FrictionSection | None = optional("needed for friction forces in N")
    lattice: sections.LatticeSection = key("sites of asperities")
    sites: sections.SitesSection = key("empty sites, and sites with given heights", default={})
    tools: sections.ToolsSection | None = optional("to choose from, instead of lattice.radius")
    block: sections.BlockSection | None = optional("needed for the part files and the models layer and block")
    cell: sections.CellSection | None = optional("period of an infinite surface; default: no repetition")
    limits: sections.LimitsSection = key("manufacturing limits")
    layout: sections.LayoutSection = key("assignment of heights to sites", default=sections.LayoutSection())
    model: sections.ModelSection = key("model of the law", default=sections.ModelSection())
    cap: sections.AnyCap | None = optional("shape of the caps; default: spheres")
    contact: sections.AnyContact = key("law of one contact; default: hertz", default=mf.Hertz())
    part: sections.PartSection = key("options of the part files", default=sections.PartSection())
    checks: sections.ChecksSection = key("further checks", default=sections.ChecksSection())


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


@cache
def section_forms() -> dict[str, Form]:
    """Return the descriptions of all sections by name, in the order of the manual.

    A section has its ``name``, its ``meaning``, whether it is ``optional``, a sentence on each of its
    ``kinds``, and by kind, or by "" without kinds, the descriptions of its ``keys``. A section that is the
    value of a key, such as ``contact.cap``, follows that of the key.

    A key has its ``section``, its ``kind`` of the section or None, its ``name``, an ``example``, its
    ``meaning`` with the bounds in ``unit``, its ``default``, and whether it is ``optional``, and ``needed``
    in a new section. ``choice`` is the number of the alternative set to which it belongs, or None. ``value``
    is quantity, number, integer, truth, text or section, of the value or of the entries of a ``listed`` one,
    which with ``pairs`` can be lists of two; ``units`` are the usual ones, ``names`` the allowed texts.

    Examples
    --------
    >>> known = section_forms()
    >>> known["limits"]["keys"][""][0]["units"][:3], known["contact"]["kinds"]["hertz"][:42]
    (['nm', 'um', 'mm'], 'Frictionless, non-adhesive elastic contact')
    """
    whole = whole_schema()
    every = (
        form
        for name, given in whole["properties"].items()
        for form in _forms(name, given, name not in whole["required"], whole["$defs"])
    )
    return {form["name"]: form for form in every}


def as_toml(value: Any) -> str:
    """Return the TOML text of an example."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {as_toml(member)}' for key, member in value.items())}}}"
    return json.dumps(value)


def _forms(name: str, given: Schema, optional: bool, every: Schema) -> Iterator[Form]:
    """Yield the description of a section with a schema, and those of the sections that its keys hold."""
    value = _not_null(given)
    parts = [every[part["$ref"].rpartition("/")[2]] for part in value.get("oneOf", [value])]
    defined = {part["properties"].get("kind", {}).get("const", ""): part for part in parts}
    form: Form = {
        "name": name,
        "meaning": given["description"],
        "optional": optional,
        "kinds": {kind: part["description"].splitlines()[0] for kind, part in defined.items() if kind},
        "keys": {kind: list(_keys(name, kind, part)) for kind, part in defined.items()},
    }
    yield form
    for kind, part in defined.items():
        for own in form["keys"][kind]:
            if own["value"] == "section":
                inner = f"{name}.{own['name']}"
                yield from _forms(inner, part["properties"][own["name"]], own["optional"], every)


def _keys(section: str, kind: str, schema: Schema) -> Iterator[Form]:
    choices = {key: i for i, keys in reversed([*enumerate(schema["x-choices"])]) for key in keys}
    for name, given in schema["properties"].items():
        if kind and name == "kind":
            continue
        value = _not_null(given)
        listed = value.get("type") == "array"
        entry = value["items"] if listed else value
        single = (entry.get("anyOf") or [entry])[0]
        unit, units = single.get("x-unit", ""), single.get("x-units", [])
        bounds = [
            bound_words(each, single[word], unit) for each, (word, _) in BOUNDS.items() if word in single
        ]
        optional, choice = name not in schema.get("required", ()), choices.get(name)
        yield {
            "section": section,
            "kind": kind or None,
            "name": name,
            "example": given.get("examples", [None])[0],
            "meaning": "; ".join([given["description"], *filter(None, [", ".join(bounds)])]),
            "optional": optional,
            "needed": not optional or choice == 0,
            "default": None if given.get("default") == [] else given.get("default"),
            "choice": choice,
            "value": "quantity" if units else PLAIN.get(single.get("type", ""), "section"),
            "unit": unit,
            "units": units,
            "names": single.get("enum", []),
            "listed": listed,
            "pairs": bool(listed and entry.get("anyOf")),
        }


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
    for form in (form for name, form in section_forms().items() if "." not in name):
        lines.append(_line(f"[{form['name']}]", form))
        for kind, keys in form["keys"].items():
            lines += ["", _line(f'kind = "{kind}"', {"meaning": form["kinds"][kind]})] if kind else []
            lines += [_line(f"{key['name']} = {as_toml(key['example'])}", key) for key in keys]
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def _line(start: str, form: Form) -> str:
    meaning, default = form["meaning"], form.get("default")
    told = "optional: " if form.get("optional") and not meaning.startswith(CHOICES) else ""
    if default is not None:
        told = f"optional, default {f'{default:g}' if isinstance(default, float) else as_toml(default)}: "
    return f"{start:<{COLUMN - 1}} # {told}{meaning}"


def problem(detail: Any, table: Mapping[str, Any]) -> InvalidInput:
    """Return the problem that an error of pydantic describes, with its key, value and an example."""
    kinds = {kind for form in section_forms().values() for kind in form["kinds"]}
    places = pairwise(("", *detail["loc"]))  # in which pydantic has the kind after the name of a section
    keys = [part for before, part in places if part not in kinds or before in kinds]
    path = "".join(f"[{each}]" if isinstance(each, int) else f".{each}" for each in keys).lstrip(".")
    outer = ".".join(each for each in keys[:-1] if isinstance(each, str))
    form = section_forms().get(outer, {"keys": {}, "kinds": {}})
    kind = [part for part in ("", *detail["loc"]) if part in form["keys"]][-1:]
    known = {key["name"]: key for each in kind for key in form["keys"][each]}
    own = known.get(keys[-1], {})
    example = f"{keys[-1]} = {as_toml(own['example'])}" if own else ""
    match detail["type"]:
        case "value_error":
            error: InvalidInput = detail["ctx"]["error"]
            if error.key:
                return as_given(error.within(path), table)
            if error.example and isinstance(own.get("example"), str):
                error.example = as_toml(own["example"])
            return error.at(path)
        case "missing":
            words = "is missing" if own else f"is missing; write a section [{path}]"
            return InvalidInput(words, key=path, example=example)
        case "extra_forbidden":
            names = [*known, *["kind"] * bool(form["kinds"])] if outer else [*Sections.model_fields]
            words = f"is an unknown {'key' if outer else 'section'}{suggestion(str(keys[-1]), names)}"
            return InvalidInput(words, key=printable(path))
        case "literal_error" | "union_tag_not_found" | "union_tag_invalid":
            given, names = detail["input"], own.get("names")
            if not names:
                path, given, names = f"{path}.kind", given.get("kind"), [*section_forms()[path]["kinds"]]
            example = f'kind = "{names[0]}"' if given is None else ""
            must = f"is unknown{suggestion(str(given), names)}" if example == "" else "is missing"
        case "model_type" | "model_attributes_type" | "dict_type":
            example, must = "", f"must be a section: write [{path}] on a line of its own"
        case _:
            bounded = BOUNDS.keys() & detail.get("ctx", {}).keys()
            must = re.sub(r"^\w+ should", "must", detail["msg"]) + f" {own.get('unit', '')}" * bool(bounded)
    return as_given(InvalidInput(must.rstrip(), key=path, value="", example=example), table)


def as_given(error: InvalidInput, table: Mapping[str, Any]) -> InvalidInput:
    """Return a problem with the value as the specification states it, if it does."""
    value: Any = table
    with suppress(LookupError, TypeError):
        for part in re.findall(r"[^.\[\]]+", error.key):
            value = value[int(part) if part.isdecimal() else part]
        error.value = None if error.value is None else as_written(value)
    error.value = None if error.value == "" else error.value
    return error
