"""Tables of measured or wanted laws, as the keys of a sampled target."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration import MeasuredLaw
from metafem.errors import InvalidInput
from metafem.files.columns import TARGET, columns_of
from metafem.files.csv_rows import Table, table_of
from metafem.files.measurement.contacts import contacts_of
from metafem.files.measurement.laws import CONTACTS
from metafem.files.units import converted
from metafem.surface import Material

# Keys of a sampled target in the order in which a table is preferred to state them.
LOADS, FRICTIONS = ("rescaled_load", "load"), ("rescaled_friction", "friction_force", "area")

Entries = dict[str, list[Any]]


def samples_of(name: str, content: bytes) -> Entries:
    """Return the keys of a sampled target from a table, also of `metafem images` or with error bars.

    The loads may be in any order, and samples of equal loads are averaged. Standard deviations of the loads
    and of the frictions become relative errors of the frictions; only those that the table states.
    """
    table = table_of(name, content, TARGET.example)
    entries = _of_images(table) if set(table.header) >= CONTACTS else columns_of(name, content, TARGET)
    values = {key: _numbers(key, column) for key, column in entries.items()}
    load = next(key for key in LOADS if key in values)
    friction = next(key for key in FRICTIONS if key in values)
    error = _relative_error(table.name, values, load, friction)
    if error is not None:
        values["relative_error"] = error
        entries["relative_error"] = error.tolist()
    entries = {key: entries[key] for key in (load, friction, *TARGET.plain) if key in entries}
    if (np.diff(values[load]) <= 0.0).any():
        entries = _averaged({key: values[key] for key in entries}, load)
    return {"rescaled_friction" if key == "area" else key: column for key, column in entries.items()}


def _numbers(key: str, column: list[Any]) -> FloatArray:
    """Return a column in the package's unit."""
    if key in TARGET.plain:
        return np.array(column)
    return np.array([converted(text, TARGET.units[key]) for text in column])


def _relative_error(
    name: str, values: Mapping[str, FloatArray], load: str, friction: str
) -> FloatArray | None:
    """Return the relative errors of the frictions, with those of the loads by the exponent of the law."""
    stated = [key for key in (f"{load}_sd", f"{friction}_sd") if key in values]
    if not stated:
        return values.get("relative_error")
    if "relative_error" in values:
        raise InvalidInput(f"relative_error and {stated[0]} both give the errors; keep one")
    x, y = values[load], values[friction]
    exponent = float(np.polyfit(np.log(x), np.log(y), 1)[0]) if len(np.unique(x)) > 1 else 1.0
    zero = np.zeros(len(x))
    by_load = exponent * values.get(f"{load}_sd", zero) / x
    error = np.hypot(by_load, values.get(f"{friction}_sd", zero) / y)
    if error.max() >= 1.0:
        i = int(error.argmax()) + 1
        raise InvalidInput(
            f"{name}: the error of sample {i} is as large as its friction; leave the sample out"
        )
    return error


def _averaged(values: Mapping[str, FloatArray], load: str) -> Entries:
    """Return samples in the order of their loads, one for each, of columns (k,)."""
    loads, group, counts = np.unique(values[load], return_inverse=True, return_counts=True)
    found: Entries = {}
    for key, column in values.items():
        if key == load:
            mean = loads  # themselves, not their rounded means
        elif key == "weight":
            mean = np.bincount(group, column).astype(np.float64)
        elif key == "relative_error":  # errors of repeated samples are independent
            mean = np.sqrt(np.bincount(group, column**2)) / counts
        else:
            mean = np.bincount(group, column) / counts
        unit = "" if key in TARGET.plain else TARGET.units[key]
        found[key] = [f"{value!r} {unit}" if unit else value for value in mean.tolist()]
    if len(loads) < len(group) and values.keys().isdisjoint(TARGET.plain):
        found["weight"] = counts.astype(np.float64).tolist()
    return found


def _of_images(table: Table) -> Entries:
    """Return the loads and areas of a table of the contacts in images."""
    try:
        # only rescaled values depend on the material
        law = MeasuredLaw.from_contacts(contacts_of(table), Material(1.0)).known()
    except InvalidInput as error:
        raise InvalidInput(f"{table.name}: {error}") from None
    assert law.area is not None
    assert law.area_sd is not None
    kept = (law.load > 0.0) & (law.area > 0.0)
    columns = {"load": law.load, "area": law.area, "area_sd": law.area_sd}
    return {
        key: [f"{value!r} {TARGET.units[key]}" for value in column[kept].tolist()]
        for key, column in columns.items()
    }
