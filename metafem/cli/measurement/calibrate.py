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
from metafem.cli.group import Name, force_option, json_option, main
from metafem.cli.measurement.fits import ERRORS, LENGTHS, Fits
from metafem.cli.measurement.quantities import quantity_options
from metafem.cli.progress import progress
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
    from collections.abc import Sequence

    from metafem.calibration import ContactCalibration, ShearCalibration, StrengthFit, Verdict
    from metafem.notes import Note

# mJ/m^2 in N/mm.
ENERGY = 1e-6

# Kind of each written file, by its extension.
SUFFIXES = (".toml", ".json")

COLUMNS = ("quantity", "value", "68 % interval", "unit", "± standard deviation")

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
    "--contact",
    metavar="LAW",
    help='Contact law of the caps without adhesion, such as "hertz" or the table of a law. Default: hertz.',
)
@click.option(
    "--unusual",
    is_flag=True,
    help="Accept moduli outside 0.01 to 100 MPa, and contact radii outside 0.001 R to R.",
)
@click.option(
    "--full-contact",
    type=Name(),
    metavar="TABLE.csv",
    help="Loads and friction forces (load_mN,friction_force_mN) of a part of which all asperities are in "
    "contact: σ follows with its model, E* and B.",
)
@click.option("--part", type=Name(), metavar="DIR", help="Result folder of that part.")
@click.option("--load-min", metavar="FORCE", help='Smallest load that is used of it, such as "0.5 N".')
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
        measured = mf.files.read_calibration(data, sliding=options["sliding"])
        fits = Fits(measured, options, sources)
        contact, shear, strength = fits.contact, fits.shear, fits.strength
        notes = _notes(fits)
        found = mf.files.calibration_data(contact, shear, sources, strength)
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
    """Print the values with their intervals, the verdicts on the fits and the notes."""
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
    print_table(console, COLUMNS, rows)
    say(console, *lines)
    print_notes(console, notes)


def _row(what: str, value: float, sd: float, ends: tuple[float, float], unit: str) -> Row:
    """Return the row of a parameter."""
    return what, rounded(value, sd), interval(ends, sd), unit, published(value, sd)


def _fits(verdict: Verdict) -> str:
    return f"the law {'fits' if verdict.fits else 'does not fit'}: {verdict}"


def _agree(what: str, tests: Sequence[object], verdict: Verdict) -> str:
    return f"{what}, {len(tests)} tests: the tests {'agree' if verdict.fits else 'differ'}: {verdict}"


def _of_contact(found: ContactCalibration) -> tuple[list[Row], list[str]]:
    """Return the rows of E* and the adhesion energy, and the verdicts on their fits."""
    from metafem.calibration.statistics import bounded_interval

    sd = math.sqrt(found.root_covariance[0, 0])
    ends = found.composite_modulus_interval
    rows = [_row("E*, composite modulus", found.composite_modulus, sd, ends, "MPa")]
    if not found.adhesive:
        alone, without = found.modulus_without_adhesion
        low, high = (float(end) for end in bounded_interval(alone, without))
        rows.append(_row("E* without adhesion", alone, without, (low, high), "MPa"))
    energy = found.adhesion_energy / ENERGY
    low, high = (end / ENERGY for end in found.adhesion_energy_interval)
    width = 0.5 * (high - low)
    value, more, less = (rounded(each, width, 1) for each in (energy, high - energy, energy - low))
    within, apart = interval((low, high), width), f"{value} +{more} -{less}"
    rows.append(("w, adhesion energy", rounded(energy, width), within, "mJ/m²", apart))
    verdicts = [f"E* and w, {len(found.load)} points: {_fits(found.verdict)}"]
    if found.heterogeneity is not None:
        verdicts.append(_agree("E* and w", found.tests, found.heterogeneity))
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
        rows.append(_row(what, getattr(found, name), sds[i], getattr(found, f"{name}_interval"), unit))
        verdicts.append(f"{what[0]}, {verdict.freedom + 1} points: {_fits(verdict)}")
    if found.heterogeneity is not None:
        verdicts.append(_agree("B and σ", found.tests, found.heterogeneity))
    return rows, verdicts


def _of_strength(found: StrengthFit) -> tuple[list[Row], list[str]]:
    """Return the row of the shear strength with all asperities in contact, and the verdict on its fit."""
    sd, what = math.sqrt(found.covariance[-1, -1]), "σ, full contact"
    row = _row(what, found.shear_strength, sd, found.shear_strength_interval, "MPa")
    return [row], [f"{what}, {len(found.load)} points: {_fits(found.verdict)}"]


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
