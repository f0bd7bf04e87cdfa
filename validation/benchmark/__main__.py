"""Print the allowed and the measured numbers: the table of speeds, or what is named."""

from __future__ import annotations

import inspect
from importlib import import_module
from typing import Any

import click


@click.command()
@click.argument("names", nargs=-1, type=click.Choice(["speeds", "physics", "designs", "last_bits"]))
@click.option("--commit", help="Commit beside whose times those of physics are stated.")
@click.option("--long", is_flag=True, help="Also measure what takes minutes.")
def main(names: tuple[str, ...], **options: Any) -> None:
    """Measure NAMES, by default the table of speeds."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console()
    for name in names or ("speeds",):
        table = Table("quantity", "at most", "measured", "unit", title=name, title_justify="left")
        rows = import_module(f"validation.benchmark.{name}").rows
        given = {key: options[key] for key in inspect.signature(rows).parameters if options[key]}
        for row in rows(**given):
            style = None if row.measured <= row.required else "red"
            cells = (row.what, f"{row.required:g}", f"{row.measured:.3g}", row.unit)
            table.add_row(*map(Text, cells), style=style)
        console.print(table)


if __name__ == "__main__":
    main()
