"""What a command prints: lines and tables for a reader, JSON for a program, and progress on a terminal."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from metafem.progress import listening

if TYPE_CHECKING:
    from rich.console import Console

    from metafem.notes import Note

# A table that is printed: column titles, rows and a title.
Printed = tuple[Sequence[str], Sequence[Sequence[str]], str | None]

# Number of characters per line if the output is not a terminal, so that tables are not wrapped.
WIDE = 160

# Units at the end of the names of columns, as the titles of a table show them.
UNITS = {"N_per_mm": "N/mm", "N": "N", "mm": "mm", "mm2": "mm²", "MPa": "MPa"}


def show(
    as_json: bool,
    data: Any,
    *,
    lines: Iterable[str] = (),
    tables: Iterable[Printed] = (),
    notes: Iterable[Note] = (),
    files: Iterable[Path | None] = (),
) -> None:
    """Print the result of a command: its data as JSON, or its lines, tables, notes and written files."""
    if as_json:
        click.echo(json.dumps(data))
        return
    from rich.console import Console

    console = Console(width=None if sys.stdout.isatty() else WIDE, markup=False, highlight=False)
    for line in lines:
        click.echo(line)
    for table in tables:
        print_table(console, *table)
    for note in dict.fromkeys(notes):
        click.secho(f"{'warning' if note.warns else 'note'}: {note}", fg="yellow" if note.warns else None)
    for path in filter(None, files):
        click.echo(f"wrote {path}")


def print_table(
    console: Console, columns: Sequence[str], rows: Sequence[Sequence[str]], title: str | None = None
) -> None:
    """Print a table; headings may wrap between words, but numbers never wrap."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    headed = any(columns)
    style: Any = {"title_justify": "left", "padding": (0, 1, 0, 0), "pad_edge": False, "show_header": headed}
    table = Table(title=title, box=SIMPLE_HEAD if headed else None, **style)
    for heading, *column in zip(columns, *rows, strict=True):
        longest = max(map(len, [*heading.split(), *column]), default=1)
        right = headed and table.columns
        table.add_column(heading, justify="right" if right else "left", min_width=longest)
    for row in rows:
        table.add_row(*row)
    console.print(table, crop=False)


def in_columns(columns: Mapping[str, Sequence[Any]], shown: Iterable[int] | None = None) -> Printed:
    """Return the table of columns whose names end with units, such as ``load_N``, or some of its rows.

    Columns without an entry are left out.

    Examples
    --------
    >>> in_columns({"load_N": [0.1, 0.2], "contacts": [3, 4], "change": [None, "+1 %"]}, [1])
    (['load [N]', 'contacts', 'change'], [['0.2', '4', '+1 %']], None)
    """
    used = {name: values for name, values in columns.items() if {*values} - {None, ""}}
    rows = range(len(next(iter(used.values())))) if shown is None else shown
    return [*map(heading, used)], [[_text(values[i]) for values in used.values()] for i in rows], None


def in_rows(rows: Sequence[Mapping[str, Any]]) -> Printed:
    """Return the table of rows of data with the same names, as `in_columns` does."""
    return in_columns({name: [row[name] for row in rows] for name in rows[0]})


def heading(name: str) -> str:
    """Return the heading of a column."""
    unit = next((unit for unit in UNITS if name.endswith(f"_{unit}")), "")
    words = name.removesuffix(f"_{unit}").replace("_", " ")
    return f"{words} [{UNITS[unit]}]" if unit else words


def _text(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def notes_data(notes: Iterable[Note]) -> list[dict[str, Any]]:
    """Return level, text and numbers of each note, for JSON."""
    return [note.to_json() for note in notes]


@contextmanager
def progress() -> Iterator[None]:
    """Show the running step on a terminal, and print on stderr when kernels are first compiled."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    from metafem._kernels.compiled import on_first_compilation

    console = Console(stderr=True)

    def say(text: str) -> None:
        console.print(text, highlight=False, markup=False, soft_wrap=True)

    on_first_compilation(lambda: say("compiling kernels for this installation …"))
    columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    bar = Progress(*columns, console=console, transient=True)
    task = bar.add_task("starting")

    def on_step(step: str, done: float | None) -> None:
        bar.update(task, description=step if done is None else f"{step}, {100.0 * done:.0f} %")

    with bar if console.is_terminal else nullcontext(), listening(on_step, say):
        yield
