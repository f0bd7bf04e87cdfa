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
from metafem.cli.measurement.fits import ERRORS, LENGTHS, Fits
from metafem.cli.measurement.quantities import quantity_options
from metafem.cli.progress import progress
from metafem.cli.study.options import seed_option
from metafem.cli.terminal import (
    notes_data,
    print_json,
    print_notes,
    print_table,
    print_written,
    say,
    terminal,
)
from metafem.errors import refuse_if
from metafem.files.measurement.numbers import interval, published, rounded
from metafem.notes import information

if TYPE_CHECKING:
    from metafem.calibration import ContactCalibration, ShearCalibration, StrengthFit
    from metafem.notes import Note

# mJ/m^2 in N/mm.
ENERGY = 1e-6

# Kind of each written file, by its extension.
SUFFIXES = (".toml", ".json")

COLUMNS = ("quantity", "value", "68 % interval", "unit", "± standard deviation", "of the bootstrap")

Row = tuple[str, ...]


@main.command(short_help="Measure E*, adhesion energy, B and σ from tables of tests.")
@click.argument("data", type=Name(), nargs=-1, metavar="DATA.csv...")
@quantity_options(LENGTHS)
@click.option(
    "--contacts",
    type=click.IntRange(min=1),
    help="Number of contacts under one load, of which the table has the total area. Default: 1, or that of "
    "the columns.",
)
@click.option("--poisson-ratio", type=float, help="ν of the material. Default: 0.5.")
@quantity_options(ERRORS)
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
    """Determine composite modulus, adhesion energy, area ratio and shear strength from tables of tests.

    The columns determine the kind of a table. A compression test has load_mN,area_mm2 (or area_1_mm2,
    area_2_mm2 ... for single contacts). A shear test has area_before_mm2,area_sheared_mm2,friction_force_mN.
    The record of one pull has displacement_um,friction_force_mN,area_mm2. Tables of metafem images are also
    read. Each table is one test, unless a column test holds labels. The shear strength σ can also be
    determined from a part in full contact.

    Example: metafem calibrate compression.csv shear.csv --contacts 5 --radius "526 um" --radius-sd "5 um"
    """
    from metafem.calibration.figures import calibration_figure

    for path in output:
        suffix = path.suffix.lower()
        refuse_if(suffix not in SUFFIXES, f"--output {path} must end with .toml or .json")
        mf.files.refuse_existing(path, force)
    if figure is not None:
        mf.files.refuse_figure(figure, force)
    sources = [str(path) for path in (*data, options["full_contact"]) if path is not None]
    refuse_if(not sources, "no table is given; write for example metafem calibrate compression.csv shear.csv")
    with progress():
        distances: Any = tuple(
            mf.files.quantity("--sliding-range", text, "mm", "0.1 mm")
            for text in options["sliding_range"] or ()
        )
        measured = mf.files.read_calibration(
            data, sliding=options["sliding"], sliding_range=distances or None
        )
        fits = Fits(measured, options, sources)
        contact, shear, strength = fits.contact, fits.shear, fits.strength
        notes = _notes(fits)
        found = mf.files.calibration_data(contact, shear, sources, measured.records, strength)
        found["notes"] = notes_data(notes)
        texts = {
            ".toml": mf.files.block_text(contact, shear, sources, options["contact"], strength),
            ".json": json.dumps(found) + "\n",
        }
        for path in output:
            suffix = path.suffix.lower()
            mf.files.write_text(path, texts[suffix], force=force)
        if figure is not None:
            drawn = calibration_figure(contact, shear, strength)
            mf.files.write_figure(figure, drawn, "calibration", force=force)
    if as_json:
        print_json(found)
        return
    _print(fits, notes)
    print_written([*output, figure])


def _print(fits: Fits, notes: list[Note]) -> None:
    """Print the values with their intervals, the verdicts on the fits, the records and the notes."""
    console = terminal()
    parts: list[tuple[list[Row], list[str]]] = []
    if fits.contact is not None:
        parts.append(_of_contact(fits.contact))
    if fits.shear is not None:
        parts.append(_of_shear(fits.shear))
    if fits.strength is not None:
        parts.append(_of_strength(fits.strength))
    rows = [row for part, _ in parts for row in part]
    lines = [line for _, verdicts in parts for line in verdicts]
    count = len(COLUMNS) - (not any(row[-1] for row in rows))
    print_table(console, COLUMNS[:count], [row[:count] for row in rows])
    for name, record in fits.measured.records.items():
        lines.append(
            f"{name}: static {record.static_force:.4g} N at {record.peak_displacement:.4g} mm, sliding "
            f"{record.sliding_force:.4g} N"
        )
    say(console, *lines)
    print_notes(console, notes)


def _row(what: str, value: float, sd: float, ends: tuple[float, float], unit: str, drawn: Any = None) -> Row:
    """Return the row of a parameter; `drawn` holds its values in a bootstrap."""
    spread = None if drawn is None or len(drawn) < 2 else float(drawn.std(ddof=1))
    scatter = "" if spread is None else rounded(spread, spread)
    return what, rounded(value, sd), interval(ends, sd), unit, published(value, sd), scatter


def _of_contact(found: ContactCalibration) -> tuple[list[Row], list[str]]:
    """Return the rows of E* and the adhesion energy, and the verdicts on their fits."""
    from metafem.calibration.bounded_interval import bounded_interval

    sd = math.sqrt(found.root_covariance[0, 0])
    drawn = None if found.bootstrap is None else found.bootstrap[:, 0]
    ends = found.composite_modulus_interval
    rows = [_row("E*, composite modulus", found.composite_modulus, sd, ends, "MPa", drawn)]
    if found.adhesion_energy <= 0.0:
        alone, without = found.modulus_without_adhesion
        low, high = (float(end) for end in bounded_interval(alone, without))
        rows.append(_row("E* without adhesion", alone, without, (low, high), "MPa"))
    energy = found.adhesion_energy / ENERGY
    low, high = (end / ENERGY for end in found.adhesion_energy_interval)
    width = 0.5 * (high - low)
    value, more, less = (rounded(each, width, 1) for each in (energy, high - energy, energy - low))
    within, apart = interval((low, high), width), f"{value} +{more} -{less}"
    rows.append(("w, adhesion energy", rounded(energy, width), within, "mJ/m²", apart, ""))
    verdicts = [f"E* and w, {len(found.load)} points: {found.verdict}"]
    if found.heterogeneity is not None:
        verdicts.append(f"E* and w, {len(found.tests)} tests: {found.heterogeneity}")
    return rows, verdicts


def _of_shear(found: ShearCalibration) -> tuple[list[Row], list[str]]:
    """Return the rows of B and the shear strength, and the verdicts on their fits."""
    rows, verdicts = [], []
    sds = np.sqrt(np.diagonal(found.covariance)).tolist()
    for i, (name, what, unit, verdict) in enumerate(
        (
            ("area_ratio", "B, area ratio", "", found.area_verdict),
            ("shear_strength", "σ, shear strength", "MPa", found.friction_verdict),
        )
    ):
        drawn = None if found.bootstrap is None else found.bootstrap[:, i]
        rows.append(_row(what, getattr(found, name), sds[i], getattr(found, f"{name}_interval"), unit, drawn))
        verdicts.append(f"{what[0]}, {verdict.freedom + 1} points: {verdict}")
    if found.heterogeneity is not None:
        verdicts.append(f"B and σ, {len(found.tests)} tests: {found.heterogeneity}")
    return rows, verdicts


def _of_strength(found: StrengthFit) -> tuple[list[Row], list[str]]:
    """Return the row of the shear strength with all asperities in contact, and the verdict on its fit."""
    sd, what = math.sqrt(found.covariance[-1, -1]), "σ, full contact"
    row = _row(what, found.shear_strength, sd, found.shear_strength_interval, "MPa")
    return [row], [f"{what}, {len(found.load)} points: {found.verdict}"]


def _notes(fits: Fits) -> list[Note]:
    """Return the notes on the tables, on E* and on B, and one more if E* and B use the same areas."""
    pressed, sheared = fits.measured.compression, fits.measured.shear
    notes = [*fits.measured.notes]
    for found, points in ((fits.contact, pressed), (fits.shear, sheared)):
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
