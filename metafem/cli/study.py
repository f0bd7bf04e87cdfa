"""The command study: one subcommand for each study, with options from one table."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli.group import TEXTS, Commands
from metafem.cli.options import (
    Decorator,
    Name,
    Quantity,
    command,
    force_option,
    json_option,
    model_options,
    option_name,
)
from metafem.cli.output import Printed, show
from metafem.cli.progress import loaded, progress
from metafem.errors import refuse_if
from metafem.progress import message

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem._validate import FloatArray
    from metafem.inversion import Design
    from metafem.material import Material
    from metafem.surface import Surface

# Unit and example of the standard deviation of each input of `metafem study uncertainty`.
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

# Default standard deviations of the heights, as in Fig. S3: 0 to 3 um in steps of 0.1 um [mm], and default
# largest angle, as in Fig. S2.
LEVELS, ANGLE = [i * 1e-4 for i in range(31)], "0.1deg"


def deviation_option(inputs: Mapping[str, Any]) -> Decorator:
    """Return the option --sd, which states the standard deviations of inputs."""
    text = "Standard deviation of an input, such as radius=2um; repeat it for several. The inputs are "
    return click.option("--sd", multiple=True, metavar="INPUT=QUANTITY", help=f"{text}{', '.join(inputs)}.")


def _error(name: str, unit: str, example: str, meaning: str) -> Decorator:
    words = f"{meaning}, such as {example}. Default: 0."
    kind = Quantity(unit, example)
    return click.option(option_name(name), type=kind, default=0.0, metavar="QUANTITY", help=words)


def _count(name: str, default: int, least: int, meaning: str) -> Decorator:
    kind = click.IntRange(min=least)
    return click.option(option_name(name), type=kind, default=default, show_default=True, help=meaning)


# Options of the studies; each study lists those that it has.
OPTIONS: dict[str, list[Decorator]] = {
    "law": [
        *model_options("that of the folder"),
        click.option(
            "--load-range",
            type=Quantity("load"),
            nargs=2,
            metavar="FROM TO",
            help="Loads between which the slope is fitted, P/E* or P, such as 0.05mm^2 0.2mm^2. Default: 25 "
            "to 100 % of the load at which the plane reaches the lowest asperity.",
        ),
    ],
    "height_sd": [
        click.option(
            "--height-sd",
            type=Quantity("mm", "3um", listed=True),
            multiple=True,
            metavar="LENGTHS",
            help="Standard deviations of the heights, such as 0.9um,3um; may be repeated. Default: 0 to 3 um "
            "in steps of 0.1 um.",
        )
    ],
    "others": [
        _error("angle", "rad", "0.05deg", "Largest tilt about either axis"),
        _error("radius_sd", "mm", "2um", "Standard deviation of the radii"),
        _error("position_sd", "mm", "5um", "Standard deviation of x and of y of each site"),
    ],
    "misfit": [
        click.option(
            "--misfit", is_flag=True, help="Compare each law also with the target; this takes longer."
        )
    ],
    "angles": [
        click.option(
            "--angle",
            type=Quantity("rad", "0.05deg", listed=True),
            multiple=True,
            default=(ANGLE,),
            metavar="ANGLES",
            help="Largest angle, which is reached in 1,000 steps, or several that are reached in steps of "
            f"this size, such as 0.005deg,0.1deg; may be repeated. Default: {ANGLE}.",
        ),
        click.option(
            "--axes",
            type=click.Choice(("both", "x", "y")),
            default="both",
            show_default=True,
            help="Whether the surface is inclined along x and y together, or along one of them.",
        ),
        _count("shuffles", 20, 0, "Number of random assignments of the heights to sites to compare with."),
    ],
    "placements": [_count("placements", 1000, 1, "Number of random assignments of the heights to sites.")],
    "elements": [
        click.option(
            "--elements/--no-elements",
            default=True,
            show_default=True,
            help="Whether to compute the caps by finite elements, about half a minute for each radius.",
        )
    ],
    "inputs": [
        deviation_option(INPUTS),
        click.option(
            "--calibration",
            type=Name(),
            metavar="FILE.toml",
            help="Errors of E*, B, σ and the radius with their correlations, from metafem calibrate -o "
            "FILE.toml; --sd adds other inputs.",
        ),
        click.option(
            "--measured",
            type=Name(),
            metavar="TABLE.csv",
            help="Table of measured pairs with the columns load_N and friction_force_N, or in other units. "
            "Default: the predicted law.",
        ),
    ],
    "draws": [_count("draws", 10_000, 2, "Number of draws.")],
    "seed": [_count("seed", 0, 0, "Seed of the random numbers.")],
    "workers": [_count("workers", 1, 1, "Number of processes; the numbers do not depend on it.")],
}


class Studies(Commands):
    """The group of all studies, whose module is this one."""

    modules: Mapping[str, str] = dict.fromkeys(
        ("manufacturing", "misalignment", "uncertainty", "interaction", "fidelity"), "study"
    )
    main = click.Group.main


@click.group(cls=Studies, short_help="Study the design of a result folder.")
def study() -> None:
    """Study the design in the result folder DIR, and write the dataset NAME.nc (NetCDF) into the folder.

    `metafem study NAME --help` lists the options of a study. `metafem report DIR` adds the results of the
    studies to the report.
    """


def of_design(*names: str, short_help: str) -> Callable[[Callable[..., Dataset]], click.Command]:
    """Return the decorator that makes the command of a study from the function that computes its dataset.

    The function has a design and the options; `names` lists those in `OPTIONS`.
    """
    options = [option for name in names for option in OPTIONS[name]]

    def made(compute: Callable[..., Dataset]) -> click.Command:
        name = compute.__name__

        def run(folder: Path, force: bool, as_json: bool, workers: int = 1, **given: Any) -> None:
            if given.get("calibration") is not None:  # report a wrong file before the study runs
                mf.files.read_parameters(given["calibration"])
            path = mf.files.study_path(folder, name, force)
            from joblib import parallel_config

            with progress(), parallel_config(n_jobs=workers):
                dataset = compute(loaded(folder), **given)
                mf.files.write_study(dataset, path, force=force)
            show_study(as_json, {"file": str(path), **mf.files.study_data(dataset)}, dataset, path)

        run.__doc__ = compute.__doc__
        folder = click.argument("folder", type=Name(), metavar="DIR")
        parts = (folder, *options, force_option, json_option)
        found: click.Command = command(*parts, name=name, short_help=short_help)(run)
        return found

    return made


def show_study(
    as_json: bool, data: Mapping[str, Any], study: Dataset, path: Path | None, *more: Printed, lines: Any = ()
) -> None:
    """Print a study: its table and further ones, its notes and its answer, or `lines` instead."""
    if as_json:
        show(True, data)
        return
    found = mf.studies.summary(study)
    tables = [(found.columns, found.rows, found.title), *more]
    answers = lines or filter(None, [found.answer])
    show(False, {}, tables=tables, lines=answers, notes=found.notes, files=[path])


def _arguments(design: Design, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a study that the options of the law, the draws and the seed state."""
    model = mf.files.chosen_model(design.law.model, options["model"], options["contact"])
    mf.files.refuse_missing_block(model, design.surface, "design the folder again with a section [block]")
    given = options["load_range"]
    loads = None if given is None else mf.files.rescaled_range(given, design.surface.material)
    found = {"model": model, "load_range": loads, "rng": options["seed"]}
    return found | ({"draws": options["draws"]} if "draws" in options else {})


@of_design(
    *("height_sd", "others", "misfit", "law", "draws", "seed", "workers"),
    short_help="How accurate the heights must be.",
)
def manufacturing(design: Design, **options: Any) -> Dataset:
    """Study the law of surfaces whose heights have random errors.

    Each height has an independent Gaussian error. A line is fitted to each law over a range of loads. The
    mean and the scatter (standard deviation) of its slope over the random surfaces are printed, and with
    --misfit the misfit from the target that 95 % of the surfaces do not exceed. Other errors may be added.
    The result is the file DIR/manufacturing.nc.

    Example: metafem study manufacturing linear --height-sd 0.9um,3um
    """
    others = {name: options[name] for name in ("angle", "radius_sd", "position_sd")}
    return mf.studies.manufacturing(
        design if options["misfit"] else design.surface,
        [*itertools.chain(*options["height_sd"])] or LEVELS,
        others=mf.Tolerances(**others),
        **_arguments(design, options),
    )


@of_design("angles", "law", "seed", "workers", short_help="How level the plane must be.")
def misalignment(design: Design, **options: Any) -> Dataset:
    """Study the law of a surface that is tilted relative to the plane.

    The scatter (standard deviation) of the slope is taken over all angles from minus to plus the largest
    angle. It depends on the assignment of the heights to sites, so that random assignments are also studied.
    The result is the file DIR/misalignment.nc.

    Example: metafem study misalignment linear --angle 0.05deg --shuffles 100
    """
    import numpy as np

    from metafem.studies.misalignment import STEPS

    angles = [*itertools.chain(*options["angle"])]
    more = {"axes": options["axes"], "shuffles": options["shuffles"], **_arguments(design, options)}
    if len(angles) == 1:  # all steps are returned, because the figure needs them
        return mf.studies.misalignment(design.surface, angles[0], **more)
    ends = list(itertools.pairwise([0.0, *angles]))
    if any(low >= high for low, high in ends):
        return mf.studies.misalignment(design.surface, np.array(angles), **more)  # which refuses them
    # steps that are at most as long as those of a single angle, up to the rounding error of a quotient
    step = angles[-1] / STEPS * (1.0 + 1e-9)
    parts = [np.linspace(low, high, math.ceil((high - low) / step) + 1)[1:] for low, high in ends]
    found = mf.studies.misalignment(design.surface, np.concatenate(parts), **more)
    return found.isel(angle=np.cumsum([len(part) for part in parts]) - 1)


@of_design(
    "inputs", "law", "draws", "seed", short_help="Error bars of the law, and which input matters most."
)
def uncertainty(design: Design, **options: Any) -> Dataset:
    """Study the error bars of the law for Gaussian errors of its inputs, and the share of each input.

    The shares are Sobol indices: the fraction of the variance that an input causes on its own, and the
    fraction that it causes together with other inputs. With measured loads and friction forces, the study
    concerns their difference from the predicted law. The result is the file DIR/uncertainty.nc.

    Example: metafem study uncertainty linear --sd composite_modulus=0.04MPa --sd radius=2um
    """
    arguments = _arguments(design, options)
    if options["measured"] is not None:
        arguments["load"] = mf.files.measured_pairs(options["measured"])
    deviations: Any = given_deviations(options["sd"], INPUTS, design.surface.material)
    example = "--sd radius=2um, or --calibration calibration.toml"
    if options["calibration"] is not None:
        deviations = with_calibration(options["calibration"], deviations, design.surface)
    refuse_if(not deviations, f"no error is given by --sd; write for example {example}")
    return mf.studies.uncertainty(design.surface, deviations, **arguments)


@of_design("placements", "seed", short_help="Elastic interaction, and assignments of heights to sites.")
def interaction(design: Design, placements: int, seed: int) -> Dataset:
    """Compare the law of interacting asperities with the law of independent asperities.

    The laws are compared for the design and for random assignments of its heights to sites, on a half-space
    and on the bonded layer. The result is the file DIR/interaction.nc.

    Example: metafem study interaction linear --placements 200
    """
    return mf.studies.interaction(design, placements=placements, rng=seed)


@of_design("elements", short_help="The law under every model.")
def fidelity(design: Design, elements: bool) -> Dataset:
    """Compare the laws under all models, from independent asperities to the true block and finite elements.

    The first run takes a minute or two. The result is the file DIR/fidelity.nc.

    Example: metafem study fidelity linear --no-elements
    """
    return mf.studies.fidelity(design, elements=elements)


def given_deviations(
    given: tuple[str, ...], inputs: Mapping[str, tuple[str, str]], material: Material | None = None
) -> dict[str, float]:
    """Return the standard deviations that --sd states, by the name of the input.

    That of Young's modulus is converted to one of E* with the Poisson's ratio of the material.
    """
    found: dict[str, float] = {}
    texts = click.get_current_context().meta.setdefault(TEXTS, {})
    for text in given:
        name, _, value = text.partition("=")
        name = name.strip().replace("-", "_")
        must = f"must be INPUT=QUANTITY, such as radius=2um; the inputs are {', '.join(inputs)}"
        refuse_if(name not in inputs, f'--sd "{text:.60}" {must}')
        refuse_if(name in found, f"--sd {name} is given twice")
        found[name] = mf.files.quantity(f"--sd {name}", value, *inputs[name])
        texts[f"parameters.{name}"] = f"--sd {name}", [value]
    if material is not None and "young_modulus" in found:
        words = "--sd young_modulus and --sd composite_modulus give one error twice; keep one"
        refuse_if("composite_modulus" in found, words)
        ratio = material.composite_modulus / material.young_modulus
        found["composite_modulus"] = found.pop("young_modulus") * ratio
        texts["parameters.composite_modulus"] = texts["parameters.young_modulus"]
    return found


def with_calibration(
    path: Path, deviations: Mapping[str, float], surface: Surface
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of the inputs from a calibration and from ``--sd``, and their covariance."""
    import numpy as np

    found = mf.files.read_parameters(path)
    twice = ", ".join(name for name in found.parameters if name in deviations)
    refuse_if(twice, f"--sd {twice} and --calibration both give the error of {twice}; keep one")
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
