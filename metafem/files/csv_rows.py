"""Tables of numbers as CSV files."""

from __future__ import annotations

import csv
import io
from collections.abc import Collection
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from metafem._given import printable, shown
from metafem.errors import InvalidInput
from metafem.files.reading import TABLE, decoded, file_label, read_bytes
from metafem.files.units import decimal
from metafem.progress import message

SEMICOLONS = "if commas are decimal, separate the columns by semicolons"


@dataclass(frozen=True)
class Table:
    """A table whose first line names its columns.

    Empty lines and lines that begin with ``#`` are skipped. Columns are separated by semicolons or tabs if
    the first line contains one, and commas are then decimal; otherwise by commas.
    """

    name: str
    header: list[str]
    rows: list[tuple[int, list[str]]]
    separator: str
    content: bytes

    def entries(self) -> list[tuple[int, list[str]]]:
        """Return the lines below the first with their numbers, each with an entry for every column."""
        for line, row in self.rows:
            if len(row) != len(self.header):
                hint = f"; {SEMICOLONS}" if self.separator == "," and len(row) > len(self.header) else ""
                raise InvalidInput(
                    f"{self.name}, line {line} has {len(row)} entries; the first names "
                    f"{len(self.header)}{hint}"
                )
        return self.rows

    def report_unread(self, read: Collection[str]) -> None:
        """Report the columns whose titles are not among those that are read."""
        unread = [printable(title, 40) for title in self.header if title not in read]
        if unread:
            what = f"column {unread[0]} is" if len(unread) == 1 else f"columns {', '.join(unread)} are"
            message(f"{self.name}: the {what} not read")

    def number(self, line: int, column: int, text: str) -> Fraction:
        """Return an entry as an exact fraction."""
        try:
            value = decimal(self.plain(text))
            float(value)  # a number that is too large is refused
        except (ValueError, OverflowError):
            hint = f"; {SEMICOLONS}" if "," in text and self.separator == "," else ""
            title = printable(self.header[column], 40)
            raise InvalidInput(
                f"{self.name}, line {line}: {title} = {shown(text, 40)} is not a finite number{hint}"
            ) from None
        return value

    def plain(self, text: str) -> str:
        """Return an entry with a decimal point."""
        return text.strip() if self.separator == "," else text.strip().replace(",", ".")


def read_table(path: str | Path, example: str) -> Table:
    """Read a table, or raise InvalidInput; `example` is a valid first line."""
    return table_of(file_label(path), read_bytes(path, TABLE), example)


def table_of(name: str, content: bytes, example: str) -> Table:
    """Return the table of a file's name, as errors state it, and content, or raise InvalidInput."""
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
    if len(header) < 2:
        raise InvalidInput(
            f"{name} has one column, {printable(''.join(header), 60)}; name its columns, "
            f"for example {example}, separated by commas or semicolons"
        )
    return Table(name, header, rows[1:], separator, content)
