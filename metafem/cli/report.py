"""`metafem report`."""

from __future__ import annotations

from pathlib import Path

import click

import metafem as mf
from metafem.cli.group import Name, json_option, main
from metafem.cli.progress import progress
from metafem.cli.terminal import loaded, print_json


@main.command()
@click.argument("folder", type=Name())
@json_option
def report(folder: Path, as_json: bool) -> None:
    """Write or replace report.html in a result folder, with the results of the studies in the folder."""
    with progress():
        path = folder / "report.html"
        studies = mf.files.stored_studies(folder)
        text = mf.report.page(loaded(folder), mf.files.stored_hardness(folder), studies=studies)
        mf.files.write_text(path, text, force=True)
    if as_json:
        print_json({"report": str(path)})
    else:
        click.echo(f"wrote {path}")
