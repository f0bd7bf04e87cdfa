"""`metafem compare`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

import metafem as mf
from metafem.cli.group import Name, force_option, json_option, main
from metafem.cli.measurement.pair import PARAMETERS, measured_laws, pair_of, pair_options
from metafem.cli.measurement.quantities import names_of, quantities, quantity_options
from metafem.cli.progress import progress
from metafem.cli.study.options import option_name
from metafem.cli.study.parameters import given_deviations
from metafem.cli.terminal import loaded, print_json, print_study
from metafem.errors import named, refuse_if

# Options of the expected errors of a part: unit, example and help text.
EXPECTED = {
    f"{name}_sd": (unit, example, f"{meaning}, as a standard deviation; 0 leaves it out. Default: {{}}.")
    for name, unit, example, meaning in (
        ("angle", "rad", "0.05deg", "Expected tilt about either axis"),
        ("height_scale", "%", "2%", "Expected error of the scale of all heights"),
        ("composite_modulus", "%", "5%", "Expected error of E*"),
        ("friction", "%", "5%", "Expected error of σB"),
        ("height", "mm", "0.9um", "Expected error of each height"),
    )
}


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
@click.option("--explain", is_flag=True, help="State which errors of the part explain the difference.")
@quantity_options(EXPECTED)
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
    """Compare the law in MEASURED.csv with the law of the design in the result folder DIR.

    The first line of the table names its columns with their units: load_mN,friction_force_mN or
    load_mN,area_mm2. The columns load_sd_mN, friction_force_sd_mN and area_sd_mm2 are optional. Without them,
    the standard deviations are 5 mN for loads, 1 mN + 1 % for friction forces, and 1.4 um of the contacts'
    boundary for areas. Tables of `metafem images` are also read.

    With --explain, errors of the part that explain the difference are fitted: tilt, height scale, E* and
    sigma B. The fit starts from the E*, sigma and B of the comparison. Options such as --friction-sd state
    how large each error is expected to be.

    The results are written to DIR/measured.nc and DIR/explained.nc, and `metafem report DIR` adds them to the
    report.

    Example: metafem compare linear measured.csv --calibration calibration.json --explain
    """
    from metafem.studies.measured import answers, explained, features, measured
    from metafem.studies.summary import summary

    priors = _priors(given, explain)
    with progress(), given_deviations(sd, PARAMETERS) as errors:
        design = loaded(folder)
        pair = pair_of(design.surface, given, errors)
        laws = measured_laws(pair, table, sliding, design.sites)
        path = mf.files.study_path(folder, "measured", force)
        explained_path = mf.files.study_path(folder, "explained", force) if explain else None
        comparisons = [mf.calibration.compare(law, design, **pair.errors(law)) for law in laws]
        dataset = measured(comparisons, design.law.model)
        with named(names_of({name: given[name] for name in EXPECTED})):
            why = explained(mf.calibration.explain(laws[0], design, expected=priors)) if explain else None
        # all files are written at the end, so that a stopped run leaves none that a repeated run would refuse
        mf.files.write_study(dataset, path, force=force)
        if why is not None and explained_path is not None:
            mf.files.write_study(why, explained_path, force=force)
    points, reasons = answers(dataset), [] if why is None else [summary(why).answer]
    if as_json:
        data = {"file": str(path), "answers": points, **mf.files.study_data(dataset)}
        if why is not None:
            found = mf.files.study_data(why)
            data["explanation"] = {"file": str(explained_path), "answers": reasons, **found}
        print_json(data)
        return
    more = features(dataset)
    print_study(dataset, path, points, (more.columns, more.rows, more.title) if more.rows else ())
    if why is not None:
        print_study(why, explained_path, reasons)


def _priors(options: Mapping[str, Any], explain: bool) -> dict[str, float] | None:
    """Return the expected errors that the options state, or None if they state none."""
    texts = {name: options[name] for name in EXPECTED}
    given = [name for name, text in texts.items() if text is not None]
    if not given:
        return None
    refuse_if(not explain, f"{option_name(given[0])} needs --explain")
    for name in given:
        if texts[name].strip() == "0":
            texts[name] = f"0 {EXPECTED[name][0]}"
    values = quantities(EXPECTED, texts).items()
    return {name.removesuffix("_sd"): value for name, value in values if value is not None}
