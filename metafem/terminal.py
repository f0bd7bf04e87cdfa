"""Where the command prints, and its tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

# Characters a line where there is no terminal: tables stay whole.
WIDE = 160


def terminal() -> Console:
    """Return the terminal, or a wide one where the text goes elsewhere."""
    from rich.console import Console

    console = Console()
    return console if console.is_terminal else Console(width=max(WIDE, console.width))


def tell_table(
    console: Console, columns: Sequence[str], rows: Sequence[Sequence[str]], title: str | None = None
) -> None:
    """Print a table whose headings may wrap, but never its numbers."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(title=title and escape(title), title_justify="left")
    for i, heading in enumerate(columns):
        longest = max((len(row[i]) for row in rows), default=0)
        table.add_column(
            escape(heading), justify="right" if i else "left", min_width=longest, overflow="fold"
        )
    for row in rows:
        table.add_row(*row)
    console.print(table, crop=False)
