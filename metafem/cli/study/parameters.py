"""`metafem study uncertainty` and `metafem study combined`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem._given import Names, printable
from metafem.cli.group import Name
from metafem.cli.study.calibrated import with_calibration
from metafem.cli.study.group import of_design, study
from metafem.cli.study.options import (
    ERRORS,
    Options,
    draw_options,
    error,
    error_option,
    law_arguments,
    law_options,
    run_arguments,
    run_options,
)
from metafem.errors import InvalidInput, named

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.inversion import Design
    from metafem.material import Material

# Unit and example of each input.
INPUTS = {
    "radius": ("mm", "2um"),
    "composite_modulus": ("MPa", "0.04MPa"),
    "young_modulus": ("MPa", "0.03MPa"),
    "load": ("N", "2mN"),
    "shear_strength": ("MPa", "0.006MPa"),
    "area_ratio": ("1", "0.01"),
    "friction_force": ("N", "2mN"),
}

# Those of a made surface.
MADE = {name: INPUTS[name] for name in INPUTS if name not in ("load", "friction_force")}


def deviation_option(inputs: Mapping[str, tuple[str, str]]) -> Options:
    """Return the option of the standard deviations of inputs."""
    return click.option(
        "--sd",
        multiple=True,
        metavar="INPUT=QUANTITY",
        help="Standard deviation of an input, such as radius=2um; repeat it for several. The inputs are "
        f"{', '.join(inputs)}.",
    )


@study.command(short_help="Error bars of the law, and which input matters most.")
@deviation_option(INPUTS)
@click.option(
    "--calibration",
    type=Name(),
    metavar="FILE.json",
    help="Errors of E*, B, σ and the radius with their correlations, from metafem calibrate -o FILE.json; "
    "--sd adds other inputs.",
)
@click.option(
    "--measured",
    type=Name(),
    metavar="TABLE.csv",
    help="Table of measured pairs with the columns load_N and friction_force_N, or in other units. Default: "
    "the predicted law.",
)
@law_options
@draw_options("draws", "the relative sampling error of each error bar")
@run_options
@of_design
def uncertainty(design: Design, **options: Any) -> Dataset:
    """Study the error bars of the law from Gaussian errors of its inputs, and the share of each input.

    The shares are Sobol indices: of the variance that an input causes alone, and together with others. With
    measured pairs, the quantity is their difference from the predicted law. The result is the file
    DIR/uncertainty.nc.

    Example: metafem study uncertainty linear --sd composite_modulus=0.04MPa --sd radius=2um
    """
    arguments = {**law_arguments(design, options), **run_arguments(options)}
    if options["measured"] is not None:
        arguments["load"], arguments["friction_force"] = mf.files.measured_pairs(options["measured"])
    with given_deviations(options["sd"], INPUTS, design.surface.material) as deviations:
        if options["calibration"] is None:
            if not deviations:
                raise InvalidInput(
                    "no error is given; write for example --sd radius=2um, or --calibration calibration.json"
                )
            return mf.studies.uncertainty(design.surface, deviations, **arguments)
        correlated = with_calibration(options["calibration"], deviations, design.surface)
        return mf.studies.uncertainty(design.surface, correlated, **arguments)


@study.command(short_help="How good the machine must be.")
@error_option("height_sd")
@error_option("angle")
@error_option("radius_sd")
@error_option("position_sd")
@deviation_option(MADE)
@click.option(
    "--misfit",
    default="10 %",
    show_default=True,
    metavar="PERCENT",
    help="Largest misfit with which the target is met.",
)
@click.option(
    "--probability",
    default="90 %",
    show_default=True,
    metavar="PERCENT",
    help="Wanted probability of meeting the target.",
)
@law_options
@draw_options("random surfaces", "the sampling error of the probability")
@run_options
@of_design
def combined(design: Design, **options: Any) -> Dataset:
    """Study all errors together: how likely a made surface meets the target, and how small they must be.

    The errors of heights, radii and positions are Gaussian, the tilt is uniform. Their largest multiples with
    the wanted probability are found for all together and for each alone. The result is the file
    DIR/combined.nc.

    Example: metafem study combined linear --height-sd 3um --angle 0.05deg --misfit 5%
    """
    given = {name: error(name, options[name]) for name in ERRORS}
    if not any(given.values()) and not options["sd"]:
        raise InvalidInput("no error is given; write for example --height-sd 3um --angle 0.05deg")
    tolerances = mf.Tolerances(**given)
    arguments = {**law_arguments(design, options), **run_arguments(options)}
    wanted = {name: mf.files.quantity(f"--{name}", options[name], "%") for name in ("misfit", "probability")}
    arguments["requirement"] = mf.studies.Requirement(**wanted)
    with given_deviations(options["sd"], MADE, design.surface.material) as deviations:
        return mf.studies.combined(design, tolerances, parameters=deviations or None, **arguments)


@contextmanager
def given_deviations(
    given: tuple[str, ...], inputs: Mapping[str, tuple[str, str]], material: Material | None = None
) -> Iterator[dict[str, float]]:
    """Yield the standard deviations by name; errors in the body name the option and the written unit.

    That of Young's modulus is yielded as that of E*, with the Poisson's ratio of the material.
    """
    from metafem.files.units import written_unit

    texts: dict[str, str] = {}
    for text in given:
        name, _, value = text.partition("=")
        name = name.strip().replace("-", "_")
        if name not in inputs:
            raise InvalidInput(
                f'--sd "{printable(text, 60)}" must be INPUT=QUANTITY, such as radius=2um; the inputs are '
                f"{', '.join(inputs)}"
            )
        if name in texts:
            raise InvalidInput(f"--sd {name} is given twice")
        texts[name] = value
    found = {name: mf.files.quantity(f"--sd {name}", text, *inputs[name]) for name, text in texts.items()}
    units = {name: unit for name, text in texts.items() if (unit := written_unit(text))}
    names = Names(
        {f"parameters.{name}": f"--sd {name}" for name in texts},
        {f"parameters.{name}": unit for name, unit in units.items()},
    )
    if material is not None and "young_modulus" in found:
        found, names = _of_composite_modulus(found, names, material)
    with named(names):
        yield found


def _of_composite_modulus(
    found: dict[str, float], names: Names, material: Material
) -> tuple[dict[str, float], Names]:
    """Return the deviations with E* in place of E; errors still name E."""
    if "composite_modulus" in found:
        raise InvalidInput("--sd young_modulus and --sd composite_modulus give one error twice; keep one")
    ratio = material.composite_modulus / material.young_modulus
    old, new = "parameters.young_modulus", "parameters.composite_modulus"
    unit, size = names.units[old]
    units, labels = {**names.units, new: (unit, size * ratio)}, {**names.names, new: names.names[old]}
    young = {"young_modulus": ("composite_modulus", ratio)}
    renamed = [(*young.get(name, (name, 1.0)), sd) for name, sd in found.items()]
    return {name: times * sd for name, times, sd in renamed}, replace(names, units=units, names=labels)
