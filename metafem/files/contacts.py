"""Writing and reading of contacts.csv, bit for bit; the table has one line for each image and contact."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._given import printable, shown
from metafem._validate import FloatArray
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
    return _Rows(COLUMNS.read(table)).contacts()


class _Rows:
    """The entries of a table, arranged by image and contact."""

    def __init__(self, entries: Entries) -> None:
        self.entries = entries
        names = entries.texts("image")
        if "" in names:
            cell = entries.cell(names.index(""), "image")
            raise InvalidInput(f"{cell} is empty; write the name of the image")
        images = list(zip(entries.texts("test"), names, strict=True))
        numbers = entries.whole("contact", 1)
        found: dict[tuple[tuple[str, str], int], int] = {}
        for index, (image, number) in enumerate(zip(images, numbers, strict=True)):
            before = found.setdefault((image, number), index)
            if before != index:
                raise InvalidInput(
                    f"{entries.cell(index, 'contact')} = {number} of image {printable(image[1], 60)} is in "
                    f"line {self._line(before)} too; keep one"
                )
        self.images, every = list(dict.fromkeys(images)), list(dict.fromkeys(numbers))
        for image, number in product(self.images, every):
            if (image, number) not in found:
                raise InvalidInput(
                    f"{entries.table.name}: image {printable(image[1], 60)} lacks contact {number}, which "
                    "others have; add its line, with the area 0 if it is open"
                )
        # row of the table for each image and contact, (k, n)
        self.place = np.array([[found[image, number] for number in every] for image in self.images])

    def contacts(self) -> ContactTable:
        """Return the contact areas; raise InvalidInput for inconsistent entries."""
        values: dict[str, Any] = {
            name: self.entries.numbers(name, empty=True)[self.place] for name in COLUMNS.units
        }
        for name, error in ERROR_OF.items():
            for column in (name, error):
                self._refuse(values[column] < 0.0, column, "= {text} must not be negative")
            for given, missing in ((error, name), (name, error)):
                alone = np.isnan(values[missing]) & ~np.isnan(values[given])
                if alone.any() and missing not in self.entries.columns:
                    raise COLUMNS.lacking(self.entries, missing)
                title = self.entries.title(given) if alone.any() else given
                self._refuse(alone, missing, f"is empty, and {title} is not; write both or none")
        for name in ("x", "y"):
            self._refuse(np.isnan(values[name]), name, "is empty; write the contact's position")
        of_image: dict[str, Any] = {
            name: self._common(name, values[name], 1) for name in ("load", "friction_force")
        }
        position = np.column_stack([self._common(name, values[name], 0) for name in ("x", "y")])
        sites = self._sites()
        tests, names = zip(*self.images, strict=True)
        return ContactTable(
            image=names,
            test=tests,
            position=position,
            site=np.arange(len(position)) if sites is None else sites,
            matched=sites is not None,
            **of_image,
            **{name: values[name] for pair in ERROR_OF.items() for name in pair},
        )

    def _sites(self) -> NDArray[np.intp] | None:
        """Return the site of each contact, (n,), or None if no contact has a site."""
        if not any(self.entries.texts("site")):
            return None
        whole = np.array(self.entries.whole("site", 0), dtype=float)
        sites = self._common("site", whole[self.place], 0).astype(np.intp)
        _, first = np.unique(sites, return_index=True)
        for j in np.setdiff1d(np.arange(len(sites)), first)[:1]:
            cell = self.entries.cell(self.place[0, j], "site")
            raise InvalidInput(f"{cell} = {sites[j]} is the site of another contact too")
        return sites

    def _common(self, name: str, values: FloatArray, axis: int) -> FloatArray:
        """Return the values of a column that must be equal for all images (axis 0) or contacts (axis 1)."""
        first = values.take([0], axis)
        differs = (values != first) & ~(np.isnan(values) & np.isnan(first))
        before = np.broadcast_to(self.place.take([0], axis), differs.shape)
        for i, j in np.argwhere(differs)[:1]:
            of, line = ("the contact", "the image")[axis], self._line(before[i, j])
            self._refuse(differs, name, f"= {{shown}} differs from line {line}; {of} has one value")
        return np.asarray(first.ravel())

    def _line(self, index: int) -> int:
        return self.entries.table.rows[index][0]

    def _refuse(self, wrong: NDArray[np.bool_], name: str, must: str) -> None:
        """Raise InvalidInput for the first entry of a column for which `wrong`, (k, n), is True."""
        for index in self.place[wrong][:1].tolist():
            text = self.entries.texts(name)[index]
            raise InvalidInput(
                f"{self.entries.cell(index, name)} {must.format(text=text, shown=shown(text, 40))}"
            )


def _cell(value: object) -> str:
    """Return the text of an entry: the shortest form of a number that keeps all bits, or a quoted text."""
    if isinstance(value, float):
        return "" if np.isnan(value) else repr(float(value) + 0.0)  # + 0.0 avoids -0.0
    text = printable(str(value).strip(), MOST)
    # without quotes, a line that begins with # would be a comment
    quoted = any(sign in text for sign in ',"') or text.startswith("#")
    return '"' + text.replace('"', '""') + '"' if quoted else text
