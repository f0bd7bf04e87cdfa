"""Tables that a specification names: target laws, measured contact laws and profiles of caps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration import measured_law
from metafem.errors import InvalidInput, refuse_if
from metafem.files.measurement.contacts import contacts_of, is_of_contacts
from metafem.files.tables import Columns, Entries, Table, table_of
from metafem.surface import Material


@dataclass(frozen=True)
class SampleColumns(Columns):
    """The columns of a table of samples; each column is also a key of a specification.

    `what` describes the content of the table. The entries of the columns `rising` must increase. The first
    entries must be 0 if `from_zero` is True, must be above 0 if it is False, and may be 0 if it is None. All
    other entries must be above 0.
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

# Columns of the table that a section of a specification names, by the kind of the section.
COLUMNS = {"sampled": TARGET, "profile": PROFILE, "tabulated": MEASURED}

# Keys of a sampled target; if a table has several of them, the first one is read.
LOADS, FRICTIONS = ("rescaled_load", "load"), ("rescaled_friction", "friction_force", "area")

# The columns of a table, in the package's units, by the key of the specification.
Keys = dict[str, FloatArray]


def columns_of(name: str, content: bytes, columns: SampleColumns) -> Keys:
    """Return the columns of a table, (k,) each, by the key of the specification."""
    entries = columns.of(table_of(name, content, columns.example))
    return {key: _key(entries, key, columns) for key in entries.columns}


def _key(entries: Entries, name: str, columns: SampleColumns) -> FloatArray:
    """Return a column, (k,).

    The entries are checked here, where their lines are known, and again as part of the specification.
    """
    values = entries.numbers(name)
    if name in columns.plain:
        return values
    for row, value in enumerate(values.tolist()):
        first = row == 0
        must = f"must be 0; the first line of a {columns.what} is its origin"
        wrong = columns.from_zero and first and value != 0.0
        if not wrong:
            wrong = value < 0.0 or (value == 0.0 and not (first and columns.from_zero is not False))
            of_law = columns.from_zero is False and not name.endswith("_sd")
            must = f"must be greater than 0{'; omit the origin' if of_law else ''}"
        if not wrong and name in columns.rising and not first:
            wrong, must = value <= values[row - 1], f"must exceed the {name} of the previous line"
        if wrong:
            text = entries.table.plain(entries.texts(name)[row])
            raise InvalidInput(f"{entries.cell(row, name)} = {text} {must}")
    return values


def samples_of(name: str, content: bytes) -> Keys:
    """Return the keys of a sampled target from a table, which may be one of `metafem images`.

    The loads may be in any order, and samples at equal loads are averaged. Standard deviations of the loads
    and friction forces are combined into relative errors of the friction.
    """
    table = table_of(name, content, TARGET.example)
    values = _of_images(table) if is_of_contacts(table) else columns_of(name, content, TARGET)
    load = next(key for key in LOADS if key in values)
    friction = next(key for key in FRICTIONS if key in values)
    error = _relative_error(table.name, values, load, friction)
    if error is not None:
        values["relative_error"] = error
    values = {key: values[key] for key in (load, friction, *TARGET.plain) if key in values}
    if (np.diff(values[load]) <= 0.0).any():
        values = _averaged(values, load)
    return {"rescaled_friction" if key == "area" else key: column for key, column in values.items()}


def _relative_error(
    name: str, values: Mapping[str, FloatArray], load: str, friction: str
) -> FloatArray | None:
    """Return relative errors of the friction, (k,), or None if the table has no errors.

    The relative error of a load is multiplied by the exponent of the power law that fits the samples.
    """
    stated = [key for key in (f"{load}_sd", f"{friction}_sd") if key in values]
    if not stated:
        return values.get("relative_error")
    words = f"relative_error and {stated[0]} both give the errors; keep one"
    refuse_if("relative_error" in values, words)
    x, y = values[load], values[friction]
    exponent = float(np.polyfit(np.log(x), np.log(y), 1)[0]) if len(np.unique(x)) > 1 else 1.0
    zero = np.zeros(len(x))
    by_load = exponent * values.get(f"{load}_sd", zero) / x
    error = np.hypot(by_load, values.get(f"{friction}_sd", zero) / y)
    words = f"the error of sample {error.argmax() + 1} is as large as its friction; leave the sample out"
    refuse_if(error.max() >= 1.0, f"{name}: {words}")
    return error


def _averaged(values: Mapping[str, FloatArray], load: str) -> Keys:
    """Return the columns sorted by load, with one sample for each load."""
    loads, group, counts = np.unique(values[load], return_inverse=True, return_counts=True)
    found: Keys = {}
    for key, column in values.items():
        if key == load:
            mean = loads  # exact: a computed mean would be rounded
        elif key == "weight":
            mean = np.bincount(group, column).astype(np.float64)
        elif key == "relative_error":  # repeated samples have independent errors
            mean = np.sqrt(np.bincount(group, column**2)) / counts
        else:
            mean = np.bincount(group, column) / counts
        found[key] = mean
    if len(loads) < len(group) and values.keys().isdisjoint(TARGET.plain):
        found["weight"] = counts.astype(np.float64)
    return found


def _of_images(table: Table) -> Keys:
    """Return loads [N], areas [mm^2] and errors of the areas [mm^2], (k,), of a table of `metafem images`."""
    try:
        # loads and areas do not depend on the material, so that any material serves
        law = measured_law(contacts_of(table), Material(1.0)).known()
    except InvalidInput as error:
        raise InvalidInput(f"{table.name}: {error}") from None
    assert law.area is not None
    assert law.area_sd is not None
    kept = (law.load > 0.0) & (law.area > 0.0)
    return {"load": law.load[kept], "area": law.area[kept], "area_sd": law.area_sd[kept]}
