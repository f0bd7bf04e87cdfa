"""`metafem calibrate`."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

import metafem as mf
from metafem._given import Names
from metafem.cli.group import Name, force_option, json_option, main, model_option
from metafem.cli.measurement.fits import (
    ERRORS,
    LENGTHS,
    errors_of,
    fitted_contact,
    fitted_shear,
    fitted_strength,
    sliding_range,
    written_names,
)
from metafem.cli.progress import progress
from metafem.cli.study.options import option_name, seed_option, with_options
from metafem.cli.terminal import (
    notes_data,
    print_json,
    print_notes,
    print_table,
    print_written,
    say,
    terminal,
)
from metafem.errors import InvalidInput
from metafem.notes import information

if TYPE_CHECKING:
    from metafem.calibration import ContactCalibration, ShearCalibration, StrengthFit
    from metafem.files import CalibrationData
    from metafem.notes import Note

# mJ/m^2 in N/mm.
ENERGY = 1e-6

error_options = with_options(
    *(
        click.option(
            option_name(name),
            metavar="PERCENT" if unit == "%" else "QUANTITY",
            help=f"Standard deviation {what}. Default: {default}"
            + (", or that of the tables of images." if name == "boundary_error" else "."),
        )
        for name, (_, unit, default, what) in ERRORS.items()
    )
)

length_options = with_options(
    *(
        click.option(option_name(name), metavar="LENGTH", help=what.format(f'"{shown}"'))
        for name, (shown, what) in LENGTHS.items()
    )
)


@main.command(short_help="Measure E*, adhesion energy, B and σ from tables of tests.")
@click.argument("data", type=Name(), nargs=-1, metavar="DATA.csv...")
@length_options
@click.option(
    "--contacts",
    type=click.IntRange(min=1),
    help="Number of contacts under one load, of which the table has the total area. Default: 1, or that of "
    "the columns.",
)
@click.option("--poisson-ratio", type=float, help="ν of the material. Default: 0.5.")
@error_options
@click.option(
    "--sliding", is_flag=True, help="Use the sliding friction of records instead of the static one."
)
@click.option(
    "--sliding-range",
    nargs=2,
    metavar="FROM TO",
    help='Distances after the peak, such as "0.1 mm" "0.2 mm", over which sliding friction is averaged. '
    "Default: these.",
)
@click.option(
    "--sample",
    type=Name(),
    metavar="HEIGHTS.csv",
    help="Table of the sample's caps (x_mm,y_mm,height_um), for --model. Default: the contacts of a table of "
    "metafem images, with equal heights.",
)
@model_option("independent")
@click.option(
    "--full-contact",
    type=Name(),
    metavar="TABLE.csv",
    help="Loads and friction forces (load_mN,friction_force_mN) of a part of which all asperities are in "
    "contact: σ follows with its model, E* and B.",
)
@click.option("--part", type=Name(), metavar="DIR", help="Result folder of that part.")
@click.option("--load-min", metavar="FORCE", help='Smallest load that is used of it, such as "0.5 N".')
@click.option("--robust", is_flag=True, help="Fit E* and w with small weights of outliers.")
@click.option(
    "--bootstrap", type=click.IntRange(min=2), help="Also fit this number of times to points drawn again."
)
@seed_option
@click.option(
    "-o",
    "--output",
    type=Name(),
    multiple=True,
    help="Write the sections of a specification (.toml), or values and covariance (.json) for metafem study "
    "uncertainty --calibration; may be repeated.",
)
@click.option("--figure", type=Name(), help="Draw the lines and their residuals: a file .svg or .png.")
@force_option
@json_option
def calibrate(
    data: tuple[Path, ...],
    output: tuple[Path, ...],
    figure: Path | None,
    force: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Measure composite modulus, adhesion energy, area ratio and shear strength from tables of tests.

    The columns of a table say what it holds: load_mN,area_mm2 (or area_1_mm2,area_2_mm2 ... of single
    contacts) a compression test, area_before_mm2,area_sheared_mm2,friction_force_mN a shear test, and
    displacement_um,friction_force_mN,area_mm2 the record of one pull; or it is a table of metafem images.
    Each table is a test, unless a column test holds labels. σ may also follow from a part in full contact.

    Example: metafem calibrate compression.csv shear.csv --contacts 5 --radius "526 um" --radius-sd "5 um"
    """
    from metafem.calibration.figures import calibration_figure

    kinds = {".toml": "sections", ".json": "calibration"}
    for path in output:
        if path.suffix.lower() not in kinds:
            raise InvalidInput(f"--output {path} must end with .toml or .json")
        mf.files.refuse_existing(path, force, kinds[path.suffix.lower()])
    if figure is not None:
        mf.files.refuse_figure(figure, force)
    sources = [str(path) for path in (*data, options["full_contact"]) if path is not None]
    if not sources:
        raise InvalidInput("no table is given; write for example metafem calibrate compression.csv shear.csv")
    with progress():
        measured = mf.files.read_calibration(
            data, sliding=options["sliding"], sliding_range=sliding_range(options)
        )
        names = written_names(options)
        errors = errors_of(options, measured)
        contact = fitted_contact(measured, options, errors, names, sources)
        shear = fitted_shear(measured, options, errors, names, sources)
        strength = fitted_strength(options, errors, contact, shear)
        found = mf.files.calibration_data(contact, shear, sources, measured.records, strength)
        found["notes"] = notes_data(_notes(contact, shear, measured))
        text = json.dumps(found)
        for path in output:
            suffix = path.suffix.lower()
            content = (
                mf.files.block_text(contact, shear, sources, options["contact"], strength)
                if suffix == ".toml"
                else text + "\n"
            )
            mf.files.write_text(path, content, force=force, kind=kinds[suffix])
        if figure is not None:
            mf.files.write_figure(
                figure, calibration_figure(contact, shear, strength), "calibration", force=force
            )
    if as_json:
        print_json(found)
        return
    _print(contact, shear, strength, measured)
    print_written([*output, figure])


def _print(
    contact: ContactCalibration | None,
    shear: ShearCalibration | None,
    strength: StrengthFit | None,
    measured: CalibrationData,
) -> None:
    """Print the values with their intervals, the verdicts and the tests."""
    from metafem.calibration.bounded_interval import bounded_interval
    from metafem.files.measurement.numbers import interval, published, rounded

    console = terminal()
    rows: list[tuple[str, ...]] = []
    lines = []

    def row(what: str, value: float, ends: tuple[float, float], sd: float, unit: str, drawn: Any) -> None:
        scatter = "" if drawn is None else rounded(float(drawn), float(drawn))
        rows.append((what, rounded(value, sd), interval(ends, sd), unit, published(value, sd), scatter))

    if contact is not None:
        sd = math.sqrt(contact.root_covariance[0, 0])
        draws = contact.bootstrap
        drawn = None if draws is None or len(draws) < 2 else draws[:, 0].std(ddof=1)
        ends = contact.composite_modulus_interval
        row("E*, composite modulus", contact.composite_modulus, ends, sd, "MPa", drawn)
        if contact.adhesion_energy <= 0.0:
            alone, without = contact.modulus_without_adhesion
            low, high = (float(end) for end in bounded_interval(alone, without))
            row("E* without adhesion", alone, (low, high), without, "MPa", None)
        energy = contact.adhesion_energy / ENERGY
        low, high = (end / ENERGY for end in contact.adhesion_energy_interval)
        width = 0.5 * (high - low)
        more, less = rounded(high - energy, width, 1), rounded(energy - low, width, 1)
        apart = f"{rounded(energy, width, 1)} +{more} -{less}"
        within = interval((low, high), width)
        rows.append(("w, adhesion energy", rounded(energy, width), within, "mJ/m²", apart, ""))
        lines.append(f"E* and w, {len(contact.load)} points: {contact.verdict}")
        if contact.heterogeneity is not None:
            lines.append(f"E* and w, {len(contact.tests)} tests: {contact.heterogeneity}")
    if shear is not None:
        ratio_sd, strength_sd = np.sqrt(np.diagonal(shear.covariance)).tolist()
        spread = (None, None) if shear.bootstrap is None else shear.bootstrap.std(axis=0, ddof=1).tolist()
        row("B, area ratio", shear.area_ratio, shear.area_ratio_interval, ratio_sd, "", spread[0])
        ends = shear.shear_strength_interval
        row("σ, shear strength", shear.shear_strength, ends, strength_sd, "MPa", spread[1])
        for name, verdict in (("B", shear.area_verdict), ("σ", shear.friction_verdict)):
            lines.append(f"{name}, {verdict.freedom + 1} points: {verdict}")
        if shear.heterogeneity is not None:
            lines.append(f"B and σ, {len(shear.tests)} tests: {shear.heterogeneity}")
    if strength is not None:
        sd, ends = math.sqrt(strength.covariance[-1, -1]), strength.shear_strength_interval
        row("σ, full contact", strength.shear_strength, ends, sd, "MPa", None)
        lines.append(f"σ, full contact, {len(strength.load)} points: {strength.verdict}")
    columns = ["quantity", "value", "68 % interval", "unit", "± standard deviation", "of the bootstrap"]
    if all(not each[-1] for each in rows):
        columns, rows = columns[:-1], [each[:-1] for each in rows]
    print_table(console, columns, rows)
    for name, record in measured.records.items():
        lines.append(
            f"{name}: static {record.static_force:.4g} N at {record.peak_displacement:.4g} mm, sliding "
            f"{record.sliding_force:.4g} N"
        )
    say(console, *lines)
    print_notes(console, _notes(contact, shear, measured))


def _notes(
    contact: ContactCalibration | None, shear: ShearCalibration | None, measured: CalibrationData
) -> list[Note]:
    """Return the notes of both calibrations, and one on areas that both have."""
    pressed, sheared = measured.compression, measured.shear
    notes = [*measured.notes]
    for found, points in ((contact, pressed), (shear, sheared)):
        if found is not None and points is not None:
            notes += [note.named(Names(places=points.place)) for note in found.notes]
    if pressed is not None and sheared is not None and not set(pressed.place).isdisjoint(sheared.place):
        notes.append(
            information(
                "E* and B follow from the same areas before shear; the covariance that their errors cause is "
                "left out"
            )
        )
    return notes
