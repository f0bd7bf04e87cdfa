"""`metafem spec`."""

from __future__ import annotations

import json
from pathlib import Path

import click

import metafem as mf
from metafem.cli.group import Name, force_option, json_option, main

# Members of a key's description that --json prints.
SHOWN = ("section", "kind", "name", "example", "meaning", "optional", "default")


@main.command("spec", short_help="Print every key of a specification, with examples.")
@click.option(
    "--schema",
    "as_schema",
    is_flag=True,
    help="Print the JSON schema instead, by which editors complete keys and mark errors. A specification "
    "names it in a comment before the first section: `#:schema ./metafem.schema.json`.",
)
@click.option("-o", "--output", type=Name(), help="Write the schema into this file instead of printing it.")
@force_option
@json_option
def explain(as_schema: bool, output: Path | None, force: bool, as_json: bool) -> None:
    """Print every section and key of a specification with its meaning and an example."""
    if output is not None:
        if not as_schema:
            raise click.UsageError("--output writes the schema; add --schema")
        mf.files.write_schema(output, force)
        click.echo(json.dumps({"schema": str(output)}) if as_json else f"wrote {output}")
    elif as_schema:
        click.echo(mf.files.schema_text(), nl=False)
    elif as_json:
        keys = mf.files.all_keys()
        click.echo(json.dumps([{name: getattr(key, name) for name in SHOWN} for key in keys]))
    else:
        click.echo(mf.files.manual(), nl=False)
