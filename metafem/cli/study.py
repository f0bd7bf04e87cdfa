"""The command study: one subcommand for each study."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli import options
from metafem.cli.output import progress, show
from metafem.errors import InvalidInput, refuse_if

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem._validate import FloatArray
    from metafem.inversion import Design
    from metafem.surface import Surface

# Standard deviations of the inputs of `metafem study uncertainty`: unit, example and help text.
INPUTS = {
    "composite_modulus_sd": ("MPa", "0.04MPa", "SD of E*, such as {}."),
    "radius_sd": ("mm", "2um", "SD of the radii, such as {}."),
    "load_sd": ("N", "2mN", "SD of the load, such as {}."),
    "shear_strength_sd": ("MPa", "0.006MPa", "SD of σ, such as {}."),
    "area_ratio_sd": ("1", "0.01", "SD of B, such as {}."),
}


def _option(name: str, kind: Any, words: str, **settings: Any) -> options.Decorator:
    return click.option(*name.split(), type=kind, help=words, show_default="default" in settings, **settings)


# Types of options: numbers of at least 0, 1 and 2, angles, lengths and a list of lengths.
FROM_0, FROM_1, FROM_2 = (click.IntRange(least) for least in range(3))
ANGLE, LENGTH = options.Quantity("rad", "0.05deg"), options.Quantity("mm", "2um")
LENGTHS, LEVELS = options.Quantity("mm", "3um", listed=True), "0,0.5um,1um,1.5um,2um,2.5um,3um"

FITTED = "Loads between which the slope is fitted, P/E* or P, such as 0.05mm^2 0.2mm^2."
CALIBRATED = "Errors and correlations of a metafem calibrate -o FILE.toml; other options add inputs."

# Options of several studies: the law, the draws, the seed, and the processes.
LAW = (
    *options.model_options("that of the folder"),
    _option("--load-range", str, FITTED, nargs=2, metavar="FROM TO"),
)
DRAWS = _option("--draws", FROM_2, "Number of draws.", default=10_000)
SEED = _option("--seed rng", FROM_0, "Seed of the random numbers.", default=0)
WORKERS = _option("--workers", FROM_1, "Number of processes; no number depends on it.", default=1)


@click.group(short_help="Study the design of a result folder.")
def study() -> None:
    """Study the design in the result folder DIR, and write the dataset NAME.nc (NetCDF) into the folder.

    `metafem study NAME --help` lists the options of a study. `metafem report DIR` adds the results of the
    studies to the report.
    """


def of_design(*own: options.Decorator, short_help: str) -> Callable[[Callable[..., Dataset]], None]:
    """Return the decorator that adds the command of a study, from the function that computes its dataset.

    The function has a design and the options; those of `LAW` become its model and rescaled loads.
    """

    def add(compute: Callable[..., Dataset]) -> None:
        name = compute.__name__

        def run(folder: Path, force: bool, as_json: bool, workers: int = 1, **given: Any) -> None:
            from joblib import parallel_config

            path = mf.files.study_path(folder, name, force)
            with progress(), parallel_config(n_jobs=workers):
                design = mf.load(folder)
                dataset = compute(design, **(_of_law(design, **given) if "load_range" in given else given))
                mf.files.write_study(dataset, path, force=force)
            show_study(as_json, (dataset, path))

        run.__doc__ = compute.__doc__
        parts = (
            click.argument("folder", type=options.Name(), metavar="DIR"),
            *own,
            options.force_option,
            options.json_option,
        )
        study.add_command(options.command(*parts, name=name, short_help=short_help)(run))

    return add


def _of_law(
    design: Design, model: str | None, contact: str | None, load_range: Any, **others: Any
) -> dict[str, Any]:
    """Return the options with the model that --model and --contact state, and rescaled loads."""
    used = mf.files.chosen_model(design.law.model, model, contact, design.surface)
    if load_range is not None:
        load_range = mf.files.rescaled_range(load_range, design.surface.material)
    return {"model": used, "load_range": load_range, **others}


def show_study(as_json: bool, *studies: tuple[Dataset, Path]) -> None:
    """Print studies: the tables, answers and notes of all, or their data, the second as an explanation."""
    found = [mf.studies.summary(dataset) for dataset, _ in studies]
    first, *others = (
        {"file": str(path), "answer": own.answer, **mf.files.study_data(dataset)}
        for own, (dataset, path) in zip(found, studies, strict=True)
    )
    if as_json:
        show(True, {**first, **({"explanation": others[0]} if others else {})})
        return
    for own, (_, path) in zip(found, studies, strict=True):
        table = own.columns, own.rows, own.title
        show(False, {}, tables=[table], lines=filter(None, [own.answer]), notes=own.notes, files=[path])


@of_design(
    _option("--height-sd", LENGTHS, "SD of the heights, such as 0.9um,3um.", default=LEVELS),
    _option("--angle", ANGLE, "Largest tilt about either axis.", default="0"),
    _option("--radius-sd", LENGTH, "SD of the radii.", default="0"),
    _option("--position-sd", LENGTH, "SD of x and y of sites.", default="0"),
    _option("--misfit", bool, "Compare each law with the target; takes longer.", is_flag=True),
    *(*LAW, DRAWS, SEED, WORKERS),
    short_help="How accurate the heights must be.",
)
def manufacturing(design: Design, height_sd: list[float], misfit: bool, **options: Any) -> Dataset:
    """Study the law of surfaces whose heights have random errors.

    Each height has an independent Gaussian error. A line is fitted to each law over a range of loads. The
    mean and the scatter (standard deviation) of its slope over the random surfaces are printed, and with
    --misfit the misfit from the target that 95 % of the surfaces do not exceed. Other errors may be added.
    The result is the file DIR/manufacturing.nc.

    Example: metafem study manufacturing linear --height-sd 0.9um,3um
    """
    others = mf.Tolerances(**{name: options.pop(name) for name in ("angle", "radius_sd", "position_sd")})
    part = design if misfit else design.surface
    return mf.studies.manufacturing(part, height_sd, others=others, **options)


@of_design(
    _option("--angle", ANGLE, "Largest angle, reached in 1,000 steps.", default="0.1deg"),
    _option("--assignments", FROM_0, "Number of random assignments to compare with.", default=20),
    *(*LAW, SEED, WORKERS),
    short_help="How level the glass must be.",
)
def misalignment(design: Design, **options: Any) -> Dataset:
    """Study the law of a surface that is tilted relative to the glass.

    The scatter (standard deviation) of the slope is taken over all angles from minus to plus the largest
    angle. It depends on the assignment of the heights to sites, so that random assignments are also studied.
    The result is the file DIR/misalignment.nc.

    Example: metafem study misalignment linear --angle 0.05deg --assignments 100
    """
    return mf.studies.misalignment(design.surface, **options)


@of_design(
    *options.quantities(INPUTS),
    _option("--calibration", options.Name(), CALIBRATED, metavar="FILE.toml"),
    *(*LAW, DRAWS, SEED),
    short_help="Error bars of the law, and which input matters most.",
)
def uncertainty(design: Design, calibration: Path | None, **options: Any) -> Dataset:
    """Study the error bars of the law for Gaussian errors of its inputs, and the share of each input.

    The shares are Sobol indices: the fraction of the variance that an input causes on its own, and the
    fraction that it causes together with other inputs. The result is the file DIR/uncertainty.nc.

    Example: metafem study uncertainty linear --composite-modulus-sd 0.04MPa --radius-sd 2um
    """
    given = {name.removesuffix("_sd"): options.pop(name) for name in INPUTS}
    deviations: Any = {name: value for name, value in given.items() if value is not None}
    if calibration is not None:
        deviations = with_calibration(calibration, deviations, design.surface)
    example = "--radius-sd 2um, or --calibration calibration.toml"
    refuse_if(not deviations, f"no error of an input is given; write for example {example}")
    try:
        return mf.studies.uncertainty(design.surface, deviations, **options)
    except InvalidInput as error:
        name = error.key.removeprefix("parameters.")
        raise error.at(f"{name}_sd" if name in given else error.key) from None


@of_design(
    _option("--assignments", FROM_1, "Number of random assignments.", default=1000),
    SEED,
    short_help="Elastic interaction, and assignments of heights to sites.",
)
def interaction(design: Design, **options: Any) -> Dataset:
    """Compare the law of interacting asperities with the law of independent asperities.

    The laws are compared for the design and for random assignments of its heights to sites, on a half-space
    and on the bonded layer. The result is the file DIR/interaction.nc.

    Example: metafem study interaction linear --assignments 200
    """
    return mf.studies.interaction(design, **options)


@of_design(short_help="The law under every model.")
def fidelity(design: Design) -> Dataset:
    """Compare the laws under all models, from independent asperities to the finite elements of the block.

    The first run takes half a minute. The result is the file DIR/fidelity.nc.

    Example: metafem study fidelity linear
    """
    return mf.studies.fidelity(design)


def with_calibration(
    path: Path, deviations: Mapping[str, float], surface: Surface
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of the inputs from a calibration and from other options, and their covariance."""
    import numpy as np
    from scipy.linalg import block_diag

    from metafem.studies.uncertainty import nominal_values

    names, _, covariance = mf.files.read_parameters(path, nominal_values(surface))
    twice = ", ".join(name for name in names if name in deviations)
    refuse_if(twice, f"two options give the error of {twice}: --calibration and its own; keep one")
    return (*names, *deviations), block_diag(covariance, np.diag(np.square([*deviations.values()])))
