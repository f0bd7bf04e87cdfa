"""The command topography: a made surface on a height map."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem._given import printable
from metafem.cli.options import Name, command, file_option, force_option, json_option, quantity, refuse_files
from metafem.cli.output import in_columns, in_rows, notes_data, show
from metafem.cli.progress import loaded, progress
from metafem.errors import InvalidInput

if TYPE_CHECKING:
    from metafem.calibration import MadeSurface

# Number of loads at which the two laws are printed.
LOADS = 5

UM = 1e3


@command(
    click.argument("height_map", type=Name(), metavar="MAP"),
    file_option("--design folder", "DIR", "Result folder of the design.", required=True),
    quantity("pixel", "mm", "2 um", "Distance of two pixels, {}. Default: that of MAP."),
    click.option("--height-unit", metavar="UNIT", help='Unit of the heights, "um". Default: that of MAP.'),
    click.option("--mould", is_flag=True, help="The map shows the mould: its holes are the caps."),
    file_option("-o --output", "MADE.csv", "File of the made surface, for metafem predict."),
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

    MAP is a height map in the format .x3p, .sur, .plux or in another format of a microscope. It
    is seen from the side of the asperities. Tilt and bow are subtracted, and a sphere is fitted to each cap.

    Example: metafem topography part.x3p --design linear -o made.csv
    """
    refuse_files(force, output)
    with progress():
        design = loaded(folder)
        heights, sides = mf.files.read_height_map(height_map, options["pixel"], options["height_unit"])
        try:
            made = mf.calibration.made_surface(heights, sides, design.surface, mould=options["mould"])
        except InvalidInput as error:
            raise InvalidInput(f"{printable(str(height_map))}: {error}") from None
        law = mf.friction_law(made.surface, design.law.model, load=design.law.load)
        if output is not None:
            mf.files.write_text(output, mf.files.made_table(made, design.sites), force=force)
    touching = design.law.area > 0.0
    single = {
        "measured": made.surface.count,
        "designed": made.design.count,
        "roughness_um": UM * made.roughness,
        "area_change_percent": _rms(100.0 * (law.area[touching] / design.law.area[touching] - 1.0)),
    }
    laws = {"load_N": law.load, "designed_area_mm2": design.law.area, "made_area_mm2": law.area}
    data: dict[str, Any] = mf.files.plain_data(
        {
            **single,
            **laws,
            "site": design.sites[made.site] + 1,
            "missing": design.sites[made.missing] + 1,
            "height_mm": made.surface.height,
            "radius_mm": made.surface.radius,
            "sd_height_mm": made.height_sd,
            "height_error_mm": made.height_error,
            "errors": _errors(made),
            "notes": notes_data(made.notes),
            "files": [] if output is None else [str(output)],
        }
    )
    every = max(1, len(law.load) // LOADS)
    shown = in_columns({name: data[name] for name in laws}, range(every - 1, len(law.load), every))
    tables = [in_rows(data["errors"]), shown, in_rows([single])]
    show(as_json, data, tables=tables, notes=made.notes, files=[output])


def _errors(made: MadeSurface) -> list[dict[str, Any]]:
    """Return mean, standard deviation and largest value of the errors of heights, radii and positions."""
    relative = 100.0 / made.design.radius[made.site]
    return [
        {
            "made_minus_designed": name,
            "mean": float(values.mean()),
            "sd": float(values.std()),
            "largest": float(values.flat[abs(values).argmax()]),
            "standard_error": _rms(error),
        }
        for name, values, error in (
            ("height_um", UM * made.height_error, UM * made.height_sd),
            ("radius_percent", relative * made.radius_error, relative * made.radius_sd),
            # the alignment makes the mean errors of the positions 0
            ("position_um", UM * made.position_error, UM * made.position_sd),
        )
    ]


def _rms(values: Any) -> float:
    return math.sqrt(float((values**2).mean()))
