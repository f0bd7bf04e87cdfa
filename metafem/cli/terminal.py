"""The console of the command, its tables and its notes."""

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

# Key of the notes on changed folders in the context of a command.
FOLDERS = "metafem.folders"

# Characters per line if the output is not a terminal, so that tables are not wrapped.
WIDE = 160

# Up to this width columns are one blank apart, otherwise two.
NARROW = 80


def terminal() -> Console:
    """Return the terminal, or a wide console if the output is not a terminal."""
    from rich.console import Console

    console = Console()
    return console if console.is_terminal else Console(width=max(WIDE, console.width))


def print_table(
    console: Console, columns: Sequence[str], rows: Sequence[Sequence[str]], title: str | None = None
) -> None:
    """Print a table. Headings may wrap between words; numbers never wrap."""
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
    """Print lines without changes."""
    for line in lines:
        console.print(line, highlight=False, markup=False, soft_wrap=True)


def print_written(paths: Iterable[Path | None]) -> None:
    """Print the names of the files that were written."""
    say(terminal(), *(f"wrote {path}" for path in paths if path is not None))


def print_study(
    dataset: Dataset, path: Path | None, answers: Iterable[str] = (), features: Sequence[Any] = ()
) -> None:
    """Print the summary of a study with its answers, a second table if there is one, and its file."""
    found, console = mf.studies.summary(dataset), terminal()
    print_table(console, found.columns, found.rows, found.title)
    if features:
        print_table(console, *features)
    print_notes(console, found.notes)
    say(console, *(answers or filter(None, [found.answer])))
    print_written([path])


def notes_data(notes: Iterable[Note]) -> list[dict[str, str]]:
    """Return notes for JSON."""
    return [{"level": note.level.value, "text": note.text} for note in notes]


def loaded(folder: Path) -> Design:
    """Return the design of a result folder; its changes are printed on stderr and stored for JSON."""
    with doing("reading the design"):
        design, notes = mf.files.load_compared(folder)
    for note in notes:
        click.echo(f"warning: {note}", err=True)
    click.get_current_context().meta.setdefault(FOLDERS, []).extend(notes)
    return design


def print_json(data: Mapping[str, Any]) -> None:
    """Print the data of a command, with the notes on changed folders first."""
    notes = notes_data(click.get_current_context().meta.get(FOLDERS, ()))
    click.echo(json.dumps({**data, "notes": [*notes, *data.get("notes", ())]} if notes else data))
