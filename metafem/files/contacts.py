"""Writing and reading of contacts.csv, bit for bit; the table has one line for each image and contact."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from metafem._given import printable, shown
from metafem._validate import FloatArray, IntArray
from metafem.calibration import ContactTable
from metafem.errors import InvalidInput, refuse_if
from metafem.files.tables import Columns, Entries, Table, read_table

HEADER = (
    "image,test,load_N,friction_force_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2,"
    "sheared_area_mm2,sheared_area_error_mm2"
)

COLUMNS = Columns(HEADER, ("image,load,contact,x,y,area,area_error",), "contact")

# Largest number of characters of a text in the table.
MOST = 10**4

# Column of the errors of each column of areas.
ERROR_OF = {"area": "area_error", "sheared_area": "sheared_area_error"}


def contacts_table(table: ContactTable) -> str:
    """Return the CSV text of contact areas; numbers that were not measured are empty."""
    images = list(zip(table.test, table.image, strict=True))
    for i, (test, image) in enumerate(images):
        must = f"image {printable(image)} of test {printable(test)!r} is in the table twice"
        refuse_if((test, image) in images[:i], must)
    lines = [HEADER]
    for i, (test, image) in enumerate(images):
        for j, site in enumerate(table.site.tolist()):
            numbers = (table.area, table.area_error, table.sheared_area, table.sheared_area_error)
            row = (
                *(image, test, table.load[i], table.friction_force[i], j + 1),
                *(site if table.matched else "", *table.position[j]),
                *(values[i, j] for values in numbers),
            )
            lines.append(",".join(map(_cell, row)))
    return "\n".join(lines) + "\n"


def read_contacts(path: str | Path) -> ContactTable:
    """Return the contact areas in a table that `contacts_table` wrote, or in a table with the same columns.

    All images must have the same contacts. The columns of tests, friction forces, sites and sheared areas
    may be absent. Lengths, areas and forces may be in other units.
    """
    return contacts_of(read_table(path))


def contacts_of(table: Table) -> ContactTable:
    """Return the contact areas in a table with the columns that `read_contacts` reads."""
    entries = COLUMNS.read(table)
    images, place = _arranged(entries)
    values = {name: entries.numbers(name, empty=True) for name in COLUMNS.units}
    for name, error in ERROR_OF.items():
        for column in (name, error):
            _refuse(entries, column, values[column] < 0.0, "= {text} must not be negative")
        for given, missing in ((error, name), (name, error)):
            alone = np.isnan(values[missing]) & ~np.isnan(values[given])
            if alone.any() and missing not in entries.columns:
                raise COLUMNS.lacking(entries, missing)
            words = f"is empty, and {entries.title(given)} is not; write both or none"
            _refuse(entries, missing, alone, words)
    for name in ("x", "y"):
        _refuse(entries, name, np.isnan(values[name]), "is empty; write the contact's position")

    def common(name: str, axis: int, column: FloatArray) -> FloatArray:
        return _common(entries, name, column[place], place, axis)

    matched = any(entries.texts("site"))
    sites = np.arange(place.shape[1])
    if matched:
        sites = common("site", 0, np.array(entries.whole("site", 0), dtype=float)).astype(np.intp)
        twice = np.flatnonzero([site in sites[:j] for j, site in enumerate(sites)])
        for j in twice[:1]:
            cell = entries.cell(place[0, j], "site")
            raise InvalidInput(f"{cell} = {sites[j]} is the site of another contact too")
    tests, names = zip(*images, strict=True)
    return ContactTable(
        image=names,
        test=tests,
        load=common("load", 1, values["load"]),
        friction_force=common("friction_force", 1, values["friction_force"]),
        position=np.column_stack([common(name, 0, values[name]) for name in ("x", "y")]),
        site=sites,
        matched=matched,
        **{name: values[name][place] for pair in ERROR_OF.items() for name in pair},
    )


def _arranged(entries: Entries) -> tuple[list[tuple[str, str]], IntArray]:
    """Return the images, as pairs of test and name, and the row of each image and contact, (k, n)."""
    texts = entries.texts("image")
    _refuse(
        entries, "image", np.array([text == "" for text in texts]), "is empty; write the name of the image"
    )
    images, numbers = list(zip(entries.texts("test"), texts, strict=True)), entries.whole("contact", 1)
    found: dict[tuple[tuple[str, str], int], int] = {}
    for row, key in enumerate(zip(images, numbers, strict=True)):
        before = found.setdefault(key, row)
        if before != row:
            words = f"= {key[1]} of image {printable(key[0][1], 60)} is in line {_line(entries, before)} too"
            raise InvalidInput(f"{entries.cell(row, 'contact')} {words}; keep one")
    every, ours = list(dict.fromkeys(images)), list(dict.fromkeys(numbers))
    for image, number in product(every, ours):
        words = (
            f"image {printable(image[1], 60)} lacks contact {number}, which others have; add its line, with"
        )
        refuse_if((image, number) not in found, f"{entries.table.name}: {words} the area 0 if it is open")
    return every, np.array([[found[image, number] for number in ours] for image in every])


def _common(entries: Entries, name: str, values: FloatArray, place: IntArray, axis: int) -> FloatArray:
    """Return the values of a column that must be equal for all images (axis 0) or contacts (axis 1)."""
    first = values.take([0], axis)
    differs = (values != first) & ~(np.isnan(values) & np.isnan(first))
    for i, j in np.argwhere(differs)[:1]:
        before = place[0, j] if axis == 0 else place[i, 0]
        text, of = shown(entries.texts(name)[place[i, j]], 40), ("the contact", "the image")[axis]
        words = f"= {text} differs from line {_line(entries, before)}; {of} has one value"
        raise InvalidInput(f"{entries.cell(place[i, j], name)} {words}")
    return np.asarray(first.ravel())


def _refuse(entries: Entries, name: str, wrong: NDArray[np.bool_], must: str) -> None:
    """Raise InvalidInput for the first row for which `wrong`, (rows,), is true."""
    for row in np.flatnonzero(wrong)[:1].tolist():
        raise InvalidInput(f"{entries.cell(row, name)} {must.format(text=entries.texts(name)[row])}")


def _line(entries: Entries, row: int) -> int:
    return entries.table.rows[row][0]


def _cell(value: object) -> str:
    """Return the text of an entry: the shortest form of a number that keeps all bits, or a quoted text."""
    if isinstance(value, float):
        return "" if np.isnan(value) else repr(float(value) + 0.0)  # + 0.0 avoids -0.0
    text = printable(str(value).strip(), MOST)
    # without quotes, a line that begins with # would be a comment
    quoted = any(sign in text for sign in ',"') or text.startswith("#")
    return '"' + text.replace('"', '""') + '"' if quoted else text
