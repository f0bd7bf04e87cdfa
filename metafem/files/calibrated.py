"""Calibrations: the points in tables of tests, and the file of a result with its covariance."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import _validate as check
from metafem._given import printable, unit_of
from metafem._validate import FloatArray
from metafem.calibration import Calibration, at_peak, joint_covariance
from metafem.calibration.contact_table import by_image, pressed_images, sheared_points
from metafem.calibration.statistics import UNITS, checked_covariance
from metafem.contact import Hertz
from metafem.errors import InvalidInput, refuse_if
from metafem.files.contacts import contacts_of
from metafem.files.disk import TABLE, file_label, read_bytes
from metafem.files.tables import (
    NONE,
    SINGLE,
    Columns,
    Entries,
    Table,
    is_of_contacts,
    read_table,
    row_of,
)
from metafem.notes import Note

if TYPE_CHECKING:
    from pandas import DataFrame

COLUMNS = Columns(
    "test,load_mN,area_mm2,area_1_mm2,area_before_mm2,area_sheared_mm2,friction_force_mN,displacement_um",
    (),  # the columns that are present determine which others are needed
    "measured point",
    "load_mN,area_mm2 of a compression test, area_before_mm2,area_sheared_mm2,friction_force_mN of a shear "
    "test, or displacement_um,friction_force_mN,area_mm2 of the record of one pull (or in other units)",
)

# Measured quantities of a shear test.
SHEARED = ["area_before", "area_sheared", "friction_force"]

# First line of the file of a calibration.
FIRST = """# Calibration by metafem: sections of a specification, with 68 % intervals. [covariance] is for
# metafem study uncertainty --calibration and metafem compare --calibration."""

# Unit in which a quantity is printed, and its size in the package's unit, where this is not the package's.
PRINTED = {"adhesion_energy": ("mJ/m^2", 1e-6), "radius": ("um", 1e-3)}


@dataclass(frozen=True, eq=False)
class CalibrationData:
    """Points of several tables, pooled by their kind; None without a table of a kind.

    The columns of `compression` are ``load`` [N] and ``area`` (the total) or ``area_1``, ``area_2`` ...
    [mm^2], those of `shear` ``area_before`` and ``area_sheared`` [mm^2] and ``friction_force`` [N], nan if
    not measured. Both have the columns ``test``, the label of the test, and ``place``, the location of the
    point in a file. If all tables are those of contacts in images with errors, `boundary` is the rms error of
    the contacts' boundary [mm], otherwise None. `notes` state what is left out.
    """

    compression: DataFrame | None
    shear: DataFrame | None
    boundary: float | None
    notes: list[Note]


@dataclass(frozen=True, eq=False)
class CalibratedParameters:
    """Names of a calibration's parameters, with their values (n,) and covariance (n, n), in mm, MPa and 1."""

    parameters: tuple[str, ...]
    value: FloatArray
    covariance: FloatArray

    @property
    def sd(self) -> FloatArray:
        """Standard deviations of the parameters, (n,)."""
        return np.sqrt(np.diagonal(self.covariance))


def read_calibration(paths: Iterable[str | Path], *, columns: Mapping[str, str] = NONE) -> CalibrationData:
    """Return the pooled data of tables of calibration tests; the columns determine the kind of a table.

    Parameters
    ----------
    paths : iterable of str or Path
        CSV files whose first line names the columns as quantity_unit. A compression test has the columns
        ``load`` and either ``area`` (the total) or ``area_1``, ``area_2`` ... (single contacts). A shear test
        has ``area_before`` (or ``area``), ``area_sheared`` and ``friction_force``; its entries may be empty,
        and it may have a column ``load``. A record of one pull has ``displacement``, ``friction_force`` and
        ``area``; the area is empty between the frames of the camera. Tables of ``metafem images`` are also
        read. A column ``test`` holds the labels of tests. Without this column, each table is one test, and
        all records together are one test.
    columns : mapping of str to str
        Titles in the files by the names that they stand for; see `read_table`.
    """
    import pandas as pd

    notes: list[Note] = []
    pressed: list[DataFrame] = []
    sheared: list[DataFrame] = []
    boundaries: list[float | None] = []
    files = [Path(path) for path in paths]
    stems = [path.stem for path in files]
    for path in files:
        refuse_if(files.count(path) > 1, f"{file_label(path)} is given twice")
        table = read_table(path, columns, every=len(files) == 1)
        # files of the same name in different folders are different tests
        label = path.stem if stems.count(path.stem) == 1 else str(path.with_suffix(""))
        if is_of_contacts(table):
            one, other, boundary, left_out = _of_contacts(table, label)
            boundaries.append(boundary)
            notes += left_out
        else:
            one, other = _of_tests(COLUMNS.read(table), label)
            boundaries.append(None)
        pressed += [one] * (len(one) > 0)
        sheared += [other] * (len(other) > 0)
    # 0 contacts stand for their total area
    counts = {sum("area_" in name for name in each): each["place"].iloc[0] for each in pressed}
    found = " and ".join(f"{count or 'a total'} ({place})" for count, place in counts.items())
    same = "tests that are pooled have the same contacts, so calibrate them one by one"
    refuse_if(len(counts) > 1, f"the tables hold the areas of {found} contacts; {same}")
    known = [each for each in boundaries if each is not None]
    rms = float(np.sqrt(np.mean(np.square(known)))) if len(known) == len(files) else None
    pressing, shear = (pd.concat(parts, ignore_index=True) if parts else None for parts in (pressed, sheared))
    return CalibrationData(pressing, shear, rms, notes)


def _total(points: DataFrame) -> FloatArray:
    """Return the total area of all contacts at each point, (k,); nan without areas."""
    names = [name for name in points if SINGLE.fullmatch(name) or name in ("area", "area_before")]
    return np.asarray(points[names].sum(axis=1, skipna=False) if names else np.full(len(points), np.nan))


def _of_tests(entries: Entries, label: str) -> tuple[DataFrame, DataFrame]:
    """Return the points of compression and of shear tests in a table, which may be empty."""
    import pandas as pd

    names, file = entries.columns.keys() - {"test"}, entries.table.name
    of_shear, record = "area_sheared" in names, "displacement" in names
    single = sorted((name for name in names if SINGLE.fullmatch(name)), key=lambda name: int(name[5:]))
    areas = [*single[:1], *sorted({"area", "area_before"} & names)]
    refuse_if(len(areas) > 1, f"{file} has the columns {' and '.join(sorted(areas))}; keep one")
    needed = {"friction_force", "area"} if record else set[str]()
    enough = (areas and "load" in names) or (of_shear and (areas or "friction_force" in names))
    if needed - names or not (record or enough):
        raise COLUMNS.lacking(entries, *sorted(needed - names, reverse=True))
    area = single or areas
    # entries of a shear test may be empty, and those of the area in the record of a pull
    read = {name: entries.numbers(name, empty=of_shear or (record and name in area)) for name in names}
    points = pd.DataFrame({name: read[name] for name in ["load", *area, *SHEARED[1:]] if name in names})
    tests = [printable(text, 60) for text in entries.texts("test")]
    points["test"] = tests if "test" in entries.columns else label
    points["place"] = entries.places()
    if record:
        with entries.located():
            peak = [at_peak(read["displacement"], read["friction_force"], of) for of in (read["area"], None)]
        # the first frame shows the contacts before shear
        test = tests[0] if "test" in entries.columns else "records"
        values = [[read["area"][np.isfinite(read["area"])][0], *peak, test, file]]
        return points[:0], pd.DataFrame(values, columns=[*SHEARED, "test", "place"])
    sheared = points.assign(area_before=_total(points)).reindex(columns=[*SHEARED, "test", "place"])
    if "load" not in names or not area:
        return points[:0], sheared
    return points[["load", *area, "test", "place"]].dropna(), sheared if of_shear else sheared[:0]


def _of_contacts(table: Table, label: str) -> tuple[DataFrame, DataFrame, float | None, list[Note]]:
    """Return the points of a table of contacts, and notes on images that are left out.

    The third value is the rms error of the contacts' boundary [mm] that explains the errors of the areas, or
    None.
    """
    import pandas as pd

    contacts = contacts_of(table)
    images, areas = by_image(contacts)
    known = pd.DataFrame({"test": images["test"].replace("", label)})
    known["place"] = [f"{table.name}, image {image}" for image in images["image"]]
    used, left_out = pressed_images(contacts)
    points, image, without = sheared_points(contacts)
    pressed = pd.DataFrame(areas["area"][used]).rename(columns=lambda i: f"area_{i + 1}")
    pressed.insert(0, "load", images["load"].to_numpy()[used])
    sheared = pd.DataFrame(points.T, columns=SHEARED)
    why = "; ".join(map(str, left_out)) or "no image has a load and an area"
    must = f"holds neither images with a load and the areas of all contacts, nor sheared areas: {why}"
    refuse_if(not used.size and not image.size, f"{table.name} {must}")
    closed = contacts[contacts["area"] > 0.0]
    errors = closed["area_error"] / (2.0 * np.sqrt(np.pi * closed["area"]))
    boundary = float(np.sqrt(np.mean(errors**2))) or None if errors.size else None
    notes = [Note(f"{table.name}: {note}", note.level) for note in (*left_out, *without)]
    both = (
        pd.concat([values, known.iloc[rows].reset_index(drop=True)], axis=1)
        for values, rows in ((pressed, used), (sheared, image))
    )
    return *both, boundary, notes


@contextmanager
def of_tables(files: Sequence[str], places: Sequence[str] = ()) -> Iterator[None]:
    """Make errors of the body name the files or, for an entry of an array, its place in a file."""
    try:
        yield
    except InvalidInput as error:
        name, row = row_of(error.key)
        if row < len(places):
            error = error.at(name)
            if isinstance(error.value, float):
                error.value = f"{error.value:g} {unit_of(name)}"
            raise InvalidInput(f"{places[row]}: {error}") from None
        text = str(error)
        if error.key or any(name in text for name in files):  # an option, or a file that is named already
            raise
        raise InvalidInput(f"{', '.join(files)}: {text}") from None


def calibration_data(contact: Calibration | None, shear: Calibration | None) -> dict[str, Any]:
    """Return the results for JSON; ``covariance`` has the values and the covariance of the parameters."""
    found = {kind: each for kind, each in (("compression", contact), ("shear", shear)) if each is not None}
    names, matrix = joint_covariance(*found.values())
    values = {name: each.value for one in found.values() for name, each in one.estimates.items()}
    covariance = {
        "parameters": list(names),
        "units": [UNITS[name] for name in names],
        "values": [values[name] for name in names],
        "matrix": matrix.tolist(),
    }
    return {kind: each.to_dict() for kind, each in found.items()} | {"covariance": covariance}


def calibration_text(
    contact: Calibration | None,
    shear: Calibration | None,
    *,
    sources: Sequence[str] = (),
) -> str:
    """Return the results as TOML: sections of a specification, and the section ``[covariance]``."""
    lines = [FIRST, *(f"# Measured: {source}" for source in sources)]
    if contact is not None:
        lines += ["", "[material]", _stated("composite_modulus", contact), "", "[contact]"]
        if contact.contact_law == Hertz():
            _, interval, unit, _ = printed("adhesion_energy", contact)
            lines += ['kind = "hertz"', f"# The adhesion energy is {interval} {unit}."]
        else:
            lines += ['kind = "jkr"', _stated("adhesion_energy", contact)]
    if shear is not None:
        lines += ["", "[friction]", _stated("shear_strength", shear), _stated("area_ratio", shear)]
    covariance = calibration_data(contact, shear)["covariance"]
    # JSON strings, numbers and lists are valid in TOML
    lines += ["", "[covariance]", *(f"{name} = {json.dumps(value)}" for name, value in covariance.items())]
    return "\n".join(lines) + "\n"


def _stated(name: str, found: Calibration) -> str:
    """Return the line of a quantity with its interval."""
    value, interval, unit, _ = printed(name, found, digits=3)
    if name == "area_ratio":
        value = f"{min(float(value), 1.0):g}"  # errors may make the estimate larger
    fits = "" if found.verdict.fits else "; the law does not fit"
    text = json.dumps(f"{value} {unit}") if unit else value
    return f"{name} = {text}  # {interval} {unit}".rstrip() + fits


def read_parameters(path: str | Path) -> CalibratedParameters:
    """Return the parameters in a file of ``metafem calibrate``, with their values and covariance."""
    label, found = file_label(path), None
    with suppress(UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError):
        found = tomllib.loads(read_bytes(path, TABLE).decode("utf-8-sig")).get("covariance")
    if not isinstance(found, dict):
        raise InvalidInput(
            f"{label} is not a calibration; write one with metafem calibrate DATA.csv -o calibration.toml"
        )
    try:
        names = tuple(map(str, found["parameters"]))
        refuse_if(not names, "parameters are empty")
        value = check.array("values", found["values"], shape=(len(names),))
        return CalibratedParameters(names, value, checked_covariance(names, found["matrix"], [*UNITS])[1])
    except (KeyError, TypeError, InvalidInput) as error:
        raise InvalidInput(f"{label} is damaged: its [covariance] cannot be used: {error}") from None


def printed(name: str, found: Calibration, digits: int = 2) -> tuple[str, str, str, str]:
    """Return value, 68 % interval, unit and standard deviation of a quantity as texts.

    The value has the decimals that show `digits` digits of its standard deviation, and the others two.

    Examples
    --------
    >>> from metafem.calibration import shear
    >>> found = shear([0.05, 0.1, 0.2], [0.0425, 0.085, 0.17], [0.0157, 0.0315, 0.0629])
    >>> printed("area_ratio", found), printed("shear_strength", found)[2]
    (('0.850', '0.840 to 0.860', '', '0.011'), 'MPa')
    """
    unit, size = PRINTED.get(name, (UNITS[name].replace("1", ""), 1.0))
    value, sd, (low, high) = found.estimates[name]

    def text(number: float, digits: int = 2) -> str:
        if not (sd > 0.0 and math.isfinite(sd)):
            return f"{number / size:.6g}"
        places = digits - 1 - math.floor(math.log10(float(f"{sd / size:.{digits - 1}e}")))
        return f"{number / size:.{max(places, 0)}f}"

    return text(value, digits), f"{text(low)} to {text(high)}", unit, text(sd)
