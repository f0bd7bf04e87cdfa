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
    force_option,
    json_option,
    quantities,
    refuse_files,
)
from metafem.cli.output import notes_data, show
from metafem.cli.progress import progress
from metafem.errors import refuse_if
from metafem.notes import Note, information

if TYPE_CHECKING:
    from metafem.calibration import ContactCalibration, MeasurementErrors, ShearCalibration
    from metafem.files import CalibrationData

# Options of the dimensions of a sample, and of the standard deviations: unit, example and help text.
LENGTHS = {
    "radius": ("mm", "526 um", "Radius of the caps, such as {}; needed for E*."),
    "radius_sd": ("mm", "5 um", "Its standard deviation, such as {}. Default: 0."),
}
ERRORS = {
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
MEMBERS = dict(zip(ERRORS, ("load", "boundary", "friction_force", "friction_relative"), strict=True))

# Name, unit and size of the unit of each quantity that is printed.
PRINTED = {
    "composite_modulus": ("E*, composite modulus", "MPa", 1.0),
    "adhesion_energy": ("w, adhesion energy", "mJ/m²", 1e-6),
    "area_ratio": ("B, area ratio", "", 1.0),
    "shear_strength": ("σ, shear strength", "MPa", 1.0),
}


@command(
    click.argument("data", type=Name(), nargs=-1, metavar="DATA.csv..."),
    *quantities(LENGTHS),
    click.option(
        "--contacts",
        type=click.IntRange(min=1),
        help="Number of contacts under one load, of which the table has the total area. Default: 1, or that "
        "of the columns.",
    ),
    *quantities(ERRORS),
    column_option,
    click.option(
        "--contact",
        metavar="LAW",
        help='Contact law of the caps without adhesion, such as "elastic" or the table of a law. Default: '
        "hertz.",
    ),
    click.option(
        "--unusual",
        is_flag=True,
        help="Accept moduli outside 0.01 to 100 MPa, and contact radii outside 0.001 R to R.",
    ),
    click.option(
        "-o",
        "--output",
        type=Name(),
        metavar="FILE.toml",
        help="Write sections of a specification, with the covariance for metafem study uncertainty "
        "--calibration and metafem compare --calibration.",
    ),
    force_option,
    json_option,
    short_help="Measure E*, adhesion energy, B and σ from tables of tests.",
)
def calibrate(
    data: tuple[Path, ...],
    output: Path | None,
    force: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Determine composite modulus, adhesion energy, area ratio and shear strength from tables of tests.

    The columns determine the kind of a table. A compression test has load_mN,area_mm2 (or area_1_mm2,
    area_2_mm2 ... for single contacts). A shear test has area_before_mm2,area_sheared_mm2,friction_force_mN.
    The record of one pull has displacement_um,friction_force_mN,area_mm2. Tables of metafem images are also
    read. Each table is one test, unless a column test holds labels.

    Example: metafem calibrate compression.csv shear.csv --contacts 5 --radius "526 um" --radius-sd "5 um"
    """
    wrong = output is not None and output.suffix.lower() != ".toml"
    refuse_if(wrong, f"--output {output} must end with .toml")
    refuse_files(force, output)
    sources = [str(path) for path in data]
    refuse_if(not sources, "no table is given; write for example metafem calibrate compression.csv shear.csv")
    with progress():
        columns = columns_of(options["column"])
        measured = mf.files.read_calibration(data, columns=columns)
        given = {} if measured.boundary is None else {"boundary": measured.boundary}
        given |= {MEMBERS[name]: options[name] for name in ERRORS if options[name] is not None}
        errors = mf.calibration.MeasurementErrors(**given)
        contact, shear = _contact(measured, options, errors, sources), _shear(measured, errors, sources)
        found = [each for each in (contact, shear) if each is not None]
        notes = [*measured.notes, *(note for each in found for note in each.notes), *_shared(measured)]
        if output is not None:
            cap = mf.files.section_named(options["contact"].split()) if options["contact"] else None
            text = mf.files.calibration_text(contact, shear, sources=sources, cap=cap)
            mf.files.write_text(output, text, force=force)
    results = {"files": sources, **mf.files.calibration_data(contact, shear)}
    table = ("quantity", "value", "68 % interval", "unit", "± standard deviation"), [*_rows(found)], None
    lines = [text for each in found for text in _verdicts(each)]
    data_of_notes = {"notes": notes_data(notes)}
    show(as_json, results | data_of_notes, tables=[table], lines=lines, notes=notes, files=[output])


def _contact(
    measured: CalibrationData, options: Mapping[str, Any], errors: MeasurementErrors, sources: list[str]
) -> ContactCalibration | None:
    """Return the calibration of E* and the adhesion energy; None without compression tests."""
    points, radius, count = measured.compression, options["radius"], options["contacts"]
    if points is None:
        return None
    example = '--radius "526 um" --radius-sd "5 um"'
    refuse_if(radius is None, f"E* needs the radius of the caps; add for example {example}")
    must = f"the tables hold {measured.contacts} contacts one by one; leave it out"
    refuse_if(measured.contacts is not None and count not in (None, measured.contacts), f"--contacts: {must}")
    given = {"contact": mf.files.contact_named(options["contact"])} if options["contact"] else {}
    with mf.files.of_tables(sources, points.place):
        sample = mf.calibration.Sample(
            contacts=measured.contacts or count or 1,
            radius_sd=options["radius_sd"] or 0.0,
            unusual=options["unusual"],
            **given,
        )
        load, area = points.values
        return mf.calibration.fit_compression(load, area, radius, sample, errors=errors, test=points.test)


def _shear(
    measured: CalibrationData, errors: MeasurementErrors, sources: list[str]
) -> ShearCalibration | None:
    """Return the calibration of B and sigma; None without shear tests."""
    points = measured.shear
    if points is None:
        return None
    with mf.files.of_tables(sources, points.place):
        return mf.calibration.shear(*points.values, errors=errors, test=points.test)


def _rows(found: list[Any]) -> Iterator[list[str]]:
    """Yield the row of each quantity."""
    from metafem.calibration.statistics import Estimate

    for each in found:
        for name, (value, sd, (low, high)) in each.estimates.items():
            label, unit, size = PRINTED[name]
            scaled = Estimate(value / size, sd / size, (low / size, high / size))
            if name == "adhesion_energy":  # whose interval is asymmetric
                scaled = scaled._replace(sd=0.5 * (high - low) / size)
            number, deviation = (mf.files.rounded(part, scaled.sd) for part in scaled[:2])
            yield [label, number, mf.files.interval(scaled), unit, deviation]


def _verdicts(found: Any) -> Iterator[str]:
    """Yield whether each law fits, and whether repeated tests agree."""
    for line in found.lines:
        fits, points = line.verdict.fits, line.verdict.freedom + line.parameters
        yield f"{line.name}, {points} points: the law {'fits' if fits else 'does not fit'}: {line.verdict}"
    alike = found.heterogeneity
    if alike is not None:
        what = " and ".join(line.name for line in found.lines)
        yield f"{what}, {len(found.tests)} tests: the tests {'agree' if alike.fits else 'differ'}: {alike}"


def _shared(measured: CalibrationData) -> Iterator[Note]:
    """Yield a note if E* and B use the same areas."""
    pressed, sheared = measured.compression, measured.shear
    if pressed is not None and sheared is not None and not set(pressed.place).isdisjoint(sheared.place):
        words = "E* and B follow from the same areas before shear; the covariance of their errors is left out"
        yield information(words)
