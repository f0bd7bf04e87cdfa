"""`metafem study uncertainty` and `metafem study combined`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

import metafem as mf
from metafem._given import Names, printable
from metafem._validate import FloatArray
from metafem.cli.group import Name, Quantity
from metafem.cli.study.group import of_design, study
from metafem.cli.study.options import (
    ERRORS,
    Options,
    draw_options,
    error_option,
    law_options,
    run_options,
    study_arguments,
)
from metafem.errors import named, refuse_if
from metafem.progress import message

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.inversion import Design
    from metafem.material import Material
    from metafem.surface import Surface

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

# Difference of a design value from the calibrated one, in standard deviations, above which both are printed.
APART = 2.0

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
    arguments = study_arguments(design, options)
    if options["measured"] is not None:
        arguments["load"], arguments["friction_force"] = mf.files.measured_pairs(options["measured"])
    with given_deviations(options["sd"], INPUTS, design.surface.material) as deviations:
        if options["calibration"] is None:
            example = "--sd radius=2um, or --calibration calibration.json"
            refuse_if(not deviations, f"no error is given; write for example {example}")
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
    type=Quantity("%"),
    default="10 %",
    show_default=True,
    metavar="PERCENT",
    help="Largest misfit with which the target is met.",
)
@click.option(
    "--probability",
    type=Quantity("%"),
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
    given = {name: options[name] for name in ERRORS}
    none = not any(given.values()) and not options["sd"]
    refuse_if(none, "no error is given; write for example --height-sd 3um --angle 0.05deg")
    tolerances = mf.Tolerances(**given)
    arguments = study_arguments(design, options)
    arguments["requirement"] = mf.studies.Requirement(options["misfit"], options["probability"])
    with given_deviations(options["sd"], MADE, design.surface.material) as deviations:
        return mf.studies.combined(design, tolerances, parameters=deviations or None, **arguments)


@contextmanager
def given_deviations(
    given: tuple[str, ...], inputs: Mapping[str, tuple[str, str]], material: Material | None = None
) -> Iterator[dict[str, float]]:
    """Yield the standard deviations by name; errors in the body name the option and the written unit.

    That of Young's modulus is yielded as that of E*, with the Poisson's ratio of the material.
    """
    found: dict[str, float] = {}
    units: dict[str, tuple[str, float]] = {}
    for text in given:
        name, _, value = text.partition("=")
        name = name.strip().replace("-", "_")
        must = f"must be INPUT=QUANTITY, such as radius=2um; the inputs are {', '.join(inputs)}"
        refuse_if(name not in inputs, f'--sd "{printable(text, 60)}" {must}')
        refuse_if(name in found, f"--sd {name} is given twice")
        found[name] = mf.files.quantity(f"--sd {name}", value, *inputs[name])
        units |= {f"parameters.{name}": unit for unit in [mf.files.written_unit(value)] if unit}
    names = Names({f"parameters.{name}": f"--sd {name}" for name in found}, units)
    if material is not None and "young_modulus" in found:
        found, names = _of_composite_modulus(found, names, material)
    with named(names):
        yield found


def _of_composite_modulus(
    found: dict[str, float], names: Names, material: Material
) -> tuple[dict[str, float], Names]:
    """Return the deviations with E* in place of E; errors still name E."""
    words = "--sd young_modulus and --sd composite_modulus give one error twice; keep one"
    refuse_if("composite_modulus" in found, words)
    ratio = material.composite_modulus / material.young_modulus
    old, new = "parameters.young_modulus", "parameters.composite_modulus"
    unit, size = names.units[old]
    units, labels = {**names.units, new: (unit, size * ratio)}, {**names.names, new: names.names[old]}
    young = {"young_modulus": ("composite_modulus", ratio)}
    renamed = [(*young.get(name, (name, 1.0)), sd) for name, sd in found.items()]
    return {name: times * sd for name, times, sd in renamed}, replace(names, units=units, names=labels)


def with_calibration(
    path: Path, deviations: Mapping[str, float], surface: Surface
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names and the covariance of the inputs of a calibration and of ``--sd``."""
    found = mf.files.read_parameters(path)
    twice = [name for name in found.parameters if name in deviations]
    names = ", ".join(twice)
    refuse_if(twice, f"--sd {names} and --calibration both give the error of {names}; keep one")
    designed = {
        "radius": float(surface.radius.mean()),
        "composite_modulus": surface.material.composite_modulus,
    }
    if surface.friction is not None:
        designed["area_ratio"] = surface.friction.area_ratio
        designed["shear_strength"] = surface.friction.shear_strength
    used = [i for i, name in enumerate(found.parameters) if name in designed]
    for i in used:
        name, sd, value = found.parameters[i], float(found.sd[i]), float(found.value[i])
        if abs(value - designed[name]) > APART * sd:
            message(
                f"{name} of the design is {designed[name]:.4g}, and that of the calibration {value:.4g} ± "
                f"{sd:.2g}; the study has the value of the design with the error of the calibration"
            )
    every = (*(found.parameters[i] for i in used), *deviations)
    covariance = np.diag([*found.sd[used], *deviations.values()]) ** 2
    covariance[: len(used), : len(used)] = found.covariance[np.ix_(used, used)]
    return every, covariance
