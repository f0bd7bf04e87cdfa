"""Error messages about specifications."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any

from metafem._given import printable
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


def worded(detail: Any, sections: type[BaseModel]) -> str:
    """Return one of pydantic's errors on one line."""
    kind, given = detail["type"], detail["input"]
    keys, last, models = _located(detail["loc"], sections)
    place = [printable(str(part), 60) for part in keys]
    name = next(part for part in reversed(place) if not part.isdigit())
    key = re.sub(r"\.(\d+)", r"[\1]", ".".join(place))
    if kind == "extra_forbidden":
        what = "section" if len(place) == 1 else "key"
        return f"{key} is an unknown {what}{suggestion(name, tuple(last.model_fields))}"
    if kind == "missing":
        return (
            f"section [{key}] is missing" if len(place) == 1 else f"{key} is missing{_example(place, name)}"
        )
    if kind == "union_tag_not_found":
        return f'{key}.kind is missing; write for example kind = "{kind_of(models[0])}"'
    if kind == "union_tag_invalid":
        tag, known = str(detail["ctx"]["tag"]), tuple(map(kind_of, models))
        return f'{key}.kind = "{printable(tag, 60)}" is unknown{suggestion(tag, known)}'
    if kind == "value_error":
        return f"{key} {detail['ctx']['error']}"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return f"{key} = {as_written(given)} must be a section: write [{key}] on a line of its own"
    must = MUST.get(kind, "cannot be used").format(**detail.get("ctx", {}))
    return f"{key} = {as_written(given)} {must}{_example(place, name)}"


# Words before the key of a problem.
LEAD = re.compile(r"section \[|limits\.offset \+ (?=limits\.max_height)")
DOTTED = re.compile(r"[\w-]+(?:\.[\w-]+)*")


def problem_key(problem: str) -> str:
    """Return the key at the start of one of the `problems` of a refused specification.

    It is the section where the specification has no such key, and empty where the file as a whole is
    refused.

    Examples
    --------
    >>> problem_key('limits.max_height = "120" needs a unit; write for example "120 um"')
    'limits.max_height'
    >>> problem_key("section [material] is missing"), problem_key("not valid TOML: ...")
    ('material', '')
    """
    lead = LEAD.match(problem)
    found = DOTTED.match(problem, lead.end() if lead else 0)
    parts = found[0].split(".") if found else [""]
    while parts and ".".join(parts) not in _known():
        parts.pop()
    return ".".join(parts)


@cache
def _known() -> frozenset[str]:
    """Return every section and dotted key of a specification."""
    from metafem.files.specification.contents import Sections

    sections = dict(Sections.model_fields)
    known = {*sections, "target.kind", "contact.kind", "contact.cap.kind"}
    known |= {f"{key.section}.{key.name}" for key in all_keys()}
    contact = {key.name for key in all_keys() if key.section == "contact"}
    return frozenset(known | {f"contact.cap.{name}" for name in contact})


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


def _example(place: list[str], name: str) -> str:
    """Return an example of a key, for the end of an error."""
    for key in all_keys():
        if (key.section, key.name) == (place[0], name):
            return f"; write for example {name} = {as_toml(key.example)}"
    return ""
