"""Columns that are named quantity_unit, such as ``load_mN``, and their numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

import numpy as np

from metafem._given import printable
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.files.csv_rows import Table
from metafem.files.units import factor

# Number of a column and the size of its unit in the package's.
Column = tuple[int, Fraction]


def quantity_columns(
    table: Table, units: Mapping[str, tuple[str, str]], known: Callable[[str], str | None]
) -> dict[str, Column]:
    """Return the columns that are read, by the name of their quantity.

    `units` holds the package's unit of each quantity and a usual one in the name of a column; `known` returns
    the quantity of a name, None if it is not one. A column without a unit, with an unknown one or with one of
    another dimension is refused, and so is a quantity in two columns.
    """
    found: dict[str, Column] = {}
    for column, title in enumerate(table.header):
        alone = known(title)
        if alone is not None:
            raise InvalidInput(
                f"{table.name}: column {printable(title, 40)} needs a unit in its name; write "
                f"{title}_{units[alone][1]}"
            )
        name, _, unit = title.rpartition("_")
        kind = known(name)
        if kind is None:
            continue
        try:
            size = factor(unit, units[kind][0])
        except InvalidInput as error:
            raise InvalidInput(
                f"{table.name}: column {printable(title, 40)} {error}; write {name}_{units[kind][1]}"
            ) from None
        if name in found:
            raise InvalidInput(f"{table.name}: {name} is in two columns; keep one")
        found[name] = (column, size)
    return found


def numbers(table: Table, column: Column, *, empty: bool = False) -> FloatArray:
    """Return the numbers of a column in the package's unit; an empty entry is nan, or refused."""
    index, size = column
    found = []
    for line, row in table.entries():
        if empty and not row[index].strip():
            found.append(np.nan)
        else:
            found.append(float(table.number(line, index, row[index]) * size))
    return np.array(found)
