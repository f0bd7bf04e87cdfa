"""The group of all studies, and what their commands share."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from metafem.cli.group import Name, main
from metafem.cli.progress import progress
from metafem.cli.terminal import print_notes, print_table, terminal

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.inversion import Design

folder_argument = click.argument("folder", type=Name(), metavar="DIR")
seed_option = click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the random numbers."
)


@main.group(short_help="Study the design of a result folder.")
def study() -> None:
    """Study the design of the result folder DIR and write the dataset NAME.nc (NetCDF) into it.

    `metafem study NAME --help` lists the options of a study.
    """


def studied(
    name: str, folder: Path, force: bool, as_json: bool, compute: Callable[[Design], Dataset]
) -> None:
    """Compute a study of the design of a result folder, write it into the folder and print it."""
    import metafem as mf
    from metafem.files import same_design, study_data, study_path, write_study

    path = study_path(folder, name, force)
    still = same_design(folder)
    design = mf.load(folder)
    with progress():
        dataset = compute(design)
    write_study(dataset, path, force=force, still=still)
    if as_json:
        click.echo(json.dumps({"file": str(path), **study_data(dataset)}))
    else:
        _print_study(dataset, path)


def _print_study(dataset: Dataset, path: Path) -> None:
    from metafem.studies import summary

    table = summary(dataset)
    console = terminal()
    print_table(console, table.columns, table.rows, table.title)
    print_notes(console, table.notes)
    console.print(f"wrote {path}", highlight=False, markup=False)
