"""`metafem study interaction` and `metafem study fidelity`."""

from __future__ import annotations

from pathlib import Path

import click

from metafem.cli.group import force_option, json_option
from metafem.cli.study.group import folder_argument, seed_option, studied, study


@study.command(short_help="Elastic interaction, and assignments of heights to sites.")
@folder_argument
@click.option(
    "--placements",
    type=click.IntRange(min=1),
    default=1000,
    show_default=True,
    help="Number of random assignments of the heights to sites.",
)
@seed_option
@force_option
@json_option
def interaction(folder: Path, placements: int, seed: int, force: bool, as_json: bool) -> None:
    """Compare the law of coupled asperities with that of independent ones.

    The comparison is made for the design and for random assignments of its heights to sites, on a half-space
    and on the bonded layer. The result is the file DIR/interaction.nc.

    Example: metafem study interaction linear --placements 200
    """
    import metafem as mf

    studied(
        "interaction",
        folder,
        force,
        as_json,
        lambda design: mf.studies.interaction(design, placements=placements, rng=seed),
    )


@study.command(short_help="The law under every model.")
@folder_argument
@click.option(
    "--elements/--no-elements",
    default=True,
    show_default=True,
    help="Whether to compute the caps by finite elements, about half a minute for each radius.",
)
@force_option
@json_option
def fidelity(folder: Path, elements: bool, force: bool, as_json: bool) -> None:
    """Compare the law under every model, from independent asperities to the true block and finite elements.

    This takes a minute or two the first time. The result is the file DIR/fidelity.nc.

    Example: metafem study fidelity linear --no-elements
    """
    import metafem as mf

    studied("fidelity", folder, force, as_json, lambda design: mf.studies.fidelity(design, elements=elements))
