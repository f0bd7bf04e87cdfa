"""`metafem explore`."""

from __future__ import annotations

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
    """Open a page on which the target law is drawn and the surface follows; Ctrl-C ends it.

    It begins with the specification SPEC.toml, with that of the result folder DIR, or with the demo
    operating-points. The page is served to this machine alone. It needs the extra explorer.
    """
    from metafem.explorer import explore as start

    start(path, port=port, show=not no_browser)
