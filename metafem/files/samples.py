"""Tables named in a specification: target laws, measured laws, and profiles of caps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration import MeasuredLaw
from metafem.errors import InvalidInput
from metafem.files.measurement.contacts import contacts_of, is_of_contacts
from metafem.files.tables import OWN, Columns, Entries, Table, table_of
from metafem.files.units import converted
from metafem.surface import Material


@dataclass(frozen=True)
class SampleColumns(Columns):
    """The columns of a table of samples, which are also keys of a specification.

    `what` describes the content of the table, `rising` are the columns with increasing entries, and
    `from_zero` states whether the first entries are 0; None: they may be; others are above 0.
    """

    what: str = "law"
    rising: tuple[str, ...] = ()
    from_zero: bool | None = False


TARGET = SampleColumns(
    "load_N,friction_force_N,area_mm2,rescaled_load_mm2,rescaled_friction_mm2,weight,relative_error,load_sd_N,"
    "friction_force_sd_N,area_sd_mm2,rescaled_load_sd_mm2,rescaled_friction_sd_mm2",
    ("load,friction_force", "load,area", "rescaled_load,rescaled_friction"),
    "sample",
    "load_N,friction_force_N, or load_N,area_mm2, or rescaled_load_mm2,rescaled_friction_mm2 (or in other "
    "units), and optionally their errors such as friction_force_sd_mN, or weight",
)

PROFILE = SampleColumns(
    "rho_mm,f_um", ("rho,f",), "sample", what="profile", rising=("rho", "f"), from_zero=True
)

MEASURED = SampleColumns(
    "indentation_um,load_mN,area_mm2",
    ("indentation,load,area",),
    "sample",
    rising=("indentation", "load", "area"),
    from_zero=None,
)

# The columns of the tables named in a specification, by the kind of its section.
COLUMNS = {"sampled": TARGET, "profile": PROFILE, "tabulated": MEASURED}

# Keys of a sampled target, in order of preference for a table.
LOADS, FRICTIONS = ("rescaled_load", "load"), ("rescaled_friction", "friction_force", "area")

# Columns as keys of a specification: a text with its unit for each entry, or a number of a plain column.
Keys = dict[str, list[Any]]


def columns_of(name: str, content: bytes, columns: SampleColumns) -> Keys:
    """Return the columns of a table as keys of a specification."""
    entries = columns.of(table_of(name, content, columns.example))
    return {key: _key(entries, key, columns) for key in entries.columns}


def _key(entries: Entries, name: str, columns: SampleColumns) -> list[Any]:
    """Return a column; it is checked here, with the line, and read again with the specification."""
    values = entries.numbers(name)
    if name in columns.plain:
        return list(values.tolist())
    texts = [entries.table.plain(text) for text in entries.texts(name)]
    for row, (text, value) in enumerate(zip(texts, values.tolist(), strict=True)):
        key, first = f"{entries.cell(row, name)} = {text}", row == 0
        if columns.from_zero and first and value != 0.0:
            raise InvalidInput(f"{key} must be 0; the first line of a {columns.what} is its origin")
        if value < 0.0 or (value == 0.0 and not (first and columns.from_zero is not False)):
            of_law = columns.from_zero is False and not name.endswith("_sd")
            raise InvalidInput(f"{key} must be greater than 0{'; omit the origin' if of_law else ''}")
        if name in columns.rising and not first and value <= values[row - 1]:
            raise InvalidInput(f"{key} must exceed the {name} of the previous line")
    unit = entries.title(name).rpartition("_")[2]
    return [f"{text} {unit}" for text in texts]


def samples_of(name: str, content: bytes) -> Keys:
    """Return the keys of a sampled target from a table, also of `metafem images` or with error bars.

    The loads may be in any order, and samples of equal loads are averaged. Standard deviations of the loads
    and of the frictions in the table become relative errors of the frictions.
    """
    table = table_of(name, content, TARGET.example)
    entries = _of_images(table) if is_of_contacts(table) else columns_of(name, content, TARGET)
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
    return np.array([converted(text, OWN[TARGET.units[key]]) for text in column])


def _relative_error(
    name: str, values: Mapping[str, FloatArray], load: str, friction: str
) -> FloatArray | None:
    """Return the relative errors of the frictions; those of the loads enter by the exponent of the law."""
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


def _averaged(values: Mapping[str, FloatArray], load: str) -> Keys:
    """Return samples from columns (k,), sorted by load, one for each load."""
    loads, group, counts = np.unique(values[load], return_inverse=True, return_counts=True)
    found: Keys = {}
    for key, column in values.items():
        if key == load:
            mean = loads  # the values themselves, not rounded means
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


def _of_images(table: Table) -> Keys:
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
