"""Translation of pydantic's errors into problems of a specification."""

from __future__ import annotations

from typing import Any

from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.specification.forms import as_toml, section_forms
from metafem.files.specification.models import suggestion
from metafem.files.units import as_written

# What a value must be, by pydantic's name of the error; the violated bound is inserted at the braces.
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
    """Return the problem that an error of pydantic describes, with its key, value and an example."""
    kind, given = detail["type"], detail["input"]
    keys, known, kinds = _located(detail["loc"])
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{printable(part, 60)}" for part in keys)[1:]
    *_, name = (part for part in keys if isinstance(part, str))
    if kind == "value_error":
        reason: InvalidInput = detail["ctx"]["error"]
        own = known.get(name)
        if reason.example and own and isinstance(own.example, str):
            reason.example = as_toml(own.example)
        return reason.at(key)
    if kind == "extra_forbidden":
        what = "section" if len(keys) == 1 else "key"
        return InvalidInput(f"is an unknown {what}{suggestion(name, known)}", key=key)
    if kind == "missing" and len(keys) == 1:
        return InvalidInput(f"is missing; write a section [{key}]", key=key)
    example = f"{name} = {as_toml(known[name].example)}" if known.get(name) else ""
    if kind == "missing":
        return InvalidInput("is missing", key=key, example=example)
    if kind == "union_tag_not_found":
        return InvalidInput("is missing", key=f"{key}.kind", example=f'kind = "{next(iter(kinds))}"')
    if kind == "union_tag_invalid":
        tag = printable(str(detail["ctx"]["tag"]), 60)
        return InvalidInput(f"is unknown{suggestion(tag, kinds)}", key=f"{key}.kind", value=f'"{tag}"')
    must = MUST.get(kind, "cannot be used")
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        must, example = f"must be a section: write [{key}] on a line of its own", ""
    # a float may be a quantity that was already converted
    value = given if isinstance(given, float) else as_written(given)
    return InvalidInput(must.format(**detail.get("ctx", {})), key=key, value=value, example=example)


def _located(place: tuple[Any, ...]) -> tuple[list[Any], dict[str, Any], dict[str, str]]:
    """Return the keys in pydantic's location of an error, the known keys of that section, and its kinds.

    pydantic's location also contains the kind of the section, which is not among the returned keys.
    """
    forms = {form.name: form for form in section_forms()}
    keys: list[Any] = []
    known: dict[str, Any] = {name: None for name in forms if "." not in name}
    kinds: dict[str, str] = {}
    for part in place:
        section = ".".join(map(str, keys))
        kind = part if part in kinds else ""
        if section in forms and kind in forms[section].keys:
            known = {key.name: key for key in forms[section].keys[kind]}
            known = {"kind": None, **known} if kind else known
        kinds = {}
        if not kind:
            keys.append(part)
            form = forms.get(".".join(map(str, keys)))
            kinds = form.kinds if form else {}
    return keys, known, kinds
