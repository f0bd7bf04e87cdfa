"""Problems of a specification, from the errors of pydantic."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.specification.manual import all_keys, as_toml, kind_of, models_of
from metafem.files.specification.models import suggestion
from metafem.files.units import as_written

if TYPE_CHECKING:
    from pydantic import BaseModel

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


def problem(detail: Any, sections: type[BaseModel]) -> InvalidInput:
    """Return one of pydantic's errors, with its key."""
    kind, given = detail["type"], detail["input"]
    keys, last, models = _located(detail["loc"], sections)
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{printable(part, 60)}" for part in keys)[1:]
    name = next((part for part in reversed(keys) if isinstance(part, str)), "")
    if kind == "value_error":
        reason: InvalidInput = detail["ctx"]["error"]
        return reason.at(key)
    if kind == "extra_forbidden":
        what = "section" if len(keys) == 1 else "key"
        return InvalidInput(f"is an unknown {what}{suggestion(name, tuple(last.model_fields))}", key=key)
    if kind == "missing" and len(keys) == 1:
        return InvalidInput(f"is missing; write a section [{key}]", key=key)
    if kind == "missing":
        return InvalidInput("is missing", key=key, example=_example(keys[0], name))
    if kind == "union_tag_not_found":
        return InvalidInput("is missing", key=f"{key}.kind", example=f'kind = "{kind_of(models[0])}"')
    if kind == "union_tag_invalid":
        tag, known = printable(str(detail["ctx"]["tag"]), 60), tuple(map(kind_of, models))
        return InvalidInput(f"is unknown{suggestion(tag, known)}", key=f"{key}.kind", value=f'"{tag}"')
    must, example = MUST.get(kind, "cannot be used"), _example(keys[0], name)
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        must, example = f"must be a section: write [{key}] on a line of its own", ""
    must = must.format(**detail.get("ctx", {}))
    return InvalidInput(must, key=key, value=as_written(given), example=example)


def _located(
    place: tuple[Any, ...], sections: type[BaseModel]
) -> tuple[list[Any], type[BaseModel], tuple[type[BaseModel], ...]]:
    """Return the keys of a location, the section in which the last one stands, and the sections behind it.

    pydantic includes the kind of a section in the location.
    """
    keys: list[Any] = []
    last = sections
    models: tuple[type[BaseModel], ...] = (sections,)
    for part in place:
        of_kind = [model for model in models if keys and kind_of(model) == part]
        if of_kind:
            models = (of_kind[0],)
            continue
        keys.append(part)
        if len(models) == 1:
            last = models[0]
        field = last.model_fields.get(part)
        models = () if field is None else models_of(field.annotation)
    return keys, last, models


def _example(section: str, name: str) -> str:
    """Return a line with an example of a key, for the end of an error; "" for an unknown key."""
    for key in all_keys():
        if (key.section, key.name) == (section, name):
            return f"{name} = {as_toml(key.example)}"
    return ""
