"""Run the benchmarks and print the required and the measured numbers."""

from __future__ import annotations

from functools import partial

import click

from validation.discovery import Listed, chosen, groups, module

# Functions of a benchmark; "long_rows" takes more than three minutes.
KINDS = ("rows", "long_rows")


@click.command(cls=Listed, listed=partial(groups, *KINDS))
@click.option("--long", is_flag=True, help="Also measure what takes more than three minutes.")
@click.argument("names", nargs=-1)
def main(long: bool, names: tuple[str, ...]) -> None:
    """Measure the benchmarks NAMES, or all."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console()
    for name in chosen(names, *KINDS):
        benchmark = module(name, *KINDS)
        table = Table("quantity", "required at most", "measured", "unit", title=name, title_justify="left")
        for kind in KINDS if long else KINDS[:1]:
            for row in getattr(benchmark, kind, list)():
                style = None if row.measured <= row.required else "red"
                cells = (row.what, f"{row.required:g}", f"{row.measured:.3g}", row.unit)
                table.add_row(*map(Text, cells), style=style)
        console.print(table)
        if not long and hasattr(benchmark, KINDS[1]):
            console.print(f"{name}: more with --long")


if __name__ == "__main__":
    main()
