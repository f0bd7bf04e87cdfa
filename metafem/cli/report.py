"""`metafem report`."""

from __future__ import annotations

from pathlib import Path

import click

from metafem.cli.group import Name, json_option, main
from metafem.cli.progress import progress
from metafem.cli.terminal import loaded, print_json


@main.command()
@click.argument("folder", type=Name())
@click.option("--checks", is_flag=True, help="Add the finite-element checks, which take about a minute.")
@json_option
def report(folder: Path, checks: bool, as_json: bool) -> None:
    """Write or replace report.html of a result folder, with the answers of the studies in the folder."""
    from metafem.files import same_design, stored_hardness, stored_studies, write_text
    from metafem.report import page

    with progress():
        path, still = folder / "report.html", same_design(folder)
        studies = stored_studies(folder)
        text = page(loaded(folder), stored_hardness(folder), checks=checks, studies=studies)
        write_text(path, text, force=True, still=still)
    if as_json:
        print_json({"report": str(path)})
    else:
        click.echo(f"wrote {path}")
