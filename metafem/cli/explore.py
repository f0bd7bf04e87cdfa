"""`metafem explore`."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import click

from metafem.cli.group import Name, main


@main.command(short_help="Draw a law and see the surface, in the browser.")
@click.argument("path", type=Name(), required=False, metavar="[SPEC.toml | DIR]")
@click.option(
    "--port", type=int, help="Port of the loopback address. Default: that of the last run, or a free one."
)
@click.option("--no-browser", is_flag=True, help="Print the address only.")
def explore(path: Path | None, port: int | None, no_browser: bool) -> None:
    """Open a page on which you draw a target law and see its surface; Ctrl-C ends the command.

    The page begins with the specification SPEC.toml, with the specification of the result folder DIR, or by
    default with the demo operating-points. Only this machine can open the page. The command needs the extra
    explorer.
    """
    from metafem.explorer import explore as start

    with suppress(KeyboardInterrupt):
        start(path, port=port, show=not no_browser)
    click.echo("The explorer has ended. An open page keeps what it shows.")
