"""Run the benchmarks and print what was wanted and what was measured."""

from __future__ import annotations

import importlib
import pkgutil

import click

import validation.benchmark
from validation.benchmark import work_precision
from validation.readme import renew

MARKS = ("<!-- models: python -m validation.benchmark --readme -->", "<!-- end of the models -->")


def benchmarks(kind: str = "rows") -> list[str]:
    """Names of the modules that measure rows, or what takes longer than minutes: "long_rows"."""
    names = [module.name for module in pkgutil.iter_modules(validation.benchmark.__path__)]
    modules = {name: f"validation.benchmark.{name}" for name in names if not name.startswith("_")}
    return [name for name, path in modules.items() if hasattr(importlib.import_module(path), kind)]


@click.command()
@click.option("--long", is_flag=True, help="Also measure what takes longer than three minutes.")
@click.option("--readme", is_flag=True, help="Renew the table of the models in README.md, and its picture.")
@click.argument("names", nargs=-1)
def main(long: bool, readme: bool, names: tuple[str, ...]) -> None:
    """Measure NAMES, or everything; with --readme and no names, only what the README shows."""
    from rich.console import Console
    from rich.table import Table

    if readme:
        renew(MARKS, work_precision.readme_table())
        work_precision.draw()
        if not names:
            return
    for kind in ("rows", "long_rows") if long else ("rows",):
        known = benchmarks(kind)
        for name in (name for name in names or known if name in known):
            table = Table("what", "wanted", "measured", "", title=name, title_justify="left")
            for row in getattr(importlib.import_module(f"validation.benchmark.{name}"), kind)():
                style = None if row.measured <= row.wanted else "red"
                table.add_row(row.what, f"{row.wanted:g}", f"{row.measured:.3g}", row.unit, style=style)
            Console().print(table)


if __name__ == "__main__":
    main()
