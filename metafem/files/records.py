"""Conversion of the package's frozen values to plain dicts for JSON, and back without loss."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from importlib import import_module
from typing import Any, get_type_hints

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError, create_model

from metafem import caps, contact, inversion, models, notes, prediction, substrate, surface
from metafem._given import printable, shown
from metafem.contact import TabulatedContact
from metafem.errors import InvalidInput, refuse_if
from metafem.inversion import density, problem, wording
from metafem.models.curve import ModelError

# Modules whose dataclasses and enums may occur in a record.
MODULES = (
    *(surface, caps, contact, substrate, models, prediction, notes),
    *(inversion, problem, density, wording),
)
TYPES: Mapping[str, type] = {
    name: kind
    for module in MODULES
    for name, kind in vars(module).items()
    if isinstance(kind, type) and (is_dataclass(kind) or issubclass(kind, Enum))
} | {"ModelError": ModelError}
# Functions that build a value from its fields if its constructor takes other arguments, here the rows of a
# table.
MAKERS: Mapping[str, Callable[..., Any]] = {
    "TabulatedContact": lambda table, material: TabulatedContact(*table, material=material),
    "ModelError": lambda value, **rest: ModelError(math.nan if value is None else value, **rest),
}
# Types whose modules are imported only when a record contains the type.
LATE: Mapping[str, str] = {"Block3D": "metafem.fe"}
ARRAYS = ("float64", "int64")
# A number must be finite and of the annotated type; any other member must be an instance of its class.
STRICT = ConfigDict(
    strict=True, extra="forbid", allow_inf_nan=False, arbitrary_types_allowed=True, protected_namespaces=()
)


def to_record(value: Any) -> Any:
    """Return the record of a value, which contains only dicts, lists, numbers and texts.

    A dataclass becomes ``{"type": its name, field: ...}``, an array ``{"float64": [...]}`` or
    ``{"int64": [...]}``, an enum ``{"type": ..., "name": ..., "message": ...}``, and a tuple becomes a list.
    """
    title = type(value).__name__
    if isinstance(value, Enum) and title in TYPES:
        return {"type": title, "name": value.name, "message": value.value}
    if is_dataclass(value) and title in {*TYPES, *LATE}:
        members = {field.name: to_record(getattr(value, field.name)) for field in fields(value)}
        return {"type": title, **members}
    if isinstance(value, ModelError):
        number = None if math.isnan(value) else float(value)
        return {"type": title, "value": number, **{name: to_record(v) for name, v in vars(value).items()}}
    if isinstance(value, np.ndarray) and value.dtype.name in ARRAYS:
        return {value.dtype.name: value.tolist()}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {str(name): to_record(member) for name, member in value.items()}
    if isinstance(value, (tuple, list)):
        return [to_record(member) for member in value]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    remedy = "; give a function as a table" if callable(value) else ""
    raise InvalidInput(f"{value!r:.80} cannot be written to a record{remedy}")


def from_record(record: Any, name: str = "record") -> Any:
    """Return the value of a record; raise InvalidInput for a record that `to_record` did not write.

    The annotations and the constructor of a class check its members. Errors call the record `name` and its
    members ``name.member``.
    """
    if isinstance(record, list):
        return tuple(from_record(member, f"{name}[{i}]") for i, member in enumerate(record))
    if not isinstance(record, dict):
        return record
    if len(record) == 1 and next(iter(record)) in ARRAYS:
        return _array(*next(iter(record.items())), name)
    title = record.get("type")
    if title is None:
        return {
            int(key) if key.isdecimal() else key: from_record(member, f"{name}.{printable(key, 40)}")
            for key, member in record.items()
        }
    unknown = not isinstance(title, str) or title not in {*TYPES, *LATE}
    refuse_if(unknown, f"{name}: {shown(title)} is not a type of this version")
    kind: Any = TYPES[title] if title in TYPES else getattr(import_module(LATE[title]), title)
    if not issubclass(kind, Enum):
        return _made(kind, record, name)
    found = {member.name: member for member in kind}.get(str(record.get("name")))
    refuse_if(found is None, f"{name}: {shown(record.get('name'))} is not a {title}")
    return found


def _made(kind: Any, record: dict[str, Any], name: str) -> Any:
    """Return the instance of a class that a record describes; the class checks the members."""
    members = {key: from_record(value, f"{name}.{key}") for key, value in record.items() if key != "type"}
    try:
        _members(kind).model_validate(members)
        return MAKERS.get(kind.__name__, kind)(**members)
    except ValidationError as error:
        place, words = str(error.errors()[0]["loc"][0]), error.errors()[0]["msg"]
        given = f"{name}.{printable(place)} = {shown(record.get(place))}"
        raise InvalidInput(f"{given} of a {kind.__name__}: {words}") from None
    except InvalidInput as error:
        raise InvalidInput(f"{name}: {error}") from None


@cache
def _members(kind: Any) -> type[BaseModel]:
    """Return the model that checks the types of the members of a class."""
    hints = get_type_hints(kind)
    if kind is ModelError:
        hints = {"value": float | None, **hints}
    names = [field.name for field in fields(kind)] if is_dataclass(kind) else hints
    types: dict[str, Any] = {name: (hints[name], ...) for name in names}
    return create_model(kind.__name__, __config__=STRICT, **types)


def _array(dtype: str, values: Any, name: str) -> Any:
    try:
        array = np.asarray(values or np.zeros(0, dtype)).astype(dtype, casting="safe")
    except (TypeError, ValueError):  # texts, fractions in place of integers, lists of different lengths
        raise InvalidInput(f"{name} = {shown(values)} is not an array of {dtype}") from None
    refuse_if(not np.isfinite(array).all(), f"{name} must be finite numbers")
    array.flags.writeable = False
    return array
