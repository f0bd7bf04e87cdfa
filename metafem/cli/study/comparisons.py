"""`metafem study interaction` and `metafem study fidelity`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

import metafem as mf
from metafem.cli.study.group import of_design, study
from metafem.cli.study.options import seed_option

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.inversion import Design


@study.command(short_help="Elastic interaction, and assignments of heights to sites.")
@click.option(
    "--placements",
    type=click.IntRange(min=1),
    default=1000,
    show_default=True,
    help="Number of random assignments of the heights to sites.",
)
@seed_option
@of_design
def interaction(design: Design, placements: int, seed: int) -> Dataset:
    """Compare the law of interacting asperities with the law of independent asperities.

    The laws are compared for the design and for random assignments of its heights to sites, on a half-space
    and on the bonded layer. The result is the file DIR/interaction.nc.

    Example: metafem study interaction linear --placements 200
    """
    return mf.studies.interaction(design, placements=placements, rng=seed)


@study.command(short_help="The law under every model.")
@click.option(
    "--elements/--no-elements",
    default=True,
    show_default=True,
    help="Whether to compute the caps by finite elements, about half a minute for each radius.",
)
@of_design
def fidelity(design: Design, elements: bool) -> Dataset:
    """Compare the laws under all models, from independent asperities to the true block and finite elements.

    The first run takes a minute or two. The result is the file DIR/fidelity.nc.

    Example: metafem study fidelity linear --no-elements
    """
    return mf.studies.fidelity(design, elements=elements)
