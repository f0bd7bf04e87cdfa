"""`metafem study`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from metafem.cli.group import Name, force_option, json_option, main
from metafem.cli.progress import progress
from metafem.cli.terminal import print_notes, print_table, terminal

if TYPE_CHECKING:
    from xarray import Dataset

STUDIES = ("interaction", "fidelity")


@main.command(short_help="Study the design of a result folder.")
@click.argument("name", type=click.Choice(STUDIES))
@click.argument("folder", type=Name())
@force_option
@json_option
def study(name: str, folder: Path, force: bool, as_json: bool) -> None:
    """Study the design of a result folder and write the dataset NAME.nc (NetCDF) into it.

    interaction: the change of the law by elastic coupling, for the design and for 1,000 random assignments
    of its heights to sites. fidelity: the law under every model, from independent asperities to the true
    block and finite elements; this takes a minute or two the first time.
    """
    import metafem as mf
    from metafem.files import same_design, study_data, study_path, write_study

    path = study_path(folder, name, force)
    still = same_design(folder)
    design = mf.load(folder)
    with progress():
        dataset = getattr(mf.studies, name)(design)
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
