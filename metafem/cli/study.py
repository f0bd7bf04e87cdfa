"""The command study: one subcommand for each study, with options from one table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli.group import TEXTS
from metafem.cli.options import Decorator, Name, Quantity, command, force_option, json_option, model_options
from metafem.cli.output import Printed, show
from metafem.cli.progress import loaded, progress
from metafem.errors import refuse_if
from metafem.progress import message

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem._validate import FloatArray
    from metafem.inversion import Design
    from metafem.surface import Surface

# Unit and example of the standard deviation of each input of `metafem study uncertainty`.
INPUTS = {
    "radius": ("mm", "2um"),
    "composite_modulus": ("MPa", "0.04MPa"),
    "load": ("N", "2mN"),
    "shear_strength": ("MPa", "0.006MPa"),
    "area_ratio": ("1", "0.01"),
    "friction_force": ("N", "2mN"),
}

# If a value of the design and the calibrated value differ by more than this, both are printed [standard
# deviations].
APART = 2.0

# Default standard deviations of the heights, as in Fig. S3: 0 to 3 um in steps of 0.1 um [mm].
LEVELS = [i * 1e-4 for i in range(31)]


def deviation_option(inputs: Mapping[str, Any]) -> Decorator:
    """Return the option --sd, which states the standard deviations of inputs."""
    text = "Standard deviation of an input, such as radius=2um; repeat it for several. The inputs are "
    return click.option("--sd", multiple=True, metavar="INPUT=QUANTITY", help=f"{text}{', '.join(inputs)}.")


def _option(name: str, kind: Any, words: str, **settings: Any) -> Decorator:
    return click.option(name, type=kind, help=words, show_default="default" in settings, **settings)


# Types of options: numbers of at least 0, 1 and 2, and an angle.
FROM_0, FROM_1, FROM_2 = (click.IntRange(least) for least in range(3))
ANGLE = Quantity("rad", "0.05deg")

# Help texts of more than a line.
FITTED = (
    "Loads between which the slope is fitted, P/E* or P, such as 0.05mm^2 0.2mm^2. Default: 25 to 100 % of "
    "the load at which the plane reaches the lowest asperity."
)
CALIBRATED = "Errors and correlations of a metafem calibrate -o FILE.toml; --sd adds other inputs."
PAIRS = "Measured pairs with the columns load_N and friction_force_N. Default: the predicted law."
HEIGHTS = "SD of the heights, such as 0.9um,3um. Default: 0 to 3 um in steps of 0.1 um."

# Options of the studies, each with its type, help text and settings; each study lists those that it has.
OPTIONS: dict[str, Decorator] = {
    "height_sd": _option("--height-sd", Quantity("mm", "3um", listed=True), HEIGHTS, metavar="LENGTHS"),
    "tilt": _option("--angle", ANGLE, "Largest tilt about either axis.", default="0"),
    "radius_sd": _option("--radius-sd", Quantity("mm", "2um"), "SD of the radii.", default="0"),
    "position_sd": _option("--position-sd", Quantity("mm", "5um"), "SD of x and y of sites.", default="0"),
    "misfit": _option("--misfit", bool, "Compare each law with the target; takes longer.", is_flag=True),
    "angle": _option("--angle", ANGLE, "Largest angle, reached in 1,000 steps.", default="0.1deg"),
    "shuffles": _option("--shuffles", FROM_0, "Number of random placements to compare with.", default=20),
    "placements": _option("--placements", FROM_1, "Number of random placements.", default=1000),
    "elements": _option("--elements/--no-elements", bool, "Press true caps, for a minute.", default=True),
    "sd": deviation_option(INPUTS),
    "calibration": _option("--calibration", Name(), CALIBRATED, metavar="FILE.toml"),
    "measured": _option("--measured", Name(), PAIRS, metavar="TABLE.csv"),
    "load_range": _option("--load-range", Quantity("load"), FITTED, nargs=2, metavar="FROM TO"),
    "draws": _option("--draws", FROM_2, "Number of draws.", default=10_000),
    "seed": _option("--seed", FROM_0, "Seed of the random numbers.", default=0),
    "workers": _option("--workers", FROM_1, "Number of processes; no number depends on it.", default=1),
}


@click.group(short_help="Study the design of a result folder.")
def study() -> None:
    """Study the design in the result folder DIR, and write the dataset NAME.nc (NetCDF) into the folder.

    `metafem study NAME --help` lists the options of a study. `metafem report DIR` adds the results of the
    studies to the report.
    """


def of_design(*names: str, short_help: str) -> Callable[[Callable[..., Dataset]], None]:
    """Return the decorator that adds the command of a study, from the function that computes its dataset.

    The function has a design and the options; `names` lists those in `OPTIONS`. The options of a law are
    --model, --contact and --load-range.
    """
    options = [OPTIONS[name] for name in names]
    if "load_range" in names:
        options[:0] = model_options("that of the folder")

    def add(compute: Callable[..., Dataset]) -> None:
        name = compute.__name__

        def run(folder: Path, force: bool, as_json: bool, workers: int = 1, **given: Any) -> None:
            if given.get("calibration") is not None:  # report a wrong file before the study runs
                mf.files.read_parameters(given["calibration"])
            path = mf.files.study_path(folder, name, force)
            from joblib import parallel_config

            with progress(), parallel_config(n_jobs=workers):
                design = loaded(folder)
                dataset = compute(design, **_arguments(design, given))
                mf.files.write_study(dataset, path, force=force)
            show_study(as_json, {"file": str(path), **mf.files.study_data(dataset)}, dataset, path)

        run.__doc__ = compute.__doc__
        parts = (click.argument("folder", type=Name(), metavar="DIR"), *options, force_option, json_option)
        study.add_command(command(*parts, name=name, short_help=short_help)(run))

    return add


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


def _arguments(design: Design, given: dict[str, Any]) -> dict[str, Any]:
    """Return the options with the model that --model and --contact state, and rescaled loads."""
    if "seed" in given:
        given["rng"] = given.pop("seed")
    if "load_range" not in given:
        return given
    chosen = given["model"], given.pop("contact"), design.surface.block
    model = mf.files.chosen_model(design.law.model, *chosen)
    mf.files.refuse_missing_block(model, design.surface, "design the folder again with a section [block]")
    if given["load_range"] is not None:
        given["load_range"] = mf.files.rescaled_range(given["load_range"], design.surface.material)
    return given | {"model": model}


@of_design(
    *("height_sd", "tilt", "radius_sd", "position_sd", "misfit", "load_range", "draws", "seed", "workers"),
    short_help="How accurate the heights must be.",
)
def manufacturing(design: Design, height_sd: list[float] | None, misfit: bool, **options: Any) -> Dataset:
    """Study the law of surfaces whose heights have random errors.

    Each height has an independent Gaussian error. A line is fitted to each law over a range of loads. The
    mean and the scatter (standard deviation) of its slope over the random surfaces are printed, and with
    --misfit the misfit from the target that 95 % of the surfaces do not exceed. Other errors may be added.
    The result is the file DIR/manufacturing.nc.

    Example: metafem study manufacturing linear --height-sd 0.9um,3um
    """
    others = mf.Tolerances(**{name: options.pop(name) for name in ("angle", "radius_sd", "position_sd")})
    part = design if misfit else design.surface
    return mf.studies.manufacturing(part, height_sd or LEVELS, others=others, **options)


@of_design("angle", "shuffles", "load_range", "seed", "workers", short_help="How level the plane must be.")
def misalignment(design: Design, **options: Any) -> Dataset:
    """Study the law of a surface that is tilted relative to the plane.

    The scatter (standard deviation) of the slope is taken over all angles from minus to plus the largest
    angle. It depends on the assignment of the heights to sites, so that random assignments are also studied.
    The result is the file DIR/misalignment.nc.

    Example: metafem study misalignment linear --angle 0.05deg --shuffles 100
    """
    return mf.studies.misalignment(design.surface, **options)


@of_design(
    *("sd", "calibration", "measured", "load_range", "draws", "seed"),
    short_help="Error bars of the law, and which input matters most.",
)
def uncertainty(
    design: Design, sd: tuple[str, ...], calibration: Path | None, measured: Path | None, **options: Any
) -> Dataset:
    """Study the error bars of the law for Gaussian errors of its inputs, and the share of each input.

    The shares are Sobol indices: the fraction of the variance that an input causes on its own, and the
    fraction that it causes together with other inputs. With measured loads and friction forces, the study
    concerns their difference from the predicted law. The result is the file DIR/uncertainty.nc.

    Example: metafem study uncertainty linear --sd composite_modulus=0.04MPa --sd radius=2um
    """
    if measured is not None:
        options["load"] = mf.files.measured_pairs(measured)
    deviations: Any = given_deviations(sd, INPUTS)
    if calibration is not None:
        deviations = with_calibration(calibration, deviations, design.surface)
    example = "--sd radius=2um, or --calibration calibration.toml"
    refuse_if(not deviations, f"no error is given by --sd; write for example {example}")
    return mf.studies.uncertainty(design.surface, deviations, **options)


@of_design("placements", "seed", short_help="Elastic interaction, and assignments of heights to sites.")
def interaction(design: Design, **options: Any) -> Dataset:
    """Compare the law of interacting asperities with the law of independent asperities.

    The laws are compared for the design and for random assignments of its heights to sites, on a half-space
    and on the bonded layer. The result is the file DIR/interaction.nc.

    Example: metafem study interaction linear --placements 200
    """
    return mf.studies.interaction(design, **options)


@of_design("elements", short_help="The law under every model.")
def fidelity(design: Design, **options: Any) -> Dataset:
    """Compare the laws under all models, from independent asperities to the true block and finite elements.

    The first run takes a minute or two. The result is the file DIR/fidelity.nc.

    Example: metafem study fidelity linear --no-elements
    """
    return mf.studies.fidelity(design, **options)


def given_deviations(given: tuple[str, ...], inputs: Mapping[str, tuple[str, str]]) -> dict[str, float]:
    """Return the standard deviations that --sd states, by the name of the input."""
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
    return found


def with_calibration(
    path: Path, deviations: Mapping[str, float], surface: Surface
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of the inputs from a calibration and from ``--sd``, and their covariance."""
    import numpy as np
    from scipy.linalg import block_diag

    from metafem.studies.uncertainty import nominal_values

    found = mf.files.read_parameters(path)
    twice = ", ".join(name for name in found.parameters if name in deviations)
    refuse_if(twice, f"--sd {twice} and --calibration both give the error of {twice}; keep one")
    designed = nominal_values(surface)
    used = [i for i, name in enumerate(found.parameters) if name in designed]
    names = [found.parameters[i] for i in used]
    for name, sd, value in zip(names, found.sd[used], found.value[used], strict=True):
        if abs(value - designed[name]) > APART * sd:
            message(
                f"{name} of the design is {designed[name]:.4g}, and that of the calibration {value:.4g} ± "
                f"{sd:.2g}; the study has the value of the design with the error of the calibration"
            )
    others = np.diag(np.square([*deviations.values()]))
    return (*names, *deviations), block_diag(found.covariance[np.ix_(used, used)], others)
