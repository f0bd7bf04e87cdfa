"""`metafem study uncertainty`."""

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
from metafem.cli.group import Name
from metafem.cli.study.group import of_design, study
from metafem.cli.study.options import Options, draws_option, law_options, seed_option, study_arguments
from metafem.errors import named, refuse_if
from metafem.progress import message

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.inversion import Design
    from metafem.material import Material
    from metafem.surface import Surface

# Unit and example of the standard deviation of each input.
INPUTS = {
    "radius": ("mm", "2um"),
    "composite_modulus": ("MPa", "0.04MPa"),
    "young_modulus": ("MPa", "0.03MPa"),
    "load": ("N", "2mN"),
    "shear_strength": ("MPa", "0.006MPa"),
    "area_ratio": ("1", "0.01"),
    "friction_force": ("N", "2mN"),
}

# If a value of the design and the calibrated value differ by more than this, both are printed [standard
# deviations].
APART = 2.0


def deviation_option(inputs: Mapping[str, tuple[str, str]]) -> Options:
    """Return the option --sd, which states the standard deviations of inputs."""
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
@draws_option
@seed_option
@of_design
def uncertainty(design: Design, **options: Any) -> Dataset:
    """Study the error bars of the law for Gaussian errors of its inputs, and the share of each input.

    The shares are Sobol indices: the fraction of the variance that an input causes on its own, and the
    fraction that it causes together with other inputs. With measured loads and friction forces, the study
    concerns their difference from the predicted law. The result is the file DIR/uncertainty.nc.

    Example: metafem study uncertainty linear --sd composite_modulus=0.04MPa --sd radius=2um
    """
    arguments = study_arguments(design, options)
    if options["measured"] is not None:
        arguments["load"] = mf.files.measured_pairs(options["measured"])
    with given_deviations(options["sd"], INPUTS, design.surface.material) as deviations:
        if options["calibration"] is None:
            example = "--sd radius=2um, or --calibration calibration.json"
            refuse_if(not deviations, f"no error is given; write for example {example}")
            return mf.studies.uncertainty(design.surface, deviations, **arguments)
        correlated = with_calibration(options["calibration"], deviations, design.surface)
        return mf.studies.uncertainty(design.surface, correlated, **arguments)


@contextmanager
def given_deviations(
    given: tuple[str, ...], inputs: Mapping[str, tuple[str, str]], material: Material | None = None
) -> Iterator[dict[str, float]]:
    """Yield the standard deviations by the name of the input.

    Errors in the body name the option and use the unit in which it was written. A standard deviation of
    Young's modulus is converted to one of E* with the Poisson's ratio of the material.
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
    """Return the standard deviations, with that of E converted to E*, and names by which errors state E."""
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
    """Return the names of the inputs from a calibration and from ``--sd``, and their covariance."""
    found = mf.files.read_parameters(path)
    twice = [name for name in found.parameters if name in deviations]
    names = ", ".join(twice)
    refuse_if(twice, f"--sd {names} and --calibration both give the error of {names}; keep one")
    designed = {
        "radius": float(surface.radius.mean()),
        "composite_modulus": surface.material.composite_modulus,
    }
    if surface.friction is not None:
        designed["area_ratio"] = float(surface.friction.area_ratio)
        designed["shear_strength"] = float(surface.friction.shear_strength)
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
