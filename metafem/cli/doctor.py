"""`metafem doctor`."""

from __future__ import annotations

import json
import sys

import click

from metafem import _caches
from metafem.cli.examination import examine, megabytes
from metafem.cli.group import NOT_ACHIEVED, json_option, main


@main.command(short_help="Check the installation.")
@click.option(
    "--clear-cache",
    is_flag=True,
    help="Remove compiled kernels, the stored influence of blocks and stopped studies.",
)
@json_option
def doctor(clear_cache: bool, as_json: bool) -> None:
    """Check the installation: versions, caches, compiled kernels, a test contact, part and report."""
    if clear_cache:
        _clear_cache(as_json)
        return

    findings = list(examine())
    if as_json:
        click.echo(json.dumps([{"what": f.what, "found": f.found, "well": f.well} for f in findings]))
    else:
        for finding in findings:
            mark = click.style("ok  ", fg="green") if finding.well else click.style("FAIL", fg="red")
            click.echo(f"{mark} {finding.what}: {finding.found}")
    sys.exit(0 if all(finding.well for finding in findings) else NOT_ACHIEVED)


def _clear_cache(as_json: bool) -> None:

    try:
        folder = _caches.cache_folder()
        kept = (_caches.kept_kernels, _caches.kept_blocks, _caches.kept_studies)
        kernels, blocks, studies = (_caches.remove(each()) for each in kept)
        left = _caches.size([path for each in kept for path in each()])
    except OSError as error:
        raise click.ClickException(f"the cache cannot be cleared: {error}") from None
    if as_json:
        sizes = {"kernels": kernels, "blocks": blocks, "studies": studies, "left": left}
        data = {f"{name}_bytes": number for name, number in sizes.items()}
        click.echo(json.dumps({"folder": str(folder), **data}))
    else:
        click.echo(
            f"removed from {folder}: compiled kernels, {megabytes(kernels)}; "
            f"influence of blocks, {megabytes(blocks)}; stopped studies, {megabytes(studies)}"
        )
    if left:
        raise click.ClickException(f"{megabytes(left)} in {folder} could not be removed")
