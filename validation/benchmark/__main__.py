"""Run the benchmarks and print what was wanted and what was measured."""

from __future__ import annotations

import importlib
import pkgutil

import click

import validation.benchmark


def benchmarks() -> list[str]:
    """Names of the modules that measure rows."""
    names = [module.name for module in pkgutil.iter_modules(validation.benchmark.__path__)]
    modules = {name: f"validation.benchmark.{name}" for name in names if not name.startswith("_")}
    return [name for name, path in modules.items() if hasattr(importlib.import_module(path), "rows")]


@click.command()
@click.argument("names", nargs=-1)
def main(names: tuple[str, ...]) -> None:
    """Measure NAMES, or everything."""
    from rich.console import Console
    from rich.table import Table

    for name in names or benchmarks():
        table = Table("what", "wanted", "measured", "", title=name, title_justify="left")
        for row in importlib.import_module(f"validation.benchmark.{name}").rows():
            style = None if row.measured <= row.wanted else "red"
            table.add_row(row.what, f"{row.wanted:g}", f"{row.measured:.3g}", row.unit, style=style)
        Console().print(table)


if __name__ == "__main__":
    main()
