"""Calibrations: reading of the tables of tests, and the file of a result with its covariance."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._given import printable, unit_of
from metafem._validate import FloatArray
from metafem.calibration import (
    ContactCalibration,
    ShearCalibration,
    at_peak,
    joint_covariance,
)
from metafem.calibration.contact_table import by_image, pressed_images, sheared_points
from metafem.calibration.statistics import UNITS, Estimate, Line, checked_covariance
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
from metafem.notes import Note, information

COLUMNS = Columns(
    "test,load_mN,area_mm2,area_1_mm2,area_before_mm2,area_sheared_mm2,friction_force_mN,displacement_um",
    (),  # the columns that are present determine which others are needed
    "measured point",
    "load_mN,area_mm2 of a compression test, area_before_mm2,area_sheared_mm2,friction_force_mN of a shear "
    "test, or displacement_um,friction_force_mN,area_mm2 of the record of one pull (or in other units)",
)

# First line of the file of a calibration.
FIRST = """# Calibration by metafem: sections of a specification, with 68 % intervals. [covariance] is for
# metafem study uncertainty --calibration and metafem compare --calibration."""

# mJ/m^2 in N/mm.
ENERGY = 1e-6


@dataclass(frozen=True, eq=False)
class Points:
    """Measured quantities of points, with the label of the test and the location in a file of each point.

    The quantities are loads (k,) [N] and areas (k,) or (k, n) [mm^2] of compression tests, or areas before
    and under shear [mm^2] and friction forces [N], (k,), nan if not measured.
    """

    values: tuple[FloatArray, ...]
    test: tuple[str, ...]
    place: tuple[str, ...]


@dataclass(eq=False)
class CalibrationData:
    """Points of several tables, pooled by their kind; None without a table of a kind.

    `contacts` is the number of contacts, if a table has their areas one by one. If all tables are those of
    contacts in images with errors, `boundary` is the rms error of the contacts' boundary [mm], otherwise
    None. `notes` state what is left out.
    """

    compression: Points | None = None
    shear: Points | None = None
    contacts: int | None = None
    boundary: float | None = None
    notes: list[Note] = field(default_factory=list)


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
    data, pressed, sheared = CalibrationData(), list[Points](), list[Points]()
    boundaries = list[float | None]()
    files = [Path(path) for path in paths]
    stems = [path.stem for path in files]
    for path in files:
        refuse_if(files.count(path) > 1, f"{file_label(path)} is given twice")
        table = read_table(path, columns, every=len(files) == 1)
        # files of the same name in different folders are different tests
        label = path.stem if stems.count(path.stem) == 1 else str(path.with_suffix(""))
        if is_of_contacts(table):
            boundaries.append(_of_contacts(table, label, pressed, sheared, data.notes))
            continue
        boundaries.append(None)
        entries = COLUMNS.read(table)
        if "displacement" in entries.columns:
            sheared.append(_pull(entries))
        else:
            _points(entries, label, pressed, sheared)
    numbers = {part.values[1].shape[1]: part.place[0] for part in pressed if part.values[1].ndim == 2}
    found = " and ".join(f"{number} ({place})" for number, place in numbers.items())
    same = "tests that are pooled have the same contacts, so calibrate them one by one"
    refuse_if(len(numbers) > 1, f"the tables hold the areas of {found} contacts; {same}")
    if numbers and any(part.values[1].ndim == 1 for part in pressed):
        words = "some tables hold the areas of single contacts and others their total; the totals are used"
        data.notes.append(information(words))
        pressed = [replace(part, values=(part.values[0], _total(part.values[1]))) for part in pressed]
    data.compression, data.shear = _pooled(pressed), _pooled(sheared)
    data.contacts = next(iter(numbers), None)
    known = [each for each in boundaries if each is not None]
    if known and len(known) == len(boundaries):
        data.boundary = float(np.sqrt(np.mean(np.square(known))))
    return data


def _pooled(parts: Sequence[Points]) -> Points | None:
    """Return all points of one kind of test, or None if there are no such tests."""
    if not parts:
        return None
    values = tuple(np.concatenate(each) for each in zip(*(part.values for part in parts), strict=True))
    test, place = (tuple(chain(*(getattr(part, name) for part in parts))) for name in ("test", "place"))
    return Points(values, test, place)


def _total(area: FloatArray) -> FloatArray:
    """Return the total area of all contacts at each point, (k,)."""
    return area if area.ndim == 1 else np.asarray(area.sum(axis=1))


def _points(entries: Entries, label: str, pressed: list[Points], sheared: list[Points]) -> None:
    """Append the points of a compression test, of a shear test, or of both."""
    file, columns = entries.table.name, entries.columns.keys() - {"test"}
    of_shear = "area_sheared" in columns  # entries of a shear test may be empty
    values = {name: entries.numbers(name, empty=of_shear) for name in columns}
    single = sorted((name for name in values if SINGLE.fullmatch(name)), key=lambda name: int(name[5:]))
    areas = [*single[:1], *({"area", "area_before"} & values.keys())]
    refuse_if(len(areas) > 1, f"{file} has the columns {' and '.join(sorted(areas))}; keep one")
    area = values.get(areas[0]) if areas else None
    if single:
        area = np.stack([values[name] for name in single], axis=1)
    place, test = entries.places(), _tests(entries, label)
    if "load" in values and area is not None:
        known = np.flatnonzero(np.isfinite(values["load"]) & np.isfinite(_total(area)))
        own = (tuple(each[i] for i in known) for each in (test, place))
        pressed.append(Points((values["load"][known], area[known]), *own))
    if of_shear and (area is not None or "friction_force" in values):
        missing = np.full(len(place), np.nan)
        before, force = missing if area is None else _total(area), values.get("friction_force", missing)
        sheared.append(Points((before, values["area_sheared"], force), tuple(test), tuple(place)))
    elif "load" not in values or area is None:
        raise COLUMNS.lacking(entries)


def _tests(entries: Entries, default: str) -> list[str]:
    """Return the label of the test of each line."""
    if "test" not in entries.columns:
        return [default] * len(entries.table.rows)
    return [printable(text, 60) for text in entries.texts("test")]


def _pull(entries: Entries) -> Points:
    """Return the single point of static friction that the record of one pull yields."""
    missing = [name for name in ("friction_force", "area") if name not in entries.columns]
    if missing:
        raise COLUMNS.lacking(entries, *missing)
    displacement, force = entries.numbers("displacement"), entries.numbers("friction_force")
    area = entries.numbers("area", empty=True)
    with entries.located():
        sheared, friction = at_peak(displacement, force, area), at_peak(displacement, force)
    before = area[np.isfinite(area)][:1]  # the first frame shows the contacts before shear
    values = before, np.array([sheared]), np.array([friction])
    return Points(values, (_tests(entries, "records")[0],), (entries.table.name,))


def _of_contacts(
    table: Table, label: str, pressed: list[Points], sheared: list[Points], notes: list[Note]
) -> float | None:
    """Append the points of a table of contacts, and notes on images that are left out.

    Return the rms error of the contacts' boundary [mm] that explains the errors of the areas, or None.
    """
    contacts, name = contacts_of(table), table.name
    images, areas = by_image(contacts)
    place = [f"{name}, image {image}" for image in images["image"]]
    test = [each or label for each in images["test"]]
    used, left_out = pressed_images(contacts)
    points, image, without = sheared_points(contacts)
    for parts, values, rows in (
        (pressed, (images["load"].to_numpy()[used], areas["area"][used]), used),
        (sheared, tuple(points), image),
    ):
        if rows.size:
            parts.append(Points(values, *(tuple(each[i] for i in rows) for each in (test, place))))
    why = "; ".join(map(str, left_out)) or "no image has a load and an area"
    must = f"holds neither images with a load and the areas of all contacts, nor sheared areas: {why}"
    refuse_if(not used.size and not image.size, f"{name} {must}")
    notes += [replace(note, text=f"{name}: {note}") for note in (*left_out, *without)]
    known = contacts[contacts["area"] > 0.0]
    errors = known["area_error"] / (2.0 * np.sqrt(np.pi * known["area"]))
    return float(np.sqrt(np.mean(errors**2))) or None if errors.size else None


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


def calibration_data(contact: ContactCalibration | None, shear: ShearCalibration | None) -> dict[str, Any]:
    """Return the results for JSON; ``covariance`` has the values and the covariance of the parameters."""
    kinds = {"compression": contact, "shear": shear}
    found = {kind: each for kind, each in kinds.items() if each is not None}
    names, matrix = joint_covariance(*found.values())
    values = {} if contact is None else {"radius": contact.radius}
    for each in found.values():
        values |= {name: estimate.value for name, estimate in each.estimates.items()}
    covariance = {
        "parameters": list(names),
        "units": [UNITS[name] for name in names],
        "values": [float(values[name]) for name in names],
        "matrix": matrix.tolist(),
    }
    return {kind: each.to_dict() for kind, each in found.items()} | {"covariance": covariance}


def calibration_text(
    contact: ContactCalibration | None,
    shear: ShearCalibration | None,
    *,
    sources: Sequence[str] = (),
    cap: Mapping[str, Any] | None = None,
) -> str:
    """Return the results as TOML: sections of a specification, and the section ``[covariance]``.

    `cap` is the section of the contact law of the caps; default: that of Hertz.
    """
    lines = [FIRST, *(f"# Measured: {source}" for source in sources)]
    if contact is not None:
        modulus, energy = contact.estimates.values()
        lines += ["", "[material]", _stated("composite_modulus", modulus, contact.lines[0])]
        cap = cap or {"kind": "hertz"}
        low, high = (end / ENERGY for end in energy.interval)
        energy = Estimate(energy.value / ENERGY, 0.5 * (high - low), (low, high))
        lines += ["", "[contact]"]
        if contact.adhesive and cap["kind"] != "tabulated":
            lines += ['kind = "jkr"', _stated("adhesion_energy", energy, contact.lines[0], "mJ/m^2")]
            lines += ["", "[contact.cap]", *_keys(cap)] if cap["kind"] != "hertz" else []
        else:
            lines += [*_keys(cap), f"# The adhesion energy is {interval(energy, 'mJ/m^2')}."]
    if shear is not None:
        ratio = shear.estimates["area_ratio"]._replace(value=shear.friction.area_ratio)
        lines += ["", "[friction]"]
        lines.append(_stated("shear_strength", shear.estimates["shear_strength"], shear.lines[1]))
        lines.append(_stated("area_ratio", ratio, shear.lines[0]))
    lines += ["", "[covariance]", *_keys(calibration_data(contact, shear)["covariance"])]
    return "\n".join(lines) + "\n"


def _stated(name: str, estimate: Estimate, line: Line, unit: str = "") -> str:
    """Return the line of a quantity with its interval."""
    unit = (unit or UNITS[name]).replace("1", "")
    value = f"{rounded(estimate.value, estimate.sd, 3)} {unit}".rstrip()
    fits = "" if line.verdict.fits else "; the law does not fit"
    return f"{name} = {json.dumps(value) if unit else value}  # {interval(estimate, unit)}{fits}"


def _keys(section: Mapping[str, Any]) -> list[str]:
    """Return the lines of a section's keys; JSON strings, numbers and lists are valid in TOML."""
    return [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in section.items()]


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


def rounded(value: float, sd: float, digits: int = 2) -> str:
    """Return a value as text, with the decimals that show `digits` digits of its standard deviation.

    Examples
    --------
    >>> rounded(1.35987, 0.0193), rounded(0.37, 0.0)
    ('1.360', '0.37')
    """
    if not (sd > 0.0 and math.isfinite(sd)):
        return f"{value:.6g}"
    places = digits - 1 - math.floor(math.log10(float(f"{sd:.{digits - 1}e}")))
    return f"{value:.{max(places, 0)}f}"


def interval(estimate: Estimate, unit: str = "") -> str:
    """Return an interval as text, with the decimals that show two digits of the standard deviation.

    Examples
    --------
    >>> interval(Estimate(1.36, 0.0193, (1.3406, 1.3794)), "MPa")
    '1.341 to 1.379 MPa'
    """
    low, high = (rounded(end, estimate.sd) for end in estimate.interval)
    return f"{low} to {high} {unit}".rstrip()
