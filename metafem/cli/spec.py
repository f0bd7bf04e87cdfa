"""`metafem spec`."""

from __future__ import annotations

import json
from dataclasses import asdict

import click

from metafem.cli.group import json_option, main


@main.command("spec", short_help="Print every key of a specification, with examples.")
@json_option
def explain(as_json: bool) -> None:
    """Print every section and key of a specification with its meaning and an example."""
    from metafem.files import all_keys, manual

    if as_json:
        click.echo(json.dumps([asdict(key) for key in all_keys()]))
    else:
        click.echo(manual(), nl=False)
