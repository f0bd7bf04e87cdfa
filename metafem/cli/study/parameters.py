"""`metafem study uncertainty`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from metafem.cli.study.group import of_design, study
from metafem.cli.study.options import draw_options, law_arguments, law_options, run_arguments, run_options
from metafem.errors import InvalidInput

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.inversion import Design

# Unit and example of each input.
INPUTS = {
    "radius": ("mm", "2um"),
    "composite_modulus": ("MPa", "0.04MPa"),
    "load": ("N", "2mN"),
    "shear_strength": ("MPa", "0.006MPa"),
    "area_ratio": ("1", "0.01"),
}


@study.command(short_help="Error bars of the law, and which input matters most.")
@click.option(
    "--sd",
    multiple=True,
    required=True,
    metavar="INPUT=QUANTITY",
    help="Standard deviation of an input, such as radius=2um; repeat it for several. The inputs are "
    f"{', '.join(INPUTS)}.",
)
@law_options
@draw_options
@run_options
@of_design
def uncertainty(design: Design, **options: Any) -> Dataset:
    """Study the error bars of the law from Gaussian errors of its inputs, and the share of each input.

    The shares are Sobol indices: of the variance that an input causes alone, and together with others. The
    result is the file DIR/uncertainty.nc.

    Example: metafem study uncertainty linear --sd composite_modulus=0.04MPa --sd radius=2um
    """
    import metafem as mf
    from metafem._given import error_names
    from metafem.files import member_names, quantity

    texts = _written(options["sd"])
    deviations = {name: quantity(f"--sd {name}", text, *INPUTS[name]) for name, text in texts.items()}
    arguments = {**law_arguments(design, options), **run_arguments(options)}
    with error_names(member_names("parameters", texts, "--sd")):
        return mf.studies.uncertainty(design.surface, deviations, **arguments)


def _written(given: tuple[str, ...]) -> dict[str, str]:
    """Return the standard deviations by name, as they were written."""
    from metafem._given import printable

    found: dict[str, str] = {}
    for text in given:
        name, _, value = text.partition("=")
        name = name.strip().replace("-", "_")
        if name not in INPUTS:
            raise InvalidInput(
                f'--sd "{printable(text, 60)}" must be INPUT=QUANTITY, such as radius=2um; the inputs are '
                f"{', '.join(INPUTS)}"
            )
        if name in found:
            raise InvalidInput(f"--sd {name} is given twice")
        found[name] = value
    return found
