"""The console of the command, and printing of tables and notes."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.progress import doing

if TYPE_CHECKING:
    from rich.console import Console
    from xarray import Dataset

    from metafem.inversion import Design
    from metafem.notes import Note

# Least number of characters per line if the output is not a terminal, so that tables are not wrapped.
WIDE = 160

# Largest number of characters per line at which columns are separated by one blank; above it by two.
NARROW = 80


def terminal() -> Console:
    """Return the console of the output; it is at least `WIDE` characters wide if this is not a terminal."""
    from rich.console import Console

    console = Console()
    return console if console.is_terminal else Console(width=max(WIDE, console.width))


def print_table(
    console: Console, columns: Sequence[str], rows: Sequence[Sequence[str]], title: str | None = None
) -> None:
    """Print a table; headings may wrap between words, but numbers never wrap."""
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table

    apart = 1 if console.width > NARROW else 0
    table = Table(
        title=title and escape(title),
        title_justify="left",
        box=SIMPLE_HEAD,
        padding=(0, apart, 0, 0),
        pad_edge=False,
    )
    for i, heading in enumerate(columns):
        longest = max(len(text) for text in (*heading.split(), *(row[i] for row in rows)))
        table.add_column(
            escape(heading), justify="right" if i else "left", min_width=longest, overflow="fold"
        )
    for row in rows:
        table.add_row(*(escape(text) for text in row))
    console.print(table, crop=False)


def print_notes(console: Console, notes: Iterable[Note]) -> None:
    """Print notes, one per line; warnings are yellow."""
    for note in notes:
        word, style = ("warning", "yellow") if note.warns else ("note", None)
        console.print(f"{word}: {note}", style=style, highlight=False, markup=False)


def say(console: Console, *lines: str) -> None:
    """Print lines unchanged, without markup, highlighting or wrapping."""
    for line in lines:
        console.print(line, highlight=False, markup=False, soft_wrap=True)


def print_written(paths: Iterable[Path | None]) -> None:
    """Print the names of the files that were written."""
    say(terminal(), *(f"wrote {path}" for path in paths if path is not None))


def print_study(
    dataset: Dataset, path: Path | None, answers: Iterable[str] = (), features: Sequence[Any] = ()
) -> None:
    """Print the summary of a study: its table, a second table if any, notes, answers and the file."""
    found, console = mf.studies.summary(dataset), terminal()
    print_table(console, found.columns, found.rows, found.title)
    if features:
        print_table(console, *features)
    print_notes(console, found.notes)
    say(console, *(answers or filter(None, [found.answer])))
    print_written([path])


def notes_data(notes: Iterable[Note]) -> list[dict[str, Any]]:
    """Return level, text and numbers of each note, for JSON."""
    return [note.to_json() for note in notes]


def loaded(folder: Path) -> Design:
    """Return the design in a result folder."""
    with doing("reading the design"):
        return mf.load(folder)


def print_json(data: Mapping[str, Any]) -> None:
    """Print the data of a command as JSON."""
    click.echo(json.dumps(data))
