"""The command topography: a made surface on a height map."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem._given import printable
from metafem.cli.images import file_option, printed
from metafem.cli.options import Name, command, force_option, json_option, refuse_files
from metafem.cli.output import notes_data, show
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
    file_option("--design folder", "DIR", "Result folder of the design.", required=True),
    click.option(
        "--pixel", metavar="LENGTH", help='Distance of two pixels, "2 um", if MAP does not state it.'
    ),
    click.option(
        "--height-unit", metavar="UNIT", help='Unit of the heights, "um", if MAP does not state it.'
    ),
    click.option("--mould", is_flag=True, help="The map shows the mould: its holes are the caps."),
    click.option("--keep-bow", is_flag=True, help="Subtract a plane only, no bow."),
    file_option("-o --output", "MADE.csv", "Write the made surface to this file, for metafem predict."),
    force_option,
    json_option,
    short_help="Measure a made surface on a height map.",
)
def topography(
    height_map: Path,
    folder: Path,
    output: Path | None,
    force: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Measure heights, radii and positions of the asperities in MAP, and compare them with the design.

    MAP is a height map in the format .x3p, .sur, .plux, .npy or in another format of a microscope. It
    is seen from the side of the asperities. Tilt and bow are subtracted, and a sphere is fitted to each cap.

    Example: metafem topography part.x3p --design linear -o made.csv
    """
    refuse_files(force, output)
    with progress():
        design = loaded(folder)
        stated = options.pop("pixel"), options.pop("height_unit")
        heights, sides = mf.files.read_height_map(height_map, *stated)
        options["bow"] = not options.pop("keep_bow")
        try:
            made = mf.calibration.made_surface(heights, sides, design.surface, **options)
        except InvalidInput as error:
            raise InvalidInput(f"{printable(str(height_map))}: {error}") from None
        law = mf.friction_law(made.surface, design.law.model, load=design.law.load)
        if output is not None:
            mf.files.write_text(output, mf.files.made_table(made, design.sites), force=force)
    files = [] if output is None else [output]
    data = _data(design, made, law) | {"files": [str(path) for path in files]}
    every = max(1, len(law.load) // LOADS)
    shown = list(zip(law.load, design.law.area, law.area, strict=True))[every - 1 :: every]
    names = ("load_N", "designed_area_mm2", "made_area_mm2")
    tables = [printed(data["errors"]), printed([dict(zip(names, row, strict=True)) for row in shown])]
    single = ("measured", "designed", "roughness_um", "area_change_percent")
    tables.append(printed([{name: data[name] for name in single}]))
    show(as_json, data, tables=tables, notes=made.notes, files=files)


def _errors(made: MadeSurface) -> list[dict[str, Any]]:
    """Return mean, standard deviation and largest value of the errors of heights, radii and positions."""
    x, y = UM * made.position_error.T
    relative = 100.0 / made.design.radius[made.site]
    return [
        {
            "made_minus_designed": name,
            "mean": round(float(values.mean()), DIGITS) + 0.0,
            "sd": float(values.std()),
            "largest": float(values[abs(values).argmax()]),
            "standard_error": _rms(error),
        }
        for name, values, error in (
            ("height_um", UM * made.height_error, UM * made.height_sd),
            ("radius_percent", relative * made.radius_error, relative * made.radius_sd),
            ("x_um", x, UM * made.position_sd),
            ("y_um", y, UM * made.position_sd),
        )
    ]


def _rms(values: Any) -> float:
    return math.sqrt(float((values**2).mean()))


def _data(design: Design, made: MadeSurface, law: FrictionLaw) -> dict[str, Any]:
    """Return the made surface, and its friction law beside that of the design."""
    touching = design.law.area > 0.0
    data: dict[str, Any] = mf.files.plain_data(
        {
            "measured": made.surface.count,
            "designed": made.design.count,
            "site": design.sites[made.site] + 1,
            "missing": design.sites[made.missing] + 1,
            "height_mm": made.surface.height,
            "radius_mm": made.surface.radius,
            "sd_height_mm": made.height_sd,
            "height_error_mm": made.height_error,
            "errors": _errors(made),
            "roughness_um": UM * made.roughness,
            "load_N": law.load,
            "designed_area_mm2": design.law.area,
            "made_area_mm2": law.area,
            "area_change_percent": 100.0 * _rms(law.area[touching] / design.law.area[touching] - 1.0),
            "notes": notes_data(made.notes),
        }
    )
    return data
