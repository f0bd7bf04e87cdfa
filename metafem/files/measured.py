"""Reading of tables of calibration tests: compression, shear, records of single pulls, contacts in images."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._given import printable, unit_of
from metafem._validate import FloatArray
from metafem.calibration import at_peak, over_plateau
from metafem.calibration.contact_table import by_image, pressed_images, sheared_points
from metafem.errors import InvalidInput, refuse_if
from metafem.files.contacts import contacts_of
from metafem.files.disk import file_label
from metafem.files.tables import NONE, SINGLE, Columns, Entries, is_of_contacts, read_table, row_of
from metafem.notes import Note, information

if TYPE_CHECKING:
    from pandas import DataFrame

COLUMNS = Columns(
    "test,load_mN,area_mm2,area_1_mm2,area_before_mm2,area_sheared_mm2,friction_force_mN,displacement_um",
    (),  # the columns that are present determine which others are needed
    "measured point",
    "load_mN,area_mm2 of a compression test, area_before_mm2,area_sheared_mm2,friction_force_mN of a shear "
    "test, or displacement_um,friction_force_mN,area_mm2 of the record of one pull (or in other units)",
)


@dataclass(frozen=True, eq=False)
class Compression:
    """Loads [N], (k,), and areas [mm^2], (k,) or (k, n), of compression tests.

    Each point has the label of its test, and its location in the files. `contacts` is the number of contacts,
    if a table has the areas of single contacts.
    """

    load: FloatArray
    area: FloatArray
    test: tuple[str, ...]
    place: tuple[str, ...]
    contacts: int | None = None


@dataclass(frozen=True, eq=False)
class Shear:
    """Areas before and under shear [mm^2] and friction forces [N], (k,); nan if not measured.

    Each point has the label of its test, and its location in the files.
    """

    area_before: FloatArray
    area_sheared: FloatArray
    friction_force: FloatArray
    test: tuple[str, ...]
    place: tuple[str, ...]


@dataclass(eq=False)
class CalibrationData:
    """Pooled data of several tables.

    If all tables are tables of contacts in images with
    errors, `boundary` is the rms error of the contacts' boundary [mm], otherwise None. `notes` state what is
    left out.
    """

    compression: Compression | None = None
    shear: Shear | None = None
    boundary: float | None = None
    notes: list[Note] = field(default_factory=list)


def read_calibration(
    paths: Iterable[str | Path],
    *,
    sliding: bool = False,
    columns: Mapping[str, str] = NONE,
) -> CalibrationData:
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
    sliding : bool
        Whether the records yield sliding friction instead of static friction.
    columns : mapping of str to str
        Titles in the files by the names that they stand for; see `read_table`.
    """
    data = CalibrationData()
    parts: list[Compression | Shear] = []
    boundaries: list[float | None] = []
    pulls = False
    files = [Path(path) for path in paths]
    for path in files:
        refuse_if(files.count(path) > 1, f"{file_label(path)} is given twice")
    stems = [path.stem for path in files]
    for path in files:
        table = read_table(path, columns, every=len(files) == 1)
        # files of the same name in different folders are different tests
        label = path.stem if stems.count(path.stem) == 1 else str(path.with_suffix(""))
        if is_of_contacts(table):
            contacts = contacts_of(table)
            parts += _of_contacts(contacts, table.name, label, data.notes)
            boundaries.append(_boundary(contacts))
            continue
        boundaries.append(None)
        entries = COLUMNS.read(table)
        if "displacement" in entries.columns:
            pulls = True
            parts.append(_pull(entries, sliding))
        else:
            parts += _points(entries, label)
    refuse_if(
        sliding and not pulls,
        "--sliding belongs to records of pulls, and no table has the columns "
        "displacement_um,friction_force_mN,area_mm2 of one; leave it out",
    )
    data.compression = _pooled_compression(
        [part for part in parts if isinstance(part, Compression)], data.notes
    )
    data.shear = _pooled([part for part in parts if isinstance(part, Shear)])
    known = [each for each in boundaries if each is not None]
    if known and len(known) == len(boundaries):
        data.boundary = float(np.sqrt(np.mean(np.square(known))))
    return data


def _pooled_compression(parts: list[Compression], notes: list[Note]) -> Compression | None:
    """Return all points of compression tests; if a table has only total areas, all areas are totals."""
    numbers = {part.area.shape[1]: part.place[0] for part in parts if part.area.ndim == 2}
    found = " and ".join(f"{number} ({place})" for number, place in numbers.items())
    refuse_if(
        len(numbers) > 1,
        f"the tables hold the areas of {found} contacts; tests that are pooled have the same contacts, so "
        "calibrate them one by one",
    )
    if numbers and any(part.area.ndim == 1 for part in parts):
        notes.append(
            information(
                "some tables hold the areas of single contacts and others their total; the totals are used"
            )
        )
        parts = [replace(part, area=_total(part.area)) for part in parts]
    pooled = _pooled(parts)
    return None if pooled is None else replace(pooled, contacts=next(iter(numbers), None))


def _pooled(parts: Sequence[Compression | Shear]) -> Any:
    """Return all points of one kind of test, or None if there are no such tests."""
    if not parts:
        return None
    members = {name: [getattr(part, name) for part in parts] for name in vars(parts[0]) if name != "contacts"}
    pooled: dict[str, Any] = {
        name: tuple(chain(*values)) if name in ("test", "place") else np.concatenate(values)
        for name, values in members.items()
    }
    return type(parts[0])(**pooled)


def _total(area: FloatArray) -> FloatArray:
    """Return the total area of all contacts at each point, (k,)."""
    return area if area.ndim == 1 else np.asarray(area.sum(axis=1))


def _points(entries: Entries, label: str) -> list[Compression | Shear]:
    """Return the points of a compression test, of a shear test, or of both."""
    file, columns = entries.table.name, entries.columns.keys() - {"test"}
    sheared = "area_sheared" in columns  # entries of a shear test may be empty
    values = {name: entries.numbers(name, empty=sheared) for name in columns}
    single = sorted((name for name in values if SINGLE.fullmatch(name)), key=lambda name: int(name[5:]))
    both = f"{file} has a column of the total area and {' '.join(single[:1])}; keep one"
    refuse_if(single and "area" in values, both)
    twice = {"area", "area_before"} <= values.keys()
    refuse_if(twice, f"{file} has the columns area and area_before, which are the same; keep one")
    area = values.get("area", values.get("area_before"))
    if single:
        area = np.stack([values[name] for name in single], axis=1)
    place, test = np.array(entries.places()), np.array(_tests(entries, label))
    found: list[Compression | Shear] = []
    if "load" in values and area is not None:
        known = np.isfinite(values["load"]) & np.isfinite(_total(area))
        found.append(Compression(values["load"][known], area[known], tuple(test[known]), tuple(place[known])))
    if sheared and (area is not None or "friction_force" in values):
        missing = np.full(len(place), np.nan)
        before, force = missing if area is None else _total(area), values.get("friction_force", missing)
        found.append(Shear(before, values["area_sheared"], force, tuple(test), tuple(place)))
    if not found:
        raise COLUMNS.lacking(entries)
    return found


def _tests(entries: Entries, default: str) -> list[str]:
    """Return the label of the test of each line."""
    if "test" not in entries.columns:
        return [default] * len(entries.table.rows)
    return [printable(text, 60) for text in entries.texts("test")]


def _pull(entries: Entries, sliding: bool) -> Shear:
    """Return the single point of static or sliding friction that the record of one pull yields."""
    missing = [name for name in ("friction_force", "area") if name not in entries.columns]
    if missing:
        raise COLUMNS.lacking(entries, *missing)
    displacement, force = entries.numbers("displacement"), entries.numbers("friction_force")
    area = entries.numbers("area", empty=True)
    value = over_plateau if sliding else at_peak
    with entries.located():
        sheared, friction = value(displacement, force, area), value(displacement, force)
    before = area[np.isfinite(area)][:1]  # the first frame shows the contacts before shear
    return Shear(
        before,
        np.array([sheared]),
        np.array([friction]),
        (_tests(entries, "records")[0],),
        (entries.table.name,),
    )


def _of_contacts(contacts: DataFrame, name: str, label: str, notes: list[Note]) -> list[Compression | Shear]:
    """Return the points of a table of contacts, and append notes on images that are left out."""
    images, areas = by_image(contacts)
    place = np.array([f"{name}, image {image}" for image in images["image"]])
    test = np.array([each or label for each in images["test"]])
    used, left_out = pressed_images(contacts)
    points, image, without = sheared_points(contacts)
    found: list[Compression | Shear] = []
    if used.size:
        found.append(
            Compression(
                images["load"].to_numpy()[used], areas["area"][used], tuple(test[used]), tuple(place[used])
            )
        )
    if image.size:
        before, sheared, force = points
        found.append(Shear(before, sheared, force, tuple(test[image]), tuple(place[image])))
    why = "; ".join(map(str, left_out)) or "no image has a load and an area"
    must = f"holds neither images with a load and the areas of all contacts, nor sheared areas: {why}"
    refuse_if(not found, f"{name} {must}")
    notes += _named((*left_out, *without), name)
    return found


def _named(notes: Iterable[Note], file: str) -> list[Note]:
    """Return the notes with the name of their file in front of the text."""
    return [replace(note, text=f"{file}: {note}") for note in notes]


def _boundary(contacts: DataFrame) -> float | None:
    """Return the rms error of the contacts' boundary [mm] that explains the errors of the areas, or None."""
    known = contacts[contacts["area"] > 0.0]
    if known.empty:
        return None
    errors = known["area_error"] / (2.0 * np.sqrt(np.pi * known["area"]))
    return float(np.sqrt(np.mean(errors**2))) or None


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
