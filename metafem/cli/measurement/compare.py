"""`metafem compare`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from metafem.cli.group import Name, force_option, json_option, main
from metafem.cli.measurement.explanation import (
    explain_options,
    explanation,
    given_priors,
    print_explanation,
)
from metafem.cli.progress import progress
from metafem.cli.study.options import option_name, with_options
from metafem.cli.study.parameters import deviation_option, given_deviations
from metafem.cli.terminal import print_notes, print_table, terminal

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.calibration import MeasuredLaw
    from metafem.surface import Friction, Surface

# Parameters of the part whose errors shift all points together: unit and example of each.
PARAMETERS = {
    "composite_modulus": ("MPa", "0.04MPa"),
    "shear_strength": ("MPa", "0.006MPa"),
    "area_ratio": ("1", "0.01"),
}

# The options of the material pair, with what they stand for and their default.
PAIR = {
    "composite_modulus": ('E* of the part, such as "1.36 MPa"', "that of the design"),
    "shear_strength": ('σ of static friction, such as "0.404 MPa"', "that of the design"),
    "area_ratio": ("B of static friction", "that of the design"),
    "sliding_shear_strength": ("σ of sliding friction", "that of static friction"),
    "sliding_area_ratio": ("B of sliding friction", "that of static friction"),
}

pair_options = with_options(
    *(
        click.option(
            option_name(name),
            type=float if name.endswith("ratio") else str,
            metavar="NUMBER" if name.endswith("ratio") else "STRESS",
            help=f"{meaning}. Default: {default}.",
        )
        for name, (meaning, default) in PAIR.items()
    ),
    deviation_option(PARAMETERS),
)


@main.command(short_help="Compare a measured friction law with the design of a folder.")
@click.argument("folder", type=Name(), metavar="DIR")
@click.argument("table", type=Name(), metavar="MEASURED.csv")
@click.option(
    "--sliding",
    type=Name(),
    metavar="TABLE.csv",
    help="Table of the sliding friction law, to be compared beside the static one.",
)
@pair_options
@explain_options
@force_option
@json_option
def compare(
    folder: Path,
    table: Path,
    sliding: Path | None,
    sd: tuple[str, ...],
    explain: bool,
    force: bool,
    as_json: bool,
    **given: Any,
) -> None:
    """Compare the law in MEASURED.csv with the design of the result folder DIR.

    The first line of the table names its columns with their units: load_mN,friction_force_mN or
    load_mN,area_mm2, optionally with load_sd_mN, friction_force_sd_mN and area_sd_mm2; without these the
    errors are 5 mN, 1 mN + 1 % and 1.4 um of the contacts' boundary. Or it is a table of `metafem images`.

    With --explain it also states which errors of the part explain the difference: tilt, height scale, E*,
    sigma B, and the height and radius of each asperity.

    The results are the files DIR/measured.nc and DIR/explained.nc; `metafem report DIR` adds them to the
    report.

    Example: metafem compare linear measured.csv --sd composite_modulus=0.04MPa --explain
    """
    import metafem as mf
    from metafem.files import same_design, study_path, write_study
    from metafem.studies.measured import measured

    path = study_path(folder, "measured", force)
    explained = study_path(folder, "explained", force) if explain else None
    priors = given_priors(given, explain)
    still = same_design(folder)
    design = mf.load(folder)
    with progress(), given_deviations(sd, PARAMETERS) as errors:
        laws = _laws(design.surface, table, sliding, given)
        comparisons = [mf.calibration.compare(law, design, parameters=_of_law(errors, law)) for law in laws]
        dataset = measured(comparisons, design.law.model)
        write_study(dataset, path, force=force, still=still)
        why = None
        if explained is not None:
            why = explanation(laws[0], design, priors)
            write_study(why, explained, force=force, still=still)
    if as_json:
        from metafem.files import study_data

        data = {"file": str(path), **study_data(dataset)}
        if why is not None:
            data["explanation"] = {"file": str(explained), **study_data(why)}
        click.echo(json.dumps(data))
    else:
        _print(dataset, path)
        if why is not None:
            print_explanation(why, explained)


def _laws(surface: Surface, table: Path, sliding: Path | None, given: Mapping[str, Any]) -> list[MeasuredLaw]:
    """Return the measured laws, with the material pair of the options or of the design."""
    from metafem._given import error_names
    from metafem.files import option_names, quantity, read_measured_law
    from metafem.surface import Material

    with error_names(option_names({name: value for name, value in given.items() if isinstance(value, str)})):
        material = surface.material
        if given["composite_modulus"] is not None:
            modulus = quantity("--composite-modulus", given["composite_modulus"], "MPa")
            material = Material(modulus, material.poisson_ratio)
        static = _friction(given, "", surface.friction)
        laws = [(table, static, "static")]
        if sliding is not None:
            laws.append((sliding, _friction(given, "sliding_", static), "sliding"))
    return [read_measured_law(path, material, friction, label=label) for path, friction, label in laws]


def _friction(given: Mapping[str, Any], kind: str, default: Friction | None) -> Friction | None:
    """Return the friction of the options for static or sliding friction."""
    from metafem.errors import InvalidInput
    from metafem.files import quantity
    from metafem.surface import Friction

    stress, ratio = given[f"{kind}shear_strength"], given[f"{kind}area_ratio"]
    option = kind.replace("_", "-")
    if stress is None and ratio is None:
        return default
    if stress is None and default is None:
        raise InvalidInput(
            f"--{option}area-ratio needs --{option}shear-strength, which the design does not state"
        )
    before = (1.0, 1.0) if default is None else (default.shear_strength, default.area_ratio)
    strength = before[0] if stress is None else quantity(f"--{option}shear-strength", stress, "MPa")
    return Friction(strength, before[1] if ratio is None else ratio)


def _of_law(errors: Mapping[str, float], law: MeasuredLaw) -> dict[str, float]:
    """Return the errors that have an effect on a law: areas do not depend on the friction."""
    return {
        name: sd for name, sd in errors.items() if law.friction is not None or name == "composite_modulus"
    }


def _print(dataset: Dataset, path: Path) -> None:
    """Print the points, the features and what they say."""
    from metafem.studies.summaries import summary
    from metafem.studies.summaries.measured import FEATURES, answers, feature_rows

    found = summary(dataset)
    console = terminal()
    print_table(console, found.columns, found.rows, found.title)
    features = feature_rows(dataset)
    if features:
        print_table(console, FEATURES, features, "Features of the target")
    print_notes(console, found.notes)
    for answer in answers(dataset):
        console.print(answer, highlight=False, markup=False, soft_wrap=True)
    console.print(f"wrote {path}", highlight=False, markup=False)
