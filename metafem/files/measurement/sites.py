"""Reading of the sites of a design from its table of heights."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput, refuse_if
from metafem.files.tables import Columns, read_table

COLUMNS = Columns("site,x_mm,y_mm", ("x,y",), "site")


def read_sites(path: str | Path) -> tuple[FloatArray, IntArray]:
    """Return the positions [mm], (n, 2), and numbers, (n,), of the sites of a design, seen from above.

    The table has the columns x and y, with their units, and optionally the column site. Without the column
    site, the sites are numbered from 0. The table of a mould is refused because it is mirrored.
    """
    table = read_table(path, COLUMNS.example)
    mould = any(title.startswith("depth_") for title in table.header)
    must = "describes a mould, which is mirrored; give heights.csv of the design"
    refuse_if(mould, f"{table.name} {must}")
    entries = COLUMNS.of(table)
    position = np.column_stack([entries.numbers("x"), entries.numbers("y")])
    if "site" not in entries.columns:
        return position, np.arange(len(position))
    number = entries.whole("site", 0)
    for row, site in enumerate(number):
        if site in number[:row]:
            raise InvalidInput(f"{entries.cell(row, 'site')} = {site} is the number of another site too")
    return position, np.array(number)
