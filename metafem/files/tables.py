"""Tables in CSV files: columns are declared, and entries are read with their units and line numbers."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from pathlib import Path

import numpy as np

from metafem._given import Names, printable, shown
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if
from metafem.files.reading import TABLE, decoded, file_label, read_bytes
from metafem.files.units import decimal, factor
from metafem.progress import message

# Units in the declared names of columns, with the package's unit of each.
OWN = {"mm": "mm", "um": "mm", "mm2": "mm^2", "N": "N", "mN": "N", "MPa": "MPa"}

SEMICOLONS = "if commas are decimal, separate the columns by semicolons"


# A column title with its unit in brackets, such as "Load [mN]", and further names of quantities in such
# titles.
LABEL = re.compile(r"(.*?)\s*[\[(]\s*([^\s\[\]()]+)\s*[\])]")
ALIASES = {
    "normal_load": "load", "normal_force": "load", "p": "load", "friction": "friction_force",
    "tangential_force": "friction_force", "f": "friction_force", "contact_area": "area", "load_p": "load",
    "friction_force_f": "friction_force",
}  # fmt: skip


# Index of a column, and the size of its unit in the package's unit.
Column = tuple[int, Fraction]


@dataclass(frozen=True)
class Table:
    """A table whose first line names its columns.

    Empty lines and lines that begin with ``#`` are skipped. If the first line contains a semicolon or a tab,
    this sign separates the columns, and a comma is the decimal sign. Otherwise commas separate the columns.
    """

    name: str
    header: list[str]
    rows: list[tuple[int, list[str]]]
    separator: str

    def number(self, line: int, column: int, text: str) -> Fraction:
        """Return an entry as an exact fraction."""
        try:
            value = decimal(self.plain(text))
            float(value)  # raises an error for a number that is too large
        except (ValueError, OverflowError):
            hint = f"; {SEMICOLONS}" if "," in text and self.separator == "," else ""
            title = printable(self.header[column], 40)
            raise InvalidInput(
                f"{self.name}, line {line}: {title} = {shown(text, 40)} is not a finite number{hint}"
            ) from None
        return value

    def plain(self, text: str) -> str:
        """Return an entry whose decimal sign is a point."""
        return text.strip() if self.separator == "," else text.strip().replace(",", ".")


def read_table(path: str | Path, example: str) -> Table:
    """Return the table of a file, or raise InvalidInput; `example` is a valid first line."""
    return table_of(file_label(path), read_bytes(path, TABLE), example)


def table_of(name: str, content: bytes, example: str) -> Table:
    """Return the table in the content of a file, or raise InvalidInput; errors state the file's `name`."""
    text = decoded(name, content)
    lines = ["\n" if line.lstrip().startswith("#") else line for line in io.StringIO(text, newline=None)]
    first = next((line for line in lines if line.strip()), None)
    if first is None:
        raise InvalidInput(f"{name} is empty; its first line must name the columns, for example {example}")
    separator = next((sign for sign in ";\t" if sign in first), ",")
    reader = csv.reader(lines, delimiter=separator)
    try:
        rows = [(reader.line_num, row) for row in reader if any(entry.strip() for entry in row)]
    except csv.Error as error:
        raise InvalidInput(f"{name}, line {reader.line_num}: {error}") from None
    header = [title.strip() for title in rows[0][1]] if rows else []
    words = f"name its columns, for example {example}, separated by commas or semicolons"
    refuse_if(len(header) < 2, f"{name} has one column, {printable(''.join(header), 60)}; {words}")
    for line, row in rows[1:]:
        if len(row) != len(header):
            hint = f"; {SEMICOLONS}" if separator == "," and len(row) > len(header) else ""
            words = f"has {len(row)} entries; the first names {len(header)}{hint}"
            raise InvalidInput(f"{name}, line {line} {words}")
    return Table(name, header, rows[1:], separator)


@dataclass(frozen=True)
class Columns:
    """The columns of a kind of table.

    `titles` lists the columns, separated by commas. A quantity is written as quantity_unit, with the unit
    that errors propose; a text or a number without unit has only a name. `needed` holds lists of names
    separated by commas: all columns of one list must be present. The column NAME_sd of a standard deviation
    is allowed only with the column NAME. `entry` describes a line for errors, and `wanted` the required first
    line. `declared` returns the name in `titles` for the name in a table, for example "area" for "area_1".
    """

    titles: str
    needed: tuple[str, ...]
    entry: str
    wanted: str = ""
    declared: Callable[[str], str] = str

    @cached_property
    def units(self) -> Mapping[str, str]:
        """The unit of each quantity, as errors propose it."""
        parts = (title.rpartition("_") for title in self.titles.split(","))
        return {name: unit for name, _, unit in parts if unit in OWN}

    @cached_property
    def plain(self) -> frozenset[str]:
        """The names of the columns without a unit."""
        titles = self.titles.split(",")
        return frozenset(title for title in titles if title.rpartition("_")[2] not in OWN)

    @property
    def example(self) -> str:
        """A valid first line of the table."""
        return ",".join(map(self.title, self.needed[0].split(",")))

    def read(self, path: str | Path) -> Entries:
        """Return the entries of a file, or raise InvalidInput."""
        return self.of(read_table(path, self.example))

    def of(self, table: Table) -> Entries:
        """Return the entries of a table, and print which columns are not read."""
        found: dict[str, Column] = {}
        for index, title in enumerate(table.header):
            column = self._column(table, title)
            if column is None:
                continue
            name, size = column
            refuse_if(name in found, f"{table.name}: {name} is in two columns; keep one")
            found[name] = index, size
        entries = Entries(table, found)
        lacking = [[name for name in names.split(",") if name not in found] for names in self.needed]
        if self.needed and all(lacking):
            raise self.lacking(entries, *(lacking[0] if len(lacking) == 1 else ()))
        for name in found:
            base = name.removesuffix("_sd")
            words = f"without {base}; add its column or leave this one out"
            refuse_if(base not in found, f"{table.name} has the column {entries.title(name)} {words}")
        unread = [printable(title, 40) for title in entries.unread]
        if unread:
            what = f"column {unread[0]} is" if len(unread) == 1 else f"columns {', '.join(unread)} are"
            message(f"{table.name}: the {what} not read")
        refuse_if(not table.rows, f"{table.name} names columns but holds no {self.entry}")
        return entries

    def lacking(self, entries: Entries, *names: str, hint: str = "") -> InvalidInput:
        """Return the error for a table that lacks the required columns `names`."""
        lacks = f"lacks {', '.join(map(self.title, names))}: it " if names else ""
        header = printable(", ".join(entries.table.header), 120)
        wanted = self.wanted or f"{self.example} (or in other units)"
        return InvalidInput(
            f"{entries.table.name} {lacks}has the columns {header}; name its columns {wanted}{hint}"
        )

    def title(self, name: str) -> str:
        """Return the title of a column: its name with the unit that errors propose, if it has one."""
        kind = self.declared(name)
        return f"{name}_{self.units[kind]}" if kind in self.units else name

    def _column(self, table: Table, title: str) -> tuple[str, Fraction] | None:
        """Return a column's name and the size of its unit in the package's unit; None if it is not read."""
        if title in self.plain:
            return title, Fraction(1)
        if label := LABEL.fullmatch(title):
            name = re.sub(r"\W+", "_", label[1].lower())
            name = name if self.declared(name) in self.units else ALIASES.get(name, name)
            title = f"{name}_{label[2]}" if self.declared(name) in self.units else title
        column = f"{table.name}: column {printable(title, 40)}"
        known = self.declared(title) in self.units
        refuse_if(known, f"{column} needs a unit in its name; write {self.title(title)}")
        name, _, unit = title.rpartition("_")
        if self.declared(name) not in self.units:
            return None
        try:
            return name, factor(unit, OWN[self.units[self.declared(name)]])
        except InvalidInput as error:
            raise InvalidInput(f"{column} {error}; write {self.title(name)}") from None


@dataclass(frozen=True)
class Entries:
    """The entries of a table, by column name and row; rows are counted from 0."""

    table: Table
    columns: Mapping[str, Column] = field(default_factory=dict)

    @property
    def unread(self) -> list[str]:
        """The titles of the columns that are not read."""
        read = {index for index, _ in self.columns.values()}
        return [title for index, title in enumerate(self.table.header) if index not in read]

    def title(self, name: str) -> str:
        """Return the title of a column in the table."""
        return self.table.header[self.columns[name][0]]

    def places(self) -> list[str]:
        """Return the location of each row: the name of the file and the number of the line."""
        return [f"{self.table.name}, line {line}" for line, _ in self.table.rows]

    def cell(self, row: int, name: str) -> str:
        """Return the location of an entry: file, line and title of the column."""
        return f"{self.places()[row]}: {self.title(name)}"

    def texts(self, name: str) -> list[str]:
        """Return the entries of a column; if the table lacks the column, the entries are empty."""
        if name not in self.columns:
            return [""] * len(self.table.rows)
        return [row[self.columns[name][0]].strip() for _, row in self.table.rows]

    def numbers(self, name: str, *, empty: bool = False) -> FloatArray:
        """Return the numbers of a column in the package's unit, (k,).

        With `empty`, empty entries and a missing column become nan; otherwise they are refused.
        """
        texts = self.texts(name)
        if empty and name not in self.columns:
            return np.full(len(texts), np.nan)
        index, size = self.columns[name]
        return np.array(
            [
                np.nan if empty and not text else float(self.table.number(line, index, text) * size)
                for (line, _), text in zip(self.table.rows, texts, strict=True)
            ]
        )

    def whole(self, name: str, least: int) -> list[int]:
        """Return the entries of a column, which must be whole numbers of at least `least`."""
        found = self.texts(name)
        for row, text in enumerate(found):
            if not re.fullmatch(r"\d{1,9}", text, re.ASCII) or int(text) < least:
                words = f"{shown(text, 40)} must be a whole number of at least {least}"
                raise InvalidInput(f"{self.cell(row, name)} = {words}")
        return [int(text) for text in found]

    def names(self, **names: str) -> Names:
        """Return how errors name columns, units and rows; `names` adds the names of other arguments."""
        return Names(
            {**{name: self.title(name) for name in self.columns}, **names},
            {name: ("", float(size)) for name, (_, size) in self.columns.items()},
            self.places(),
        )
