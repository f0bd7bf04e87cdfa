"""Tables in text files: the header is found, and entries are read with their units and line numbers.

A title is ``name_unit`` or ``name [unit]``, or units stand in the line below the names. Python's csv splits
the lines, because errors state the lines of entries, which pandas does not keep.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from metafem._validate import UNITS as QUANTITIES
from metafem._validate import FloatArray, unit_of
from metafem.errors import InvalidInput, printable, refuse_if, shown
from metafem.files.disk import TABLE, file_label, read_bytes, text_of_table
from metafem.files.units import NUMBER, UNITS, factor, plain_unit
from metafem.progress import message

TEXTS = {"image", "sheared_image", "test", "contact", "site", "cap", "weight", "relative_error"}

# Names of quantities in titles of other programs.
ALIASES = {
    "normal_load": "load", "normal_force": "load", "p": "load", "load_p": "load",
    "friction": "friction_force", "tangential_force": "friction_force", "friction_force_f": "friction_force",
    "contact_area": "area", "f": "friction_force",
}  # fmt: skip

# A title with its unit in brackets, such as "Load [mN]".
LABEL = re.compile(r"(.*?)\s*[\[(]\s*([^\[\]()]*?)\s*[\])]")

# A number with a decimal sign that could be a sign of thousands.
GROUP = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}", re.ASCII)

# Largest number of lines in which a header is sought, and columns of a line that make it one.
PREAMBLE, ENOUGH = 200, 2

NONE: Mapping[str, str] = {}

# Signs around the units in the line below the names.
BRACKETS = " ()[]"


def base_of(name: str) -> str:
    """Return the quantity that a column holds: "area" for "area_sd"."""
    return name.removesuffix("_sd")


def named(title: str) -> tuple[str, str]:
    """Return the name and the unit of a title; the unit is "" if there is none.

    Examples
    --------
    >>> named("Normal force (mN)"), named("load_sd_mN"), named("test")
    (('load', 'mN'), ('load_sd', 'mN'), ('test', ''))
    """
    words, unit = _split(title)
    name = re.sub(r"\W+", "_", words.strip().lower())
    # F in newtons is a friction force, and f in millimetres is the profile of a cap
    if unit and name in ALIASES and plain_unit(unit) not in UNITS[unit_of(name)]:
        return ALIASES[name], unit
    if base_of(name) in QUANTITIES:
        return name, unit
    name, _, unit = title.rpartition("_")
    return (name, unit) if base_of(name) in QUANTITIES else (title, "")


def known(title: str) -> bool:
    """Return whether a title is that of a column of one of the package's own tables."""
    return base_of(named(title)[0]) in QUANTITIES or title in TEXTS


def _split(title: str) -> tuple[str, str]:
    """Return a title without its unit in brackets, and this unit."""
    label = LABEL.fullmatch(title)
    return (label[1], label[2]) if label else (title, "")


@dataclass(frozen=True)
class Table:
    """A table: its name in errors, its titles with the name and unit of each, and its lines by number.

    `columns` holds the index of each column that is read, and the size of its unit.
    """

    name: str
    header: list[str]
    quantities: list[tuple[str, str]]
    rows: list[tuple[int, list[str]]]
    separator: str
    columns: Mapping[str, tuple[int, Fraction]] = field(default_factory=dict)

    @property
    def unread(self) -> list[str]:
        """The titles of the columns that are not read."""
        read = {index for index, _ in self.columns.values()}
        return [title for index, title in enumerate(self.header) if index not in read]

    def title(self, name: str) -> str:
        """Return the title of a column in the table."""
        return self.header[self.columns[name][0]] if name in self.columns else name

    def place(self, row: int) -> str:
        """Return the location of a row: the name of the file and the number of the line."""
        return f"{self.name}, line {self.rows[row][0]}"

    def refuse(self, name: str, wrong: Any, must: str) -> None:
        """Raise InvalidInput for the first row of a column for which `wrong`, (k,), is true."""
        for row in np.flatnonzero(wrong)[:1].tolist():
            found = shown(self.texts(name)[row], 40)
            raise InvalidInput(f"{self.place(row)}: {self.title(name)} = {found} {must}")

    def texts(self, name: str) -> list[str]:
        """Return the entries of a column; if the table lacks the column, the entries are empty."""
        if name not in self.columns:
            return [""] * len(self.rows)
        return [row[self.columns[name][0]].strip() for _, row in self.rows]

    def numbers(self, name: str, *, empty: bool = False) -> FloatArray:
        """Return the numbers of a column in the package's unit, (k,).

        With `empty`, empty entries and a missing column become nan; otherwise they are refused.
        """
        texts = [text.replace(self._decimal_sign, ".") for text in self.texts(name)]
        known = [re.fullmatch(NUMBER, text) is not None for text in texts]
        wrong = [not number and bool(text or not empty) for number, text in zip(known, texts, strict=True)]
        self.refuse(name, wrong, "is not a finite number")
        found = np.full(len(texts), np.nan)
        found[known] = [Fraction(text) * self.columns[name][1] for text in np.array(texts)[known].tolist()]
        return found

    def whole(self, name: str, least: int) -> list[int]:
        """Return the entries of a column, which must be whole numbers of at least `least`."""
        found = self.texts(name)
        wrong = [not re.fullmatch(r"\d{1,9}", text, re.ASCII) or int(text) < least for text in found]
        self.refuse(name, wrong, f"must be a whole number of at least {least}")
        return [int(text) for text in found]

    @contextmanager
    def located(self) -> Iterator[None]:
        """Make errors of array arguments in the body, such as ``load[3]``, name the entry of this table."""
        try:
            yield
        except InvalidInput as error:
            entry = re.match(r"(\w+)\[(\d+)", error.key)
            if entry and entry[1] in self.columns and int(entry[2]) < len(self.rows):
                row, found = int(entry[2]), error.at(self.title(entry[1]))
                found.value = self.texts(entry[1])[row]
                raise InvalidInput(f"{self.place(row)}: {found}") from None
            if error.key:  # another argument than a column
                raise
            raise InvalidInput(f"{self.name}: {error}") from None

    @cached_property
    def _decimal_sign(self) -> str:
        """The decimal sign of all numbers; two signs, or one that could mean thousands, are refused."""
        entries = [
            (f"line {line}: {self.title(name)} = {shown(text, 40)}", text)
            for name in self.columns
            if base_of(name) in QUANTITIES
            for (line, _), text in zip(self.rows, self.texts(name), strict=True)
        ]
        signs = {sign: [entry for entry in entries if sign in entry[1]] for sign in ".,"}
        signs = {sign: having for sign, having in signs.items() if having}
        cells = " and ".join(having[0][0] for having in signs.values())
        words = "have different decimal signs; write all numbers with the same one, and without thousands"
        refuse_if(len(signs) > 1, f"{self.name}, {cells} {words}")
        for sign, having in signs.items():
            sure = sign != self.separator == "," or not all(GROUP.fullmatch(text) for _, text in having)
            words = (
                f"can be read as {having[0][1].replace(sign, '')}, too; write a fourth decimal, or no sign"
            )
            refuse_if(not sure, f"{self.name}, {cells} {words} of thousands")
        return next(iter(signs), ".")


def is_of_contacts(table: Table) -> bool:
    """Return whether the columns of a table are those of contacts in images."""
    return {("image", ""), ("contact", "")} <= set(table.quantities)


def read_table(path: str | Path | Table, columns: Mapping[str, str] = NONE, *, every: bool = True) -> Table:
    """Return the table of a file.

    Parameters
    ----------
    path : str, Path or Table
        A text file, or a table that was read before.
    columns : mapping of str to str
        Titles in the file by the names that they stand for, such as ``{"load": "Kraft [N]"}``, or with a unit
        that the file does not state, ``{"load_N": "Kraft"}``.
    every : bool
        Whether the table must have all of these titles; default: True.

    Returns
    -------
    Table

    Raises
    ------
    InvalidInput
        If the file cannot be read, or has fewer than two columns or lines of different lengths.
    """
    if isinstance(path, Table):
        return path
    return table_of(file_label(path), read_bytes(path, TABLE), columns, every)


def table_of(name: str, content: bytes, columns: Mapping[str, str] = NONE, every: bool = True) -> Table:
    """Return the table in the content of a file; errors state the file's `name`."""
    text = text_of_table(name, content)
    lines = ["\n" if line.lstrip().startswith("#") else line for line in io.StringIO(text, newline=None)]
    stated = ""
    if lines and (sign := re.fullmatch(r'"?sep=(.)"?\s*', lines[0])):  # which Excel writes and reads
        stated, lines[0] = sign[1], "\n"
    first, separator = _header(lines, stated, {*columns.values()})
    reader = csv.reader(lines[first:], delimiter=separator)
    try:
        rows = [(first + reader.line_num, row) for row in reader if any(entry.strip() for entry in row)]
    except csv.Error as error:
        raise InvalidInput(f"{name}, line {first + reader.line_num}: {error}") from None
    refuse_if(not rows, f"{name} is empty; a line must name the columns, for example load_mN,area_mm2")
    header = [title.strip() for title in rows.pop(0)[1]]
    while header and not header[-1]:  # separators at the end of the lines
        header.pop()
    width = len(header)
    words = "name its columns, for example load_mN,area_mm2, separated by commas, semicolons or tabs"
    refuse_if(width < ENOUGH, f"{name} has one column, {printable(''.join(header), 60)}; {words}")
    rows = [(line, row if any(row[width:]) else row[:width]) for line, row in rows]
    for line, row in rows:
        decimal = separator == "," and len(row) > width
        hint = "; if commas are decimal, separate the columns by semicolons" if decimal else ""
        words = f"{name}, line {line} has {len(row)} entries; the header names {width}{hint}"
        refuse_if(len(row) != width, words)
    if rows and _is_of_units(rows[0][1]):
        pairs = zip(header, rows.pop(0)[1], strict=True)
        header = [
            title if "[" in title or not unit else f"{title} [{unit.strip(BRACKETS)}]"
            for title, unit in pairs
        ]
    quantities = [*map(named, header)]
    for wanted, title in columns.items():
        places = [i for i, each in enumerate(header) if title in (each, _split(each)[0])]
        if places or every:
            has = f"{name} has the columns {printable(', '.join(header), 120)}"
            refuse_if(len(places) != 1, f"{has}; --column {wanted}={shown(title, 40)} must name one of them")
            quantity, unit = named(wanted)
            words = f"--column {shown(wanted, 40)} is not the name of a column, such as load or area_sheared"
            refuse_if(base_of(quantity) not in QUANTITIES and wanted not in TEXTS, words)
            quantities[places[0]] = quantity, unit or _split(header[places[0]])[1]
    return Table(name, header, quantities, rows, separator)


def _header(lines: list[str], stated: str, own: set[str]) -> tuple[int, str]:
    """Return the index of the line that names the columns, and the sign that separates them."""
    best = -1, 0, stated or ","
    for i, line in enumerate(lines[:PREAMBLE]):
        separator = stated or next((sign for sign in ";\t" if sign in line), ",")
        titles = [title.strip(' "\n') for title in line.split(separator)]
        count = sum(map(known, titles))
        count += ENOUGH * sum(bool(own & {title, _split(title)[0]}) for title in titles)
        if line.strip():
            best = max(best, (min(count, ENOUGH), -i, separator))
    return -best[1], best[2]


def _is_of_units(entries: list[str]) -> bool:
    """Return whether a line holds the units of the names above it: at least one, and no number."""
    units = {plain for names in UNITS.values() for plain in names if plain}
    return any(plain_unit(entry.strip(BRACKETS)) in units for entry in entries) and not any(
        re.fullmatch(NUMBER, entry.strip().replace(",", ".")) for entry in entries
    )


@dataclass(frozen=True)
class Columns:
    """The columns of a kind of table.

    `titles` lists the columns as errors propose them, separated by commas. `needed` holds lists of names
    separated by commas: all columns of one list must be present. The column NAME_sd of a standard deviation
    is allowed only with the column NAME. `entry` describes a line for errors, and `wanted` the titles.
    """

    titles: str
    needed: tuple[str, ...]
    entry: str
    wanted: str = ""

    @cached_property
    def units(self) -> Mapping[str, str]:
        """The unit of each quantity, as errors propose it."""
        return {name: unit for name, unit in map(named, self.titles.split(",")) if unit}

    @cached_property
    def plain(self) -> frozenset[str]:
        """The names of the columns without a unit."""
        return frozenset(title for title in self.titles.split(",") if not named(title)[1])

    def read(self, source: str | Path | Table) -> Table:
        """Return the entries of a file or table, and report which columns of unknown names are not read."""
        table, found = read_table(source), dict[str, tuple[int, Fraction]]()
        for index, (name, unit) in enumerate(table.quantities):
            if name in self.plain or name in self.units:
                refuse_if(name in found, f"{table.name}: {name} is in two columns; keep one")
                found[name] = index, self._size(table, index, name, unit)
        table = replace(table, columns=found)
        lacking = [[name for name in names.split(",") if name not in found] for names in self.needed]
        if self.needed and all(lacking):
            raise self.lacking(table, *(lacking[0] if len(lacking) == 1 else ()))
        for name in found:
            of = name.removesuffix("_sd")
            words = f"without {of}; add its column or leave this one out"
            refuse_if(of not in found, f"{table.name} has the column {table.title(name)} {words}")
        if unread := [printable(title, 40) for title in table.unread if not known(title)]:
            what = f"column {unread[0]} is" if len(unread) == 1 else f"columns {', '.join(unread)} are"
            message(f"{table.name}: the {what} not read")
        refuse_if(not table.rows, f"{table.name} names columns but holds no {self.entry}")
        return table

    def lacking(self, table: Table, *names: str, hint: str = "") -> InvalidInput:
        """Return the error for a table that lacks the columns `names`."""
        unread = table.unread or table.header
        lacks = f"lacks {', '.join(map(self.title, names))}: it " if names else ""
        has = f"{table.name} {lacks}has the columns {printable(', '.join(table.header), 120)}"
        wanted = self.wanted or f"{','.join(map(self.title, self.needed[0].split(',')))} (or in other units)"
        option = f'--column {(*names, "load")[0]}="{printable(unread[0], 40)}"'
        words = f"name its columns {wanted}, or say which they are, such as {option}{hint}"
        return InvalidInput(f"{has}; {words}")

    def title(self, name: str) -> str:
        """Return the title of a column: its name with the unit that errors propose, if it has one."""
        unit = self.units.get(name) or self.units.get(base_of(name), "")
        return f"{name}_{unit}" if unit else name

    def _size(self, table: Table, index: int, name: str, unit: str) -> Fraction:
        """Return the size of a column's unit in the package's unit; 1 for a column without a unit."""
        if name in self.plain:
            return Fraction(1)
        column, write = f"{table.name}: column {printable(table.header[index], 40)}", self.title(name)
        refuse_if(not unit, f"{column} needs a unit in its name; write {write}")
        try:
            return factor(unit, unit_of(base_of(name)))
        except InvalidInput as error:
            raise InvalidInput(f"{column} {error}; write {write}") from None
