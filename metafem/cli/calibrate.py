"""The command calibrate."""

from __future__ import annotations

import json
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
    option_name,
    quantities,
    quantity,
    refuse_files,
)
from metafem.cli.output import notes_data, show
from metafem.cli.progress import loaded, progress
from metafem.errors import refuse_if
from metafem.notes import Note, information

if TYPE_CHECKING:
    from metafem.calibration import ContactCalibration, MeasurementErrors, ShearCalibration, StrengthFit
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

# Options of a part in full contact; all of them are needed.
FULL = ("full_contact", "part", "load_min")

# Kind of each written file, by its extension.
SUFFIXES = (".toml", ".json")

# Key, unit and label of each parameter that is printed, with the factor from the unit of the key.
PARAMETERS = (
    ("composite_modulus", "MPa", "E*, composite modulus", 1.0),
    ("modulus_without_adhesion", "MPa", "E* without adhesion", 1.0),
    ("adhesion_energy", "mJ/m²", "w, adhesion energy", 1e6),
    ("area_ratio", "", "B, area ratio", 1.0),
    ("shear_strength", "MPa", "σ, shear strength", 1.0),
    ("full_contact_shear_strength", "MPa", "σ, full contact", 1.0),
)


@command(
    click.argument("data", type=Name(), nargs=-1, metavar="DATA.csv..."),
    *quantities(LENGTHS),
    click.option(
        "--contacts",
        type=click.IntRange(min=1),
        help="Number of contacts under one load, of which the table has the total area. Default: 1, or that "
        "of the columns.",
    ),
    click.option("--poisson-ratio", type=float, help="ν of the material. Default: 0.5."),
    *quantities(ERRORS),
    column_option,
    click.option(
        "--sliding", is_flag=True, help="Use the sliding friction of records instead of the static one."
    ),
    click.option(
        "--contact",
        metavar="LAW",
        help='Contact law of the caps without adhesion, such as "hertz" or the table of a law. Default: '
        "hertz.",
    ),
    click.option(
        "--unusual",
        is_flag=True,
        help="Accept moduli outside 0.01 to 100 MPa, and contact radii outside 0.001 R to R.",
    ),
    click.option(
        "--full-contact",
        type=Name(),
        metavar="TABLE.csv",
        help="Loads and friction forces (load_mN,friction_force_mN) of a part of which all asperities are in "
        "contact: σ follows with its model, E* and B.",
    ),
    click.option("--part", type=Name(), metavar="DIR", help="Result folder of that part."),
    quantity("load_min", "N", "0.5 N", "Smallest load that is used of it, such as {}."),
    click.option(
        "-o",
        "--output",
        type=Name(),
        multiple=True,
        help="Write the sections of a specification (.toml), or values and covariance (.json) for metafem "
        "study uncertainty --calibration; may be repeated.",
    ),
    click.option("--figure", type=Name(), help="Draw the lines and their residuals: a file .svg or .png."),
    force_option,
    json_option,
    short_help="Measure E*, adhesion energy, B and σ from tables of tests.",
)
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
    for path in output:
        refuse_if(path.suffix.lower() not in SUFFIXES, f"--output {path} must end with .toml or .json")
    refuse_files(force, *output, figure=figure)
    sources = [str(path) for path in (*data, options["full_contact"]) if path is not None]
    refuse_if(not sources, "no table is given; write for example metafem calibrate compression.csv shear.csv")
    with progress():
        columns = columns_of(options["column"])
        measured = mf.files.read_calibration(data, sliding=options["sliding"], columns=columns)
        errors = _errors(measured, options)
        contact, shear = _contact(measured, options, errors, sources), _shear(measured, errors, sources)
        strength = _strength(options, contact, shear, errors)
        notes = [*_notes(measured, contact, shear)]
        found = mf.files.calibration_data(contact, shear, sources, strength)
        found["notes"] = notes_data(notes)
        texts = {
            ".toml": mf.files.block_text(contact, shear, sources, options["contact"], strength),
            ".json": json.dumps(found) + "\n",
        }
        for path in output:
            mf.files.write_text(path, texts[path.suffix.lower()], force=force)
        if figure is not None:
            from metafem.calibration.figures import calibration_figure

            drawn = calibration_figure(contact, shear, strength)
            mf.files.write_figure(figure, drawn, "calibration", force=force)
    rows = [row for each in PARAMETERS for row in _row(found, *each)]
    table = ("quantity", "value", "68 % interval", "unit", "± standard deviation"), rows, None
    lines = _verdicts(contact, shear, strength)
    show(as_json, found, tables=[table], lines=lines, notes=notes, files=[*output, figure])


def _errors(measured: CalibrationData, options: Mapping[str, Any]) -> MeasurementErrors:
    """Return standard deviations from the options, else from tables of images, else from the paper."""
    given = {} if measured.boundary is None else {"boundary": measured.boundary}
    given |= {MEMBERS[name]: options[name] for name in ERRORS if options[name] is not None}
    return mf.calibration.MeasurementErrors(**given)


def _contact(
    measured: CalibrationData, options: Mapping[str, Any], errors: MeasurementErrors, sources: list[str]
) -> ContactCalibration | None:
    """Return the calibration of E* and the adhesion energy; None without compression tests."""
    from metafem.models.model import contact_of

    points = measured.compression
    if points is None:
        return None
    radius, count, single = options["radius"], options["contacts"], points.contacts
    example = '--radius "526 um" --radius-sd "5 um"'
    refuse_if(radius is None, f"E* needs the radius of the caps; add for example {example}")
    must = f"the tables hold {single} contacts one by one; leave it out"
    refuse_if(single is not None and count not in (None, single), f"--contacts {count}: {must}")
    with mf.files.of_tables(sources, points.place):
        sample = mf.calibration.Sample(
            contacts=single or count or 1,
            radius_sd=options["radius_sd"] or 0.0,
            poisson_ratio=0.5 if options["poisson_ratio"] is None else options["poisson_ratio"],
            contact=contact_of(mf.files.chosen_model(mf.Independent(), None, options["contact"])),
            unusual=options["unusual"],
        )
        return mf.calibration.fit_compression(
            points.load, points.area, radius, sample, errors=errors, test=points.test
        )


def _shear(
    measured: CalibrationData, errors: MeasurementErrors, sources: list[str]
) -> ShearCalibration | None:
    """Return the calibration of B and sigma; None without shear tests."""
    points = measured.shear
    if points is None:
        return None
    with mf.files.of_tables(sources, points.place):
        given = points.area_before, points.area_sheared, points.friction_force
        return mf.calibration.shear(*given, errors=errors, test=points.test)


def _strength(
    options: Mapping[str, Any],
    contact: ContactCalibration | None,
    shear: ShearCalibration | None,
    errors: MeasurementErrors,
) -> StrengthFit | None:
    """Return the fit of sigma to a part in full contact; None without the options of such a part.

    E* and B are those of the other calibrations or, without them, of the part's result folder.
    """
    missing = [option_name(name) for name in FULL if options[name] is None]
    if len(missing) == len(FULL):
        return None
    example = '--full-contact measured.csv --part linear --load-min "0.5 N"'
    refuse_if(missing, f"{' and '.join(missing)} must be given too, as in {example}")
    design = loaded(options["part"])
    surface = design.surface
    if contact is not None:
        surface = surface.replaced(material=contact.material)
    if shear is not None:
        surface = surface.replaced(friction=shear.friction)
    unknown = f"the part of {options['part']} has no friction; add a shear test"
    refuse_if(surface.friction is None, f"the area ratio B is not known: {unknown}")
    pair = surface.material, surface.friction
    law = mf.files.read_measured_law(options["full_contact"], *pair, errors=errors)
    known: dict[str, Any] = {"model": design.law.model}
    calibrations = [each for each in (contact, shear) if each is not None]
    if calibrations:
        names, covariance = mf.calibration.joint_covariance(*calibrations)
        known |= {"covariance": covariance, "parameters": names}
    return mf.calibration.shear_strength(law, surface, options["load_min"], **known)


def _row(found: Mapping[str, Any], name: str, unit: str, label: str, factor: float) -> Iterator[Any]:
    """Yield the row of a parameter, if the calibration determined it."""
    from metafem.files.block_text import interval, published, rounded

    key = {"MPa": "_MPa", "mJ/m²": "_N_per_mm"}.get(unit, "")
    adhesive = found.get("adhesion_energy_N_per_mm", 0.0) > 0.0
    if f"{name}{key}" not in found or (name == "modulus_without_adhesion" and adhesive):
        return
    value = factor * found[f"{name}{key}"]
    ends = [factor * end for end in found.get(f"{name}_interval{key}", ())]
    sd = found.get(f"{name}_sd{key}", 0.5 * (ends[-1] - ends[0]) if ends else 0.0)
    low, high = ends or (max(value - sd, 0.0), value + sd)
    yield label, rounded(value, sd), interval((low, high), sd), unit, published(value, sd)


def _verdicts(
    contact: ContactCalibration | None, shear: ShearCalibration | None, strength: StrengthFit | None
) -> list[str]:
    """Return whether each law fits, and whether repeated tests agree."""
    lines, tests = [], list[tuple[str, Any]]()
    if contact is not None:
        lines.append(("E* and w", len(contact.load), contact.verdict))
        tests.append(("E* and w", contact))
    if shear is not None:
        verdicts = {"B": shear.area_verdict, "σ": shear.friction_verdict}
        lines += [(name, verdict.freedom + 1, verdict) for name, verdict in verdicts.items()]
        tests.append(("B and σ", shear))
    if strength is not None:
        lines.append(("σ, full contact", len(strength.load), strength.verdict))
    found = [
        f"{name}, {points} points: the law {'fits' if verdict.fits else 'does not fit'}: {verdict}"
        for name, points, verdict in lines
    ]
    for name, fit in tests:
        alike = fit.heterogeneity
        if alike is not None:
            agree = "agree" if alike.fits else "differ"
            found.append(f"{name}, {len(fit.tests)} tests: the tests {agree}: {alike}")
    return found


def _notes(
    measured: CalibrationData, contact: ContactCalibration | None, shear: ShearCalibration | None
) -> Iterator[Note]:
    """Yield the notes on the tables, on E* and on B, and one more if E* and B use the same areas."""
    yield from measured.notes
    for found in (contact, shear):
        yield from () if found is None else found.notes
    pressed, sheared = measured.compression, measured.shear
    if pressed is not None and sheared is not None and not set(pressed.place).isdisjoint(sheared.place):
        words = "E* and B follow from the same areas before shear; the covariance of their errors is left out"
        yield information(words)
