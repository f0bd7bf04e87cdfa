"""The command calibrate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli.options import (
    Name,
    column_option,
    columns_of,
    command,
    file_option,
    force_option,
    json_option,
    quantities,
    refuse_files,
)
from metafem.cli.output import notes_data, progress, show
from metafem.errors import InvalidInput, refuse_if

if TYPE_CHECKING:
    from pandas import DataFrame

    from metafem.calibration import Calibration, MeasurementErrors

# Options of the radius and of the standard deviations: unit, example and help text.
RADIUS = {"radius": ("mm", "526 um", "Radius of the caps, such as {}; needed for E*.")}
ERRORS = {
    "radius_sd": ("mm", "5 um", "Standard deviation of the radius, such as {}. Default: 0."),
    "load_error": ("N", "5 mN", "Standard deviation of a load. Default: {}."),
    "boundary_error": (
        "mm",
        "1.4 um",
        "Standard deviation of the boundary of a contact. Default: {}, or that of the tables of images.",
    ),
    "friction_error": ("N", "1 mN", "Standard deviation of a friction force at zero. Default: {}."),
    "friction_relative_error": (
        "%",
        "1 %",
        "Standard deviation of a friction force in proportion to it. Default: {}.",
    ),
}

# Member of MeasurementErrors for each option of a standard deviation.
MEMBERS = ("radius_sd", "load", "boundary", "friction_force", "friction_relative")

# Name of each quantity that is printed.
NAMES = {
    "composite_modulus": "E*, composite modulus",
    "adhesion_energy": "w, adhesion energy",
    "radius": "R, radius of the caps",
    "area_ratio": "B, area ratio",
    "shear_strength": "σ, shear strength",
}


@command(
    click.argument("data", type=Name(), nargs=-1, metavar="DATA.csv..."),
    *quantities(RADIUS),
    click.option(
        "--contacts",
        default=1,
        help="Number of contacts under one load, of which a table has the total area. Default: 1.",
    ),
    *quantities(ERRORS),
    column_option,
    click.option(
        "--unusual",
        is_flag=True,
        help="Accept moduli outside 0.01 to 100 MPa, and contact radii outside 0.001 R to R.",
    ),
    file_option(
        "-o --output",
        "FILE.toml",
        "Write sections of a specification, with the covariance for metafem study uncertainty "
        "--calibration and metafem compare --calibration.",
    ),
    force_option,
    json_option,
    short_help="Measure E*, adhesion energy, B and σ from tables of tests.",
)
def calibrate(
    data: tuple[Path, ...], output: Path | None, force: bool, as_json: bool, **options: Any
) -> None:
    """Determine composite modulus, adhesion energy, area ratio and shear strength from tables of tests.

    The columns determine the kind of a table. A compression test has load_mN,area_mm2. A shear test has
    area_before_mm2,area_sheared_mm2,friction_force_mN. Tables of metafem images are also read. Each table is
    one test, unless a column test holds labels.

    Example: metafem calibrate compression.csv shear.csv --contacts 5 --radius "526 um" --radius-sd "5 um"
    """
    wrong = output is not None and output.suffix.lower() != ".toml"
    refuse_if(wrong, f"--output {output} must end with .toml")
    refuse_files(force, output)
    sources = [str(path) for path in data]
    refuse_if(not sources, "no table is given; write for example metafem calibrate compression.csv shear.csv")
    pairs = zip(MEMBERS, map(options.get, ERRORS), strict=True)
    given = {name: value for name, value in pairs if value is not None}
    with progress():
        pressed, slid, boundary, notes = mf.files.read_calibration(
            data, columns=columns_of(options["column"])
        )
        errors = mf.calibration.MeasurementErrors(**({"boundary": boundary} if boundary else {}) | given)
        try:
            found = [*_fitted(pressed, slid, errors, options)]
        except InvalidInput as error:
            if error.key and "[" not in error.key:  # an option
                raise
            raise InvalidInput(f"{', '.join(sources)}: {error}") from None
        notes = [*notes, *(note for each in found for note in each.notes)]
        if output is not None:
            text = mf.files.calibration_text(*found, sources=sources)
            mf.files.write_text(output, text, force=force)
    results = {"files": sources, **mf.files.calibration_data(*found), "notes": notes_data(notes)}
    stated = [pair for each in found for pair in each.estimates.items()]
    rows = [[NAMES[name], *mf.files.printed(name, estimate)] for name, estimate in stated]
    table = ("quantity", "value", "68 % interval", "unit", "± standard deviation"), rows, None
    lines = [text for each in found for text in _verdicts(each)]
    show(as_json, results, tables=[table], lines=lines, notes=notes, files=[output])


def _fitted(
    pressed: DataFrame | None, slid: DataFrame | None, errors: MeasurementErrors, options: Mapping[str, Any]
) -> Iterator[Calibration]:
    """Yield the calibrations by compression and by shear tests, where there are such tests."""
    radius = options["radius"]
    if pressed is not None:
        example = '--radius "526 um" --radius-sd "5 um"'
        refuse_if(radius is None, f"E* needs the radius of the caps; add for example {example}")
        area, more = pressed.filter(like="area"), {name: options[name] for name in ("contacts", "unusual")}
        yield mf.calibration.fit_compression(
            pressed["load"], area, radius, errors=errors, test=pressed["test"], **more
        )
    if slid is not None:
        values = (slid[name] for name in ("area_before", "area_sheared", "friction_force"))
        yield mf.calibration.shear(*values, errors=errors, test=slid["test"])


def _verdicts(found: Calibration) -> Iterator[str]:
    """Yield whether the law fits, and whether repeated tests agree."""
    what = " and ".join(NAMES[name].partition(",")[0] for name in found.estimates if name != "radius")
    yield f"{what}: the law {'fits' if found.verdict.fits else 'does not fit'}: {found.verdict}"
    alike = found.heterogeneity
    if alike is not None:
        yield f"{what}: the tests {'agree' if alike.fits else 'differ'}: {alike}"
