"""`metafem doctor`."""

from __future__ import annotations

import json
import sys

import click

from metafem.cli.group import NOT_ACHIEVED, json_option, main


@main.command()
@json_option
def doctor(as_json: bool) -> None:
    """Check the installation: versions, compiled kernels, a known contact, the part's tools."""
    from metafem.cli.examination import examine

    findings = list(examine())
    if as_json:
        click.echo(json.dumps([{"what": f.what, "found": f.found, "well": f.well} for f in findings]))
    else:
        for finding in findings:
            mark = click.style("ok  ", fg="green") if finding.well else click.style("FAIL", fg="red")
            click.echo(f"{mark} {finding.what}: {finding.found}")
    sys.exit(0 if all(finding.well for finding in findings) else NOT_ACHIEVED)
