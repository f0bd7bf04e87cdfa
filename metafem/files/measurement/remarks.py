"""Remarks of a table of contacts, in the line of their image and contact."""

from __future__ import annotations

from collections.abc import Mapping

from metafem.calibration import ContactTable

# Separator of the remarks in one line. Remarks on an image are in its first line, those on the table in the
# first line of all.
BETWEEN, OF_IMAGE, OF_TABLE = " | ", "image: ", "table: "


def cells_of_remarks(table: ContactTable) -> dict[tuple[int, int], str]:
    """Return the text of each image and contact that has remarks."""
    places = {
        **{start: (i, 0) for i, start in enumerate(_of_images(table))},
        **{_of_contact(table, i, j): (i, j) for i in range(len(table.image)) for j in range(len(table.site))},
    }
    images = set(_of_images(table))
    cells: dict[tuple[int, int], list[str]] = {}
    for remark in table.remarks:
        start, text = _parted(remark, places)
        kind = OF_TABLE if not start else OF_IMAGE if start in images else ""
        cells.setdefault(places.get(start, (0, 0)), []).append(kind + text)
    return {place: BETWEEN.join(texts) for place, texts in cells.items()}


def remarks_of_cells(table: ContactTable, cells: Mapping[tuple[int, int], str]) -> tuple[str, ...]:
    """Return the remarks in order of images and contacts, with their names."""
    images = _of_images(table)
    remarks = []
    for (i, j), cell in cells.items():
        for text in cell.split(BETWEEN) if cell else ():
            if text.startswith(OF_TABLE):
                remarks.append(text.removeprefix(OF_TABLE))
            elif text.startswith(OF_IMAGE):
                remarks.append(images[i] + text.removeprefix(OF_IMAGE))
            else:
                remarks.append(_of_contact(table, i, j) + text)
    return tuple(remarks)


def _parted(remark: str, starts: Mapping[str, object]) -> tuple[str, str]:
    """Return the part of a remark with image and contact (may be empty), and the other part."""
    at = remark.find(": ")
    while at >= 0:
        if remark[: at + 2] in starts:
            return remark[: at + 2], remark[at + 2 :]
        at = remark.find(": ", at + 1)
    return "", remark


def _of_images(table: ContactTable) -> list[str]:
    return [f"{_label(table, i)}: " for i in range(len(table.image))]


def _of_contact(table: ContactTable, i: int, j: int) -> str:
    what = f"site {table.site[j]}" if table.matched else f"contact {j + 1}"
    return f"{_label(table, i)}, {what}: "


def _label(table: ContactTable, i: int) -> str:
    """Return the name of an image, with its test if two tests have an image of this name."""
    name = table.image[i]
    return name if table.image.count(name) == 1 else f"{name} of test {table.test[i]}"
