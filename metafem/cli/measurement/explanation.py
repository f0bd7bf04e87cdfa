"""The options and the output of `metafem compare --explain`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem._given import Names
from metafem.cli.study.options import option_name, with_options
from metafem.errors import InvalidInput, named

if TYPE_CHECKING:
    pass

# Unit, example and meaning of each expected error; relative ones are in percent.
EXPECTED = {
    "angle_sd": ("rad", "0.05deg", "Expected tilt about either axis"),
    "height_scale_sd": ("%", "2%", "Expected error of the scale of all heights"),
    "composite_modulus_sd": ("%", "5%", "Expected error of E*"),
    "friction_sd": ("%", "5%", "Expected error of σB"),
    "height_sd": ("mm", "0.9um", "Expected error of each height"),
    "radius_sd": ("mm", "5um", "Expected error of each radius"),
    "position_sd": ("mm", "0um", "Expected error of x and of y of each site"),
    "adhesion_root_sd": ("%", "20%", "Expected error of the root of the adhesion energy"),
}

explain_options = with_options(
    click.option("--explain", is_flag=True, help="State which errors of the part explain the difference."),
    *(
        click.option(
            option_name(name),
            metavar="PERCENT" if unit == "%" else "QUANTITY",
            help=f"{meaning}, as a standard deviation; 0 leaves it out. Default: {example}.",
        )
        for name, (unit, example, meaning) in EXPECTED.items()
    ),
)


def given_priors(options: dict[str, Any], explain: bool) -> mf.calibration.Priors | None:
    """Remove the expected errors from the options and return them; None without any."""
    texts = {name: options.pop(name) for name in EXPECTED}
    texts = {name: text for name, text in texts.items() if text is not None}
    if texts and not explain:
        raise InvalidInput(f"{option_name(next(iter(texts)))} needs --explain")
    if not texts:
        return None

    names = Names(
        names={name: option_name(name) for name in EXPECTED},
        units={name: (unit, 0.01 if unit == "%" else 1.0) for name, (unit, _, _) in EXPECTED.items()},
    )
    values = {name: _number(name, text) for name, text in texts.items()}
    with named(names):
        return mf.calibration.Priors(**values)


def _number(name: str, text: str) -> float:
    """Return an expected error of the command line."""
    unit, example, _ = EXPECTED[name]
    if text.strip() == "0":
        return 0.0
    return mf.files.quantity(option_name(name), text, unit, example)
