"""Error messages about specifications."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, get_args

from metafem._given import printable
from metafem.files.specification.manual import all_keys, as_toml
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
    place, kind, given = [printable(str(part), 60) for part in detail["loc"]], detail["type"], detail["input"]
    if place[0] == "target" and len(place) > 1 and kind != "union_tag_not_found":
        del place[1]  # the kind of target, which pydantic includes in the location
    name = next(part for part in reversed(place) if not part.isdigit())
    key = re.sub(r"\.(\d+)", r"[\1]", ".".join(place))
    if kind == "extra_forbidden":
        what = "section" if len(place) == 1 else "key"
        return f"{key} is an unknown {what}{suggestion(name, tuple(_known(detail['loc'], sections)))}"
    if kind == "missing":
        return (
            f"section [{key}] is missing" if len(place) == 1 else f"{key} is missing{_example(place, name)}"
        )
    if kind == "union_tag_not_found":
        return 'target.kind is missing; write for example kind = "linear"'
    if kind == "union_tag_invalid":
        tag = str(detail["ctx"]["tag"])
        return f'target.kind = "{printable(tag, 60)}" is unknown{suggestion(tag, tuple(_kinds(sections)))}'
    if kind == "value_error":
        return f"{key} {detail['ctx']['error']}"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return f"{key} = {as_written(given)} must be a section: write [{key}] on a line of its own"
    must = MUST.get(kind, "cannot be used").format(**detail.get("ctx", {}))
    return f"{key} = {as_written(given)} {must}{_example(place, name)}"


def _example(place: list[str], name: str) -> str:
    """Return an example of a key, for the end of an error."""
    for key in all_keys():
        if (key.section, key.name) == (place[0], name):
            return f"; write for example {name} = {as_toml(key.example)}"
    return ""


def _known(place: tuple[Any, ...], sections: type[BaseModel]) -> Iterator[str]:
    """Yield the known names at the location of an unknown one."""
    if len(place) == 1:
        yield from sections.model_fields
        return
    annotation = sections.model_fields[place[0]].annotation
    for kind in get_args(annotation) or (annotation,):
        fields = getattr(kind, "model_fields", {})
        if place[0] != "target" or place[1] in get_args(fields["kind"].annotation):
            yield from fields


def _kinds(sections: type[BaseModel]) -> Iterator[str]:
    for kind in get_args(sections.model_fields["target"].annotation):
        yield from get_args(kind.model_fields["kind"].annotation)
