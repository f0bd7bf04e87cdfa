"""The table contacts.csv: one line for each image and contact, written and read bit for bit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from metafem._given import printable, shown
from metafem._validate import FloatArray
from metafem.calibration import ContactTable
from metafem.errors import InvalidInput
from metafem.files.measurement.remarks import cells_of_remarks, remarks_of_cells
from metafem.files.tables import Columns, Entries, Table, read_table

HEADER = (
    "image,test,load_N,friction_force_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2,"
    "sheared_area_mm2,sheared_area_error_mm2,remark"
)

COLUMNS = Columns(HEADER, ("image,load,contact,x,y,area,area_error",), "contact")

# Largest number of characters of a text.
MOST = 10**4

# Columns of areas, and those of their errors.
ERROR_OF = {"area": "area_error", "sheared_area": "sheared_area_error"}


def contacts_table(table: ContactTable) -> str:
    """Return contact areas as CSV, one line for each image and contact; empty where not measured."""
    images = list(zip(table.test, table.image, strict=True))
    twice = next((image for i, image in enumerate(images) if image in images[:i]), None)
    if twice is not None:
        raise InvalidInput(
            f"image {printable(twice[1])} of test {printable(twice[0])!r} is in the table twice"
        )
    remarks = cells_of_remarks(table)
    lines = [HEADER]
    for i, (test, image) in enumerate(images):
        for j, site in enumerate(table.site.tolist()):
            numbers = (table.area, table.area_error, table.sheared_area, table.sheared_area_error)
            row = (
                *(image, test, table.load[i], table.friction_force[i], j + 1),
                *(site if table.matched else "", *table.position[j]),
                *(values[i, j] for values in numbers),
                remarks.get((i, j), ""),
            )
            lines.append(",".join(map(_cell, row)))
    return "\n".join(lines) + "\n"


def read_contacts(path: str | Path) -> ContactTable:
    """Return the contact areas of a table that `contacts_table` wrote, or of one with the same columns.

    Each image has the same contacts. The columns of the test, of the friction force, of the sites, of the
    sheared areas and of the remarks may be absent, and lengths, areas and forces may be in other units.
    """
    return contacts_of(read_table(path, HEADER))


def is_of_contacts(table: Table) -> bool:
    """Whether a table is one of the contacts in images, by its columns."""
    return {"image", "contact"} <= set(table.header)


def contacts_of(table: Table) -> ContactTable:
    """Return the contact areas of a table whose columns are those of `read_contacts`."""
    return _Rows(COLUMNS.of(table)).contacts()


class _Rows:
    """The entries of a table, in order of images and contacts."""

    def __init__(self, entries: Entries) -> None:
        self.entries = entries
        images = list(zip(entries.texts("test"), entries.texts("image"), strict=True))
        numbers = entries.whole("contact", 1)
        self.images = list(dict.fromkeys(images))
        self.numbers = list(dict.fromkeys(numbers))
        self.place = self._places(images, numbers)

    def contacts(self) -> ContactTable:
        """Return the table."""
        values = {name: self.entries.numbers(name, empty=True)[self.place] for name in COLUMNS.units}
        for name in ERROR_OF:
            self._refuse_areas(name, values[name], values[ERROR_OF[name]])
        sites = self._sites()
        x, y = (self._of_contact(name, values[name]) for name in ("x", "y"))
        tests, names = zip(*self.images, strict=True)
        found = ContactTable(
            image=names,
            test=tests,
            load=self._of_image("load", values["load"]),
            friction_force=self._of_image("friction_force", values["friction_force"]),
            position=np.column_stack([x, y]),
            site=np.arange(len(self.numbers)) if sites is None else sites,
            matched=sites is not None,
            area=values["area"],
            area_error=values["area_error"],
            sheared_area=values["sheared_area"],
            sheared_area_error=values["sheared_area_error"],
        )
        return replace(found, remarks=remarks_of_cells(found, self._remarks()))

    def _places(self, images: list[tuple[str, str]], numbers: list[int]) -> np.ndarray:
        """Return the index of the entry of each image and contact, (k, n)."""
        row = {image: i for i, image in enumerate(self.images)}
        column = {number: j for j, number in enumerate(self.numbers)}
        place = np.full((len(row), len(column)), -1)
        for index, (image, number) in enumerate(zip(images, numbers, strict=True)):
            if not image[1]:
                raise InvalidInput(
                    f"{self.entries.cell(index, 'image')} is empty; write the name of the image"
                )
            i, j = row[image], column[number]
            if place[i, j] >= 0:
                before = self._line(place[i, j])
                raise InvalidInput(
                    f"{self.entries.cell(index, 'contact')} = {number} of image {printable(image[1], 60)} "
                    f"is in line {before} too; keep one"
                )
            place[i, j] = index
        for i, j in np.argwhere(place < 0)[:1]:
            raise InvalidInput(
                f"{self.entries.table.name}: image {printable(self.images[i][1], 60)} lacks contact "
                f"{self.numbers[j]}, which others have; add its line, with the area 0 if it is open"
            )
        return place

    def _line(self, index: int) -> int:
        return self.entries.table.rows[index][0]

    def _text(self, index: int, name: str) -> str:
        return self.entries.texts(name)[index]

    def _of_image(self, name: str, values: FloatArray) -> FloatArray:
        """Return the values of a column that is the same for all contacts of an image, (k,)."""
        return self._alike(name, values, "the image")[:, 0].copy()

    def _of_contact(self, name: str, values: FloatArray) -> FloatArray:
        """Return the values of a column that is the same for a contact in all images, (n,)."""
        for i, j in np.argwhere(np.isnan(values))[:1]:
            raise InvalidInput(
                f"{self.entries.cell(self.place[i, j], name)} is empty; write the contact's position"
            )
        return self._alike(name, values.T, "the contact", self.place.T)[:, 0].copy()

    def _alike(self, name: str, values: FloatArray, of: str, place: np.ndarray | None = None) -> FloatArray:
        place = self.place if place is None else place
        first = values[:, :1]
        differs = (values != first) & ~(np.isnan(values) & np.isnan(first))
        for i, j in np.argwhere(differs)[:1]:
            text = self._text(place[i, j], name)
            raise InvalidInput(
                f"{self.entries.cell(place[i, j], name)} = {shown(text, 40)} differs from line "
                f"{self._line(place[i, 0])}; {of} has one value"
            )
        return values

    def _refuse_areas(self, name: str, area: FloatArray, error: FloatArray) -> None:
        """Refuse negative areas and errors, and an area without its error."""
        for column, values in ((name, area), (ERROR_OF[name], error)):
            for i, j in np.argwhere(values < 0.0)[:1]:
                text = self._text(self.place[i, j], column)
                raise InvalidInput(
                    f"{self.entries.cell(self.place[i, j], column)} = {text} must not be negative"
                )
        for i, j in np.argwhere(np.isnan(area) != np.isnan(error))[:1]:
            given, missing = (ERROR_OF[name], name) if np.isnan(area[i, j]) else (name, ERROR_OF[name])
            if missing not in self.entries.columns:
                raise COLUMNS.lacking(self.entries, missing)
            cell, title = self.entries.cell(self.place[i, j], missing), self.entries.title(given)
            raise InvalidInput(f"{cell} is empty, and {title} is not; write both or none")

    def _sites(self) -> np.ndarray | None:
        """Return the site of each contact, (n,), or None if no contact has one."""
        if not any(self.entries.texts("site")):
            return None
        whole = np.array(self.entries.whole("site", 0), dtype=float)
        sites = self._alike("site", whole[self.place].T, "the contact", self.place.T)
        found = sites[:, 0].astype(np.intp)
        for j in range(len(found)):
            if found[j] in found[:j]:
                cell = self.entries.cell(self.place[0, j], "site")
                raise InvalidInput(f"{cell} = {found[j]} is the site of another contact too")
        return found

    def _remarks(self) -> dict[tuple[int, int], str]:
        """Return the remarks of each image and contact."""
        remarks = self.entries.texts("remark")
        return {(i, j): remarks[index] for (i, j), index in np.ndenumerate(self.place)}


def _cell(value: object) -> str:
    """Return an entry: numbers in the shortest form that is read bit for bit, texts quoted if needed."""
    if isinstance(value, float):
        return "" if np.isnan(value) else repr(float(value) + 0.0)  # no -0.0
    text = printable(str(value).strip(), MOST)
    # a line that begins with # is a comment
    quoted = any(sign in text for sign in ',"') or text.startswith("#")
    return '"' + text.replace('"', '""') + '"' if quoted else text
