"""The printer of results, and output on terminals that lack characters or into full files."""

from __future__ import annotations

import codecs
import errno
import json
import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from rich.console import Console

    from metafem.notes import Note

# A table that is printed: column titles, rows and a title.
Printed = tuple[Sequence[str], Sequence[Sequence[str]], str | None]

# Least number of characters per line if the output is not a terminal, so that tables are not wrapped, and
# largest number at which columns are separated by one blank; above it by two.
WIDE, NARROW = 160, 80

# Replacements of characters that a terminal cannot show; all other such characters become a question mark.
PLAIN = {
    "λ": "lambda",
    "σ": "sigma",
    "ν": "nu",
    "µ": "u",
    "μ": "mu",
    "δ": "delta",
    "π": "pi",
    "²": "^2",
    "³": "^3",
    "°": " deg",
    "·": "*",
    "×": "x",
    "±": "+-",
    "≤": "<=",
    "≥": ">=",
    "–": "-",
    "—": "-",
    "−": "-",
    "…": "...",
    "→": "->",
    "’": "'",
    "“": '"',
    "”": '"',
    "√": "sqrt",
}


def plainly(error: UnicodeError) -> tuple[str, int]:
    """Return the replacement of characters that an encoding lacks, and the position after them.

    This function is an error handler of `codecs`.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(PLAIN.get(c, "?") for c in error.object[error.start : error.end]), error.end


@contextmanager
def printing() -> Iterator[None]:
    """Replace characters that the terminal lacks; exit with a message if the output cannot be written."""
    codecs.register_error("metafem.plainly", plainly)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="metafem.plainly")
    try:
        try:
            yield
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except OSError as error:
        _abandon_output()
        if error.errno == errno.EPIPE:  # the program that reads the output has closed the pipe
            sys.exit(1)
        with suppress(OSError):
            click.echo(f"Error: the output cannot be written: {error.strerror}", err=True)
        sys.exit(1)


def _abandon_output() -> None:
    """Discard the buffered output, because Python would otherwise report an error when it exits."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def show_error(error: click.ClickException, as_json: bool) -> None:
    """Print an error as text on stderr, or as JSON on stdout instead of the data."""
    if as_json:
        kind = getattr(error, "kind", "Usage")
        data = getattr(error, "data", {})
        click.echo(json.dumps({"error": {"type": kind, "message": error.format_message(), **data}}))
    else:
        error.show()


def show(
    as_json: bool,
    data: Any,
    *,
    head: Iterable[str] = (),
    tables: Iterable[Printed] = (),
    lines: Iterable[str] = (),
    notes: Iterable[Note] = (),
    files: Iterable[Path | None] = (),
) -> None:
    """Print the result of a command: its data as JSON, or its lines, tables, notes and written files."""
    if as_json:
        click.echo(json.dumps(data))
        return
    from rich.console import Console

    console = Console()
    if not console.is_terminal:
        console = Console(width=max(WIDE, console.width))
    say(console, *head)
    for table in tables:
        print_table(console, *table)
    say(console, *lines)
    for note in dict.fromkeys(notes):
        word, style = ("warning", "yellow") if note.warns else ("note", None)
        console.print(f"{word}: {note}", style=style, highlight=False, markup=False)
    say(console, *(f"wrote {path}" for path in files if path is not None))


def say(console: Console, *lines: str) -> None:
    """Print lines unchanged, without markup, highlighting or wrapping."""
    for line in lines:
        console.print(line, highlight=False, markup=False, soft_wrap=True)


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
        box=SIMPLE_HEAD if any(columns) else None,
        show_header=any(columns),
        padding=(0, apart, 0, 0),
        pad_edge=False,
    )
    for i, heading in enumerate(columns):
        longest = max((len(text) for text in (*heading.split(), *(row[i] for row in rows))), default=1)
        justify: Any = "right" if i and any(columns) else "left"
        table.add_column(escape(heading), justify=justify, min_width=longest, overflow="fold")
    for row in rows:
        table.add_row(*(escape(text) for text in row))
    console.print(table, crop=False)


def notes_data(notes: Iterable[Note]) -> list[dict[str, Any]]:
    """Return level, text and numbers of each note, for JSON."""
    return [note.to_json() for note in notes]
