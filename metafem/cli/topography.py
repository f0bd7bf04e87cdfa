"""The command topography: a made surface on a height map."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem._given import printable
from metafem.cli.options import Name, command, force_option, json_option, refuse_files
from metafem.cli.output import Printed, notes_data, show
from metafem.cli.progress import loaded, progress
from metafem.errors import InvalidInput

if TYPE_CHECKING:
    from metafem.calibration import MadeSurface
    from metafem.inversion import Design
    from metafem.prediction import FrictionLaw

# Number of loads at which the two laws are printed.
LOADS = 5

UM = 1e3

# Decimals to which a mean is rounded. The alignment makes the mean position errors 0 up to rounding errors,
# which are not printed.
DIGITS = 6


@command(
    click.argument("height_map", type=Name(), metavar="MAP"),
    click.option(
        "--design", "folder", type=Name(), metavar="DIR", required=True, help="Result folder of the design."
    ),
    click.option(
        "--pixel",
        metavar="LENGTH",
        help='Distance of two pixels, such as "2 um", if the map does not state it.',
    ),
    click.option(
        "--height-unit",
        metavar="UNIT",
        help='Unit of the heights, such as "um", if the map does not state it.',
    ),
    click.option("--mould", is_flag=True, help="The map shows the mould: its holes are the caps."),
    click.option(
        "--common-radius",
        is_flag=True,
        help="All caps have one radius; the errors of the heights are then halved.",
    ),
    click.option("--keep-bow", is_flag=True, help="Subtract a plane only, no bow."),
    click.option(
        "-o", "--output", type=Name(), help="Write the made surface to this CSV file, for metafem predict."
    ),
    click.option(
        "--picture", type=Name(), help="Draw height errors, residual map and laws: a file .svg or .png."
    ),
    force_option,
    json_option,
    short_help="Measure a made surface on a height map.",
)
def topography(
    height_map: Path,
    folder: Path,
    pixel: str | None,
    height_unit: str | None,
    keep_bow: bool,
    output: Path | None,
    picture: Path | None,
    force: bool,
    as_json: bool,
    **options: bool,
) -> None:
    """Measure heights, radii and positions of the asperities in MAP, and compare them with the design.

    MAP is a height map in the format .x3p, .sur, .plux, .npy or in another format of a microscope. It
    is seen from the side of the asperities. Tilt and bow are subtracted, and a sphere is fitted to each cap.

    Example: metafem topography part.x3p --design linear -o made.csv --picture made.svg
    """
    refuse_files(force, output, figure=picture)
    with progress():
        design = loaded(folder)
        stored = mf.files.read_height_map(height_map, pixel, height_unit)
        options["bow"] = not keep_bow
        try:
            made = mf.calibration.made_surface(stored.values, stored.pixel, design.surface, **options)
        except InvalidInput as error:
            raise InvalidInput(f"{printable(str(height_map))}: {error}") from None
        law = mf.friction_law(made.surface, design.law.model, load=design.law.load)
        if picture is not None:
            from metafem.calibration.figures import made_figure

            heights = replace(stored, sign=-1.0 if options["mould"] else 1.0)
            figure = made_figure(made, heights, design.law, law)
            mf.files.write_figure(picture, figure, "made surface", force=force)
        if output is not None:
            mf.files.write_text(output, mf.files.made_table(made, design.sites), force=force)
    files = [path for path in (output, picture) if path is not None]
    touching = design.law.area > 0.0
    change = 100.0 * _rms(law.area[touching] / design.law.area[touching] - 1.0)
    measured = f"{made.surface.count} of {made.design.count} asperities measured"
    show(
        as_json,
        {**_data(design, made, law), "files": [str(path) for path in files]},
        head=[f"{measured}, roughness (s.d.) {UM * made.roughness:.2g} um"],
        tables=[_error_table(made), _law_table(design.law, law)],
        lines=[
            "law of the made surface: A0 differs from that of the design by "
            f"{change:.2g} % (root mean square over the loads)"
        ],
        notes=made.notes,
        files=files,
    )


def _law_table(designed: FrictionLaw, made: FrictionLaw) -> Printed:
    """Return the areas of both laws at some loads."""
    areas = list(zip(made.load, designed.area, made.area, strict=True))
    every = max(1, len(areas) // LOADS)
    rows = [
        (
            *(f"{value:.4g}" for value in row),
            f"{100.0 * (row[2] / row[1] - 1.0):+.2g} %" if row[1] > 0.0 else "-",
        )
        for row in areas[max(0, len(areas) // LOADS - 1) :: every]
    ]
    return ["load [N]", "designed area [mm²]", "made [mm²]", "change"], rows, None


def _error_table(made: MadeSurface) -> Printed:
    """Return mean, standard deviation and largest value of the errors of heights, radii and positions."""
    x, y = UM * made.position_error.T
    sd = UM * made.position_sd
    relative = 100.0 / made.design.radius[made.site]
    rows = [
        (
            name,
            f"{round(float(values.mean()), DIGITS) + 0.0:+.2g} {unit}",
            f"{values.std():.2g} {unit}",
            f"{values[abs(values).argmax()]:+.2g} {unit}",
            f"{_rms(error):.2g} {unit}",
        )
        for name, values, error, unit in (
            ("height", UM * made.height_error, UM * made.height_sd, "um"),
            ("radius", relative * made.radius_error, 100.0 * made.radius_sd / made.surface.radius, "%"),
            ("x", x, sd, "um"),
            ("y", y, sd, "um"),
        )
    ]
    return ["made minus designed", "mean", "s.d.", "largest", "standard error"], rows, None


def _rms(values: Any) -> float:
    return math.sqrt(float((values**2).mean()))


def _data(design: Design, made: MadeSurface, law: FrictionLaw) -> dict[str, Any]:
    """Return the made surface, and its friction law, for JSON."""
    level = made.levelling
    return {
        "site": design.sites[made.site].tolist(),
        "missing": design.sites[made.missing].tolist(),
        "x_mm": made.surface.position[:, 0].tolist(),
        "y_mm": made.surface.position[:, 1].tolist(),
        "height_mm": made.surface.height.tolist(),
        "radius_mm": made.surface.radius.tolist(),
        "sd_position_mm": made.position_sd.tolist(),
        "sd_height_mm": made.height_sd.tolist(),
        "sd_radius_mm": made.radius_sd.tolist(),
        "height_error_mm": made.height_error.tolist(),
        "roughness_mm": made.roughness,
        "rotation_rad": made.rotation,
        "mirrored": made.mirrored,
        "tilt_rad": level.tilt.tolist(),
        "bow_per_mm": level.bow.tolist(),
        "load_N": law.load.tolist(),
        "designed_area_mm2": design.law.area.tolist(),
        "made_area_mm2": law.area.tolist(),
        "notes": notes_data(made.notes),
    }
