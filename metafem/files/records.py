"""The package's frozen values as plain dicts, for JSON, and back to the bit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from importlib import import_module
from typing import Any

import numpy as np

from metafem.asperity import Hertz
from metafem.distributions import TruncatedExponential, TwoBranchExponential
from metafem.errors import InvalidInput
from metafem.inversion import (
    BilinearLaw,
    Design,
    DesignStatus,
    Layout,
    Limits,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    RadiusRange,
    SampledLaw,
)
from metafem.inversion.blueprint import Branch
from metafem.law import BranchFit, FrictionLaw
from metafem.models import Automatic, BoundaryElements, Independent, Interacting, MeanField, Status
from metafem.notes import Level, Note
from metafem.substrate import BondedLayer, HalfSpace
from metafem.surface import Block, Friction, Material, Surface

# What may stand in a record. A new model, target or density is added here.
VALUES: Mapping[str, type] = {
    kind.__name__: kind
    for kind in (
        *(Material, Friction, Block, Surface, Hertz, HalfSpace, BondedLayer),
        *(Independent, MeanField, Interacting, BoundaryElements, Automatic),
        *(OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw, MultilinearLaw),
        *(Limits, Layout, RadiusRange, Design, FrictionLaw),
        *(Note, Branch, BranchFit, TruncatedExponential, TwoBranchExponential),
    )
}
# Those whose modules are read when a record holds one.
LATE: Mapping[str, str] = {"Block3D": "metafem.fe"}
ENUMS: Mapping[str, type[Enum]] = {kind.__name__: kind for kind in (Status, DesignStatus, Level)}
ARRAYS = ("float64", "int64")
# Before notes had levels they were texts; those that began like this warned of nothing.
INFORMATION = (
    "heights stand on steps",
    "heights were moved",
    "the places of the heights were chosen",
    "the places were left as dealt",
    "chosen: ",
    "the surface's block is left aside",
    "up to ",
    "proportional within",
    "no levels lead through the points",
    "radii that cannot reach the target",
)


def to_record(value: Any) -> Any:
    """Return a value as dicts, lists, numbers and texts.

    A dataclass becomes ``{"type": its name, field: ...}``, an array ``{"float64": [...]}`` or
    ``{"int64": [...]}``, an enum ``{"type": ..., "name": ..., "message": ...}``, a tuple a list.

    Examples
    --------
    >>> to_record(LinearLaw(6.87))
    {'type': 'LinearLaw', 'slope': 6.87, 'through_origin': False}
    """
    if isinstance(value, Enum) and type(value).__name__ in ENUMS:
        return {"type": type(value).__name__, "name": value.name, "message": value.value}
    if is_dataclass(value) and type(value).__name__ in {*VALUES, *LATE}:
        members = {field.name: to_record(getattr(value, field.name)) for field in fields(value)}
        return {"type": type(value).__name__, **members}
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
    raise InvalidInput(f"{value!r:.80} cannot be written to a record; known are {', '.join(VALUES)}")


def from_record(record: Any) -> Any:
    """Return the value of a record; raises InvalidInput for one that `to_record` did not write.

    Examples
    --------
    >>> from_record({"type": "LinearLaw", "slope": 6.87})
    LinearLaw(slope=6.87, through_origin=False)
    """
    if isinstance(record, list):
        return tuple(from_record(member) for member in record)
    if not isinstance(record, dict):
        return record
    name = record.get("type")
    if name is None:
        return _array(record) if len(record) == 1 and next(iter(record)) in ARRAYS else _mapping(record)
    if not isinstance(name, str) or name not in {*ENUMS, *VALUES, *LATE}:
        raise InvalidInput(f"{name!r:.60} is not a type of this version; known are {', '.join(VALUES)}")
    if name in ENUMS:
        try:
            return ENUMS[name][record["name"]]
        except KeyError:
            raise InvalidInput(f"{record.get('name')!r:.60} is not a {name}") from None
    members = {key: from_record(member) for key, member in record.items() if key != "type"}
    if isinstance(members.get("notes"), tuple):
        members["notes"] = tuple(map(_note, members["notes"]))
    kind = VALUES[name] if name in VALUES else getattr(import_module(LATE[name]), name)
    known = {field.name: field.default is MISSING for field in fields(kind)}
    needed = {member for member, required in known.items() if required}
    if not needed <= members.keys() <= known.keys():
        differing = ", ".join(sorted((members.keys() - known.keys()) | (needed - members.keys())))
        raise InvalidInput(f"a record of {name} has missing or unknown members: {differing}")
    return kind(**members)


def _note(value: Any) -> Note:
    """Return a note of a record, or of the text that stood in its place before notes had levels."""
    if isinstance(value, Note) and isinstance(value.text, str) and isinstance(value.level, Level):
        return value
    if isinstance(value, str):
        return Note(value, Level.INFORMATION if value.startswith(INFORMATION) else Level.WARNING)
    raise InvalidInput(f"{value!r:.60} is not a note")


def _array(record: dict[str, Any]) -> Any:
    ((dtype, values),) = record.items()
    try:
        array = np.array(values, dtype=dtype)
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(f"{values!r:.60} is not an array of {dtype}") from None
    array.flags.writeable = False
    return array


def _mapping(record: dict[str, Any]) -> dict[str, Any]:
    return {key: from_record(member) for key, member in record.items()}
