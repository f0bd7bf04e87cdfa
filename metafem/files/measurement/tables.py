"""Tables of calibration tests: compression, shear, records of single pulls, and contacts in images."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from metafem._given import printable
from metafem._validate import FloatArray
from metafem.calibration import ContactTable, ShearRecord, shear_record
from metafem.calibration.contact_table import pressed_images, sheared_points
from metafem.errors import InvalidInput, named
from metafem.files.measurement.contacts import contacts_of, is_of_contacts
from metafem.files.measurement.points import Compression, Shear, pooled_compression, pooled_shear
from metafem.files.reading import file_label
from metafem.files.tables import Columns, Entries, read_table
from metafem.notes import Note

# Areas of single contacts: area_1, area_2 and so on.
SINGLE = re.compile(r"area_\d{1,4}", re.ASCII)

COLUMNS = Columns(
    "test,load_mN,area_mm2,area_before_mm2,area_sheared_mm2,friction_force_mN,displacement_um",
    (),  # the columns that are present determine which others are needed
    "measured point",
    "load_mN,area_mm2 of a compression test, area_before_mm2,area_sheared_mm2,friction_force_mN of a shear "
    "test, or displacement_um,friction_force_mN,area_mm2 of the record of one pull (or in other units)",
    lambda name: "area" if SINGLE.fullmatch(name) else name,
)


@dataclass(eq=False)
class CalibrationData:
    """Pooled data of tables.

    `records` holds the records of pulls by the name of their file, `boundary` the error of the contacts'
    boundary [mm] from the tables of images (for all areas or not at all), and `position` the centres of the
    contacts (n, 2) [mm] of the first of these tables. `notes` state what is left out.
    """

    compression: Compression | None = None
    shear: Shear | None = None
    records: dict[str, ShearRecord] = field(default_factory=dict)
    boundary: float | None = None
    position: FloatArray | None = None
    notes: list[Note] = field(default_factory=list)


def read_calibration(
    paths: Iterable[str | Path],
    *,
    sliding: bool = False,
    sliding_range: tuple[float, float] | None = None,
) -> CalibrationData:
    """Read tables of calibration tests, each recognised by its columns, and pool them.

    Parameters
    ----------
    paths : iterable of str or Path
        CSV files whose first line names the columns as quantity_unit. A compression test has ``load`` and
        ``area`` (the total) or ``area_1``, ``area_2`` ... of single contacts. A shear test has
        ``area_before`` (or ``area``), ``area_sheared`` and ``friction_force``; entries may be empty, and a
        column ``load`` may be present. A record of one pull has ``displacement``, ``friction_force`` and
        ``area``, which is empty between the frames. Tables of ``metafem images`` are read too. A column
        ``test`` holds labels of tests; without it each table is a test, and all records together are one.
    sliding : bool
        Whether records yield sliding instead of static friction.
    sliding_range : (float, float), optional
        Of `metafem.calibration.shear_record`.
    """
    data = CalibrationData()
    parts: list[Compression | Shear] = []
    boundaries: list[float | None] = []
    files = [Path(path) for path in paths]
    for i, path in enumerate(files):
        if path in files[:i]:
            raise InvalidInput(f"{file_label(path)} is given twice")
    stems = [path.stem for path in files]
    for path in files:
        table = read_table(path, "load_mN,area_mm2")
        # files with the same name in several folders are several tests
        label = path.stem if stems.count(path.stem) == 1 else str(path.with_suffix(""))
        if is_of_contacts(table):
            contacts = contacts_of(table)
            found, notes = _of_contacts(contacts, table.name, label)
            parts += found
            data.notes += notes
            boundaries.append(_boundary(contacts))
            data.position = contacts.position if data.position is None else data.position
            continue
        boundaries.append(None)
        entries = COLUMNS.of(table)
        if "displacement" in entries.columns:
            record = data.records[table.name] = _record(entries, sliding_range)
            data.notes += [replace(note, text=f"{table.name}: {note}") for note in record.notes]
            parts.append(_pull(entries, record, sliding))
        else:
            parts += _points(entries, label)
    if (sliding or sliding_range is not None) and not data.records:
        raise InvalidInput(
            f"{'--sliding' if sliding else '--sliding-range'} belongs to records of pulls, and no table has "
            "the columns displacement_um,friction_force_mN,area_mm2 of one; leave it out"
        )
    data.compression, notes = pooled_compression([part for part in parts if isinstance(part, Compression)])
    data.notes += notes
    data.shear = pooled_shear([part for part in parts if isinstance(part, Shear)])
    known = [each for each in boundaries if each is not None]
    if known and len(known) == len(boundaries):
        data.boundary = float(np.sqrt(np.mean(np.square(known))))
    return data


def _points(entries: Entries, label: str) -> list[Compression | Shear]:
    """Return the points of a compression test, of a shear test, or of both."""
    file, columns = entries.table.name, entries.columns.keys() - {"test"}
    sheared = "area_sheared" in columns  # with it, an entry may be empty
    values = {name: entries.numbers(name, empty=sheared) for name in columns}
    single = sorted((name for name in values if SINGLE.fullmatch(name)), key=lambda name: int(name[5:]))
    if single and "area" in values:
        raise InvalidInput(f"{file} has a column of the total area and {single[0]}; keep one")
    if "area" in values and "area_before" in values:
        raise InvalidInput(f"{file} has the columns area and area_before, which are the same; keep one")
    area = np.stack([values[name] for name in single], axis=1) if single else None
    if area is None:
        area = values.get("area", values.get("area_before"))
    place, test = np.array(entries.places()), np.array(_tests(entries, label))
    found: list[Compression | Shear] = []
    if "load" in values and area is not None:
        known = np.isfinite(values["load"]) & np.isfinite(area if area.ndim == 1 else area.sum(axis=1))
        found.append(Compression(values["load"][known], area[known], tuple(test[known]), tuple(place[known])))
    total = area if area is None or area.ndim == 1 else area.sum(axis=1)
    if sheared and (total is not None or "friction_force" in values):
        missing = np.full(len(place), np.nan)
        before, force = missing if total is None else total, values.get("friction_force", missing)
        found.append(Shear(before, values["area_sheared"], force, tuple(test), tuple(place)))
    if not found:
        raise COLUMNS.lacking(entries)
    return found


def _tests(entries: Entries, default: str) -> list[str]:
    """Return the test of each line."""
    if "test" not in entries.columns:
        return [default] * len(entries.table.rows)
    return [printable(text, 60) for text in entries.texts("test")]


def _record(entries: Entries, sliding_range: tuple[float, float] | None) -> ShearRecord:
    """Return the record of one pull."""
    missing = [name for name in ("friction_force", "area") if name not in entries.columns]
    if missing:
        raise COLUMNS.lacking(entries, *missing)
    displacement, force = entries.numbers("displacement"), entries.numbers("friction_force")
    area = entries.numbers("area", empty=True)
    try:
        with named(entries.names()):
            if sliding_range is None:
                record = shear_record(displacement, force, area)
            else:
                record = shear_record(displacement, force, area, sliding_range=sliding_range)
    except InvalidInput as error:
        raise of_files(error, [entries.table.name]) from None
    return record


def _pull(entries: Entries, record: ShearRecord, sliding: bool) -> Shear:
    """Return the point of the record of one pull."""
    if sliding:
        area, force = record.sliding_area, record.sliding_force
    else:
        area, force = record.static_area, record.static_force
    assert record.area_before is not None
    assert area is not None
    test, place = (_tests(entries, "records")[0],), (entries.table.name,)
    return Shear(np.array([record.area_before]), np.array([area]), np.array([force]), test, place)


def _of_contacts(
    contacts: ContactTable, name: str, label: str
) -> tuple[list[Compression | Shear], list[Note]]:
    """Return the points of the images, and notes on those that are left out."""
    place = np.array([f"{name}, image {image}" for image in contacts.image])
    test = np.array([each or label for each in contacts.test])
    used, left_out = pressed_images(contacts)
    points, image, without = sheared_points(contacts)
    found: list[Compression | Shear] = []
    if used.size:
        found.append(
            Compression(contacts.load[used], contacts.area[used], tuple(test[used]), tuple(place[used]))
        )
    if image.size:
        before, sheared, force = points
        found.append(Shear(before, sheared, force, tuple(test[image]), tuple(place[image])))
    if not found:
        why = "; ".join(map(str, left_out)) or "no image has a load and an area"
        raise InvalidInput(
            f"{name} holds neither images with a load and the areas of all contacts, nor sheared areas: {why}"
        )
    return found, [replace(note, text=f"{name}: {note}") for note in (*left_out, *without)]


def _boundary(contacts: ContactTable) -> float | None:
    """Return the rms error of the boundary [mm] that causes the errors of the areas."""
    known = np.isfinite(contacts.area) & (contacts.area > 0.0)
    if not known.any():
        return None
    errors = contacts.area_error[known] / (2.0 * np.sqrt(np.pi * contacts.area[known]))
    return float(np.sqrt(np.mean(errors**2))) or None


def of_files(error: InvalidInput, names: list[str]) -> InvalidInput:
    """Return an error that names the files it belongs to."""
    text = str(error)
    # an option is not part of a file, and a place already names its file
    if text.startswith("--") or any(name in text for name in names):
        return error
    return InvalidInput(f"{', '.join(names)}: {text}")
