"""Calibrations: the points in tables of tests, and the file of a result with its covariance."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Container, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.calibration import Calibration, joint_covariance
from metafem.calibration.contact_table import pressed_points, sheared_points
from metafem.calibration.statistics import UNITS, Estimate, checked_covariance
from metafem.errors import InvalidInput, printable, refuse_if
from metafem.files.disk import TABLE, file_label, read_bytes
from metafem.files.images import read_contacts
from metafem.files.tables import NONE, Columns, Table, is_of_contacts, read_table
from metafem.notes import Note, information

if TYPE_CHECKING:
    from pandas import DataFrame

COLUMNS = Columns(
    "test,load_mN,area_mm2,area_before_mm2,area_sheared_mm2,friction_force_mN",
    ("load,area", "area,area_sheared", "area_before,area_sheared", "area_sheared,friction_force"),
    "measured point",
    "load_mN,area_mm2 of a compression test, or area_before_mm2,area_sheared_mm2,friction_force_mN of a "
    "shear test (or in other units)",
)

# Measured quantities of a shear test.
SHEARED = ["area_before", "area_sheared", "friction_force"]

# First line of the file of a calibration.
FIRST = """# Calibration by metafem: sections of a specification, with 68 % intervals. [covariance] is for
# metafem study uncertainty --calibration and metafem compare --calibration."""

# Unit in which a quantity is printed, and its size in the package's unit, where this is not the package's.
PRINTED = {"adhesion_energy": ("mJ/m²", 1e-6), "radius": ("um", 1e-3)}


def read_calibration(
    paths: Iterable[str | Path], *, columns: Mapping[str, str] = NONE
) -> tuple[DataFrame | None, DataFrame | None, float | None, list[Note]]:
    """Return the pooled data of tables of calibration tests; the columns determine the kind of a table.

    Parameters
    ----------
    paths : iterable of str or Path
        CSV files whose first line names the columns as quantity_unit. A compression test has the columns
        ``load`` and ``area``, the total. A shear test has ``area_before`` (or ``area``), ``area_sheared`` and
        ``friction_force``; its entries may be empty, and it may have a column ``load``. Tables of ``metafem
        images`` are also read. A column ``test`` holds the labels of tests. Without this column, each table
        is one test.
    columns : mapping of str to str
        Titles in the files by the names that they stand for; see `read_table`.

    Returns
    -------
    compression, shear : DataFrame or None
        Points of all tables of a kind. The columns of compression tests are ``load`` [N] and ``area`` (the
        total) or, for contacts in images, ``area_1``, ``area_2`` ... [mm^2], those of shear tests
        ``area_before`` and ``area_sheared`` [mm^2] and ``friction_force`` [N], nan if not measured. Both have
        the column ``test``, the label of the test.
    boundary : float or None
        Rms error of the contacts' boundary [mm], if all tables are those of contacts in images with errors.
    notes : list of Note
        What is left out.
    """
    import pandas as pd

    notes: list[Note] = []
    points: list[tuple[DataFrame, DataFrame]] = []
    boundaries: list[float] = []
    files = [Path(path) for path in paths]
    for path in files:
        refuse_if(files.count(path) > 1, f"{file_label(path)} is given twice")
        table = read_table(path, columns, every=len(files) == 1)
        kind = _of_contacts if is_of_contacts(table) else _of_tests
        pair, boundary, left_out = kind(table, str(path.with_suffix("")))
        points.append(pair)
        boundaries.append(boundary)
        notes += left_out
        if all(map(len, pair)):
            words = "E* and B follow from the same areas before shear; the covariance of their errors is"
            notes.append(information(f"{table.name}: {words} left out"))
    tests = [[each for each in of_kind if len(each)] for of_kind in zip(*points, strict=True)]
    differ = "the tables hold the areas of different numbers of contacts; calibrate them one by one"
    refuse_if(len({tuple(each) for each in tests[0]}) > 1, differ)
    pressed, sheared = (pd.concat(of_kind, ignore_index=True) if of_kind else None for of_kind in tests)
    rms = float(np.sqrt(np.mean(np.square(boundaries))))
    return pressed, sheared, rms if rms > 0.0 else None, notes


def _of_tests(table: Table, label: str) -> tuple[tuple[DataFrame, DataFrame], float, list[Note]]:
    """Return the points of compression and of shear tests in a table, which may be empty."""
    import pandas as pd

    entries = COLUMNS.read(table)
    names, of_shear = sorted(entries.columns.keys() - {"test"}), "area_sheared" in entries.columns
    twice = {"area", "area_before"} <= {*names}
    refuse_if(twice, f"{table.name} has the columns area and area_before; keep one")
    # entries of a shear test may be empty
    read = {name: entries.numbers(name, empty=of_shear) for name in names}
    for name in names:
        entries.refuse(name, (read[name] < 0.0) & ("area" in name), "must not be negative")
    points = pd.DataFrame(read).rename(columns={"area_before": "area"})
    named = "test" in entries.columns
    points["test"] = [printable(text, 60) for text in entries.texts("test")] if named else label
    points = points.reindex(columns=["load", "area", *SHEARED[1:], "test"])
    sheared = points.rename(columns={"area": "area_before"})[[*SHEARED, "test"]]
    return (points[["load", "area", "test"]].dropna(), sheared if of_shear else sheared[:0]), np.nan, []


def _of_contacts(table: Table, label: str) -> tuple[tuple[DataFrame, DataFrame], float, list[Note]]:
    """Return the points of a table of contacts, and notes on images that are left out.

    The second value is the rms error of the contacts' boundary [mm] that explains the errors of the areas, or
    nan.
    """
    contacts = read_contacts(table)
    contacts["test"] = contacts["test"].replace("", label)
    (pressed, left_out), (sheared, without) = pressed_points(contacts), sheared_points(contacts)
    why = "; ".join(map(str, left_out)) or "no image has a load and an area"
    must = f"holds neither images with a load and the areas of all contacts, nor sheared areas: {why}"
    refuse_if(pressed.empty and sheared.empty, f"{table.name} {must}")
    closed = contacts[contacts["area"] > 0.0]
    errors = closed["area_error"] / (2.0 * np.sqrt(np.pi * closed["area"]))
    notes = [Note(f"{table.name}: {note}", note.level) for note in (*left_out, *without)]
    return (pressed, sheared), float(np.sqrt((errors**2).mean())), notes


def calibration_data(*found: Calibration) -> dict[str, Any]:
    """Return the results for JSON; ``covariance`` has the values and the covariance of the parameters."""
    names, matrix = joint_covariance(*found)
    values = {name: estimate.value for each in found for name, estimate in each.estimates.items()}
    covariance = {
        "parameters": list(names),
        "units": [UNITS[name] for name in names],
        "values": [values[name] for name in names],
        "matrix": matrix.tolist(),
    }
    kinds = {"compression" if "adhesion_energy" in each.estimates else "shear": each for each in found}
    return {kind: each.to_dict() for kind, each in kinds.items()} | {"covariance": covariance}


def calibration_text(*found: Calibration, sources: Sequence[str] = ()) -> str:
    """Return the results as TOML: sections of a specification, and the section ``[covariance]``."""
    lines = [FIRST, *(f"# Measured: {source}" for source in sources)]
    for each in found:
        adhesion = each.estimates.get("adhesion_energy")
        if adhesion is None:
            lines += ["", "[friction]", _stated("shear_strength", each), _stated("area_ratio", each)]
            continue
        lines += ["", "[material]", _stated("composite_modulus", each), "", "[contact]"]
        if adhesion.interval[0]:
            lines += ['kind = "jkr"', _stated("adhesion_energy", each)]
        else:
            _, interval, unit, _ = printed("adhesion_energy", adhesion)
            lines += ['kind = "hertz"', f"# The adhesion energy is {interval} {unit}."]
    # JSON strings, numbers and lists are valid in TOML
    covariance = calibration_data(*found)["covariance"]
    lines += ["", "[covariance]", *(f"{name} = {json.dumps(value)}" for name, value in covariance.items())]
    return "\n".join(lines) + "\n"


def _stated(name: str, found: Calibration) -> str:
    """Return the line of a quantity with its interval."""
    value, interval, unit, _ = printed(name, found.estimates[name], digits=3)
    if name == "area_ratio":
        value = f"{min(float(value), 1.0):g}"  # errors may make the estimate larger
    fits = "" if found.verdict.fits else "; the law does not fit"
    text = json.dumps(f"{value} {unit}") if unit else value
    return f"{name} = {text}  # {interval} {unit}".rstrip() + fits


def read_parameters(
    path: str | Path, among: Container[str] = UNITS
) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
    """Return names, values (p,) and covariance (p, p) of the parameters `among` those of a calibration.

    The file is that of ``metafem calibrate``; the units are mm, MPa and 1.
    """
    content = read_bytes(path, TABLE)
    try:
        found = tomllib.loads(content.decode("utf-8-sig"))["covariance"]
        names = tuple(map(str, found["parameters"]))
        refuse_if(not names, "parameters are empty")
        value = check.array("values", found["values"], shape=(len(names),))
        covariance = checked_covariance(names, found["matrix"], [*UNITS])[1]
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        words = "is not a calibration that metafem calibrate DATA.csv -o calibration.toml writes"
        raise InvalidInput(f"{file_label(path)} {words}: {error}") from None
    used = [i for i, name in enumerate(names) if name in among]
    return tuple(names[i] for i in used), value[used], covariance[np.ix_(used, used)]


def printed(name: str, estimate: Estimate, digits: int = 2) -> tuple[str, str, str, str]:
    """Return value, 68 % interval, unit and standard deviation of a quantity as texts.

    The value has the decimals that show `digits` digits of its standard deviation, and the others two.

    Examples
    --------
    >>> from metafem.calibration import shear
    >>> found = shear([0.05, 0.1, 0.2], [0.0425, 0.085, 0.17], [0.0157, 0.0315, 0.0629])
    >>> printed("area_ratio", found.estimates["area_ratio"])
    ('0.850', '0.840 to 0.860', '', '0.011')
    """
    unit, size = PRINTED.get(name, (UNITS[name].replace("1", ""), 1.0))
    value, sd, (low, high) = estimate

    def text(number: float, digits: int = 2) -> str:
        if not (sd > 0.0 and math.isfinite(sd)):
            return f"{number / size:.6g}"
        places = digits - 1 - math.floor(math.log10(float(f"{sd / size:.{digits - 1}e}")))
        return f"{number / size:.{max(places, 0)}f}"

    return text(value, digits), f"{text(low)} to {text(high)}", unit, text(sd)
