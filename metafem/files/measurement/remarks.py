"""Remarks of a table of contacts; each is written in the line of its image and contact."""

from __future__ import annotations

from collections.abc import Mapping

from metafem.calibration import ContactTable

# Separator of several remarks in one line, and prefixes of remarks on an image and on the table. A remark on
# an image is written in the first line of the image, and a remark on the table in the table's first line.
BETWEEN, OF_IMAGE, OF_TABLE = " | ", "image: ", "table: "


def cells_of_remarks(table: ContactTable) -> dict[tuple[int, int], str]:
    """Return the texts of the remarks by the indices (i, j) of image and contact."""
    k, n = table.area.shape
    places = {
        **{_label(table, i): (i, 0, OF_IMAGE) for i in range(k)},
        **{_label(table, i, j): (i, j, "") for i in range(k) for j in range(n)},
    }
    cells: dict[tuple[int, int], list[str]] = {}
    for remark in table.remarks:
        parts = remark.split(": ")
        starts = (": ".join(parts[:count]) + ": " for count in range(1, len(parts)))
        start = next((each for each in starts if each in places), "")
        i, j, kind = places.get(start, (0, 0, OF_TABLE))
        cells.setdefault((i, j), []).append(kind + remark[len(start) :])
    return {place: BETWEEN.join(texts) for place, texts in cells.items()}


def remarks_of_cells(table: ContactTable, cells: Mapping[tuple[int, int], str]) -> tuple[str, ...]:
    """Return the remarks in order of images and contacts; each begins with its image and contact, if any."""
    remarks = []
    for (i, j), cell in cells.items():
        for text in cell.split(BETWEEN) if cell else ():
            if text.startswith(OF_TABLE):
                remarks.append(text.removeprefix(OF_TABLE))
            elif text.startswith(OF_IMAGE):
                remarks.append(_label(table, i) + text.removeprefix(OF_IMAGE))
            else:
                remarks.append(_label(table, i, j) + text)
    return tuple(remarks)


def _label(table: ContactTable, i: int, contact: int | None = None) -> str:
    """Return the beginning of a remark: the name of its image and, if any, of its contact.

    If several images have the same name, the test is named too.
    """
    name = table.image[i]
    name = name if table.image.count(name) == 1 else f"{name} of test {table.test[i]}"
    return f"{name}: " if contact is None else f"{name}, {table.name_of(contact)}: "
