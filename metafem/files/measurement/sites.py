"""Sites of a design from its table of heights."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from metafem._given import printable
from metafem._validate import FloatArray
from metafem.calibration.sites.search import IntArray
from metafem.errors import InvalidInput
from metafem.files.csv_rows import read_table
from metafem.files.units import factor

EXAMPLE = "x_mm,y_mm"


@dataclass(frozen=True)
class Sites:
    """Positions (n, 2) [mm] and numbers (n,) of the sites of a design, seen from above the asperities."""

    position: FloatArray
    number: IntArray


def read_sites(path: str | Path) -> Sites:
    """Return the sites of a table with the columns x and y with their units, and optionally site.

    Without the column site they are numbered from 0. A table of a mould, which is mirrored, is refused.
    """
    table = read_table(path, EXAMPLE)
    if any(title.startswith("depth_") for title in table.header):
        raise InvalidInput(
            f"{table.name} describes a mould, which is mirrored; give heights.csv of the design"
        )
    columns = {}
    for column, title in enumerate(table.header):
        name, _, unit = title.partition("_")
        if name not in ("x", "y"):
            continue
        if name in columns:
            raise InvalidInput(f"{table.name}: {name} is in two columns; keep one")
        try:
            columns[name] = (column, factor(unit, "mm"))
        except InvalidInput as error:
            raise InvalidInput(f"{table.name}: column {printable(title, 40)} {error}") from None
    if len(columns) < 2:
        raise InvalidInput(
            f"{table.name} lacks the columns x_mm and y_mm of the sites (or in another unit); it has "
            f"{printable(', '.join(table.header))}"
        )
    entries = table.entries()
    both = (columns["x"], columns["y"])
    values = [
        [float(table.number(line, column, row[column]) * size) for column, size in both]
        for line, row in entries
    ]
    position = np.array(values, dtype=np.float64).reshape(-1, 2)
    number = np.arange(len(entries))
    if "site" in table.header:
        column = table.header.index("site")
        given = [(line, table.number(line, column, row[column])) for line, row in entries]
        before = set()
        for line, value in given:
            if value.denominator != 1 or value < 0 or value in before:
                raise InvalidInput(
                    f"{table.name}, line {line}: site = {float(value):g} must be a whole number of its own"
                )
            before.add(value)
        number = np.array([int(value) for _, value in given])
    return Sites(position, number)
