"""`metafem topography`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem._given import Names, printable
from metafem.cli.group import Name, force_option, json_option, main
from metafem.cli.measurement.made import made_data, print_made
from metafem.cli.progress import progress
from metafem.cli.terminal import loaded, print_json, print_written
from metafem.errors import InvalidInput, named

if TYPE_CHECKING:
    from metafem.calibration import MadeSurface
    from metafem.inversion import Design


# How error messages name arguments: by the options of this command.
ARGUMENTS = Names(
    {
        "pixel_size": "--pixel",
        "the unit of the heights": "--height-unit",
        "mould=True": "--mould",
        "mould=False": "whether --mould is right",
    }
)


@main.command(short_help="Measure a made surface on a height map.")
@click.argument("height_map", type=Name(), metavar="MAP")
@click.option(
    "--design", "folder", type=Name(), metavar="DIR", required=True, help="Result folder of the design."
)
@click.option(
    "--pixel", metavar="LENGTH", help='Distance of two pixels, such as "2 um", if the map does not state it.'
)
@click.option(
    "--height-unit", metavar="UNIT", help='Unit of the heights, such as "um", if the map does not state it.'
)
@click.option("--mould", is_flag=True, help="The map shows the mould: its holes are the caps.")
@click.option(
    "--common-radius",
    is_flag=True,
    help="All caps have one radius; the errors of the heights are then halved.",
)
@click.option("--keep-bow", is_flag=True, help="Subtract a plane only, no bow.")
@click.option(
    "-o", "--output", type=Name(), help="Write the made surface to this CSV file, for metafem predict."
)
@click.option(
    "--picture", type=Name(), help="Draw height errors, residual map and laws: a file .svg or .png."
)
@force_option
@json_option
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
    if output is not None:
        mf.files.refuse_existing(output, force)
    if picture is not None:
        mf.files.refuse_figure(picture, force)
    with progress():
        design = loaded(folder)
    with progress():
        stored = mf.files.read_height_map(height_map, pixel, height_unit)
        made = _measured(height_map, stored, design, {"bow": not keep_bow, **options})
        law = mf.friction_law(made.surface, design.law.model, load=design.law.load)
        if picture is not None:
            from metafem.calibration.figures import made_figure

            heights = replace(stored, sign=-1.0 if options["mould"] else 1.0)
            figure = made_figure(made, heights, design.law, law)
            mf.files.write_figure(picture, figure, "made surface", force=force)
    if output is not None:
        text = mf.files.made_table(made, design.sites)
        mf.files.write_text(output, text, force=force)
    written = [path for path in (output, picture) if path is not None]
    if as_json:
        data = made_data(design, made, law)
        print_json({**data, "files": [str(path) for path in written]})
        return
    print_made(design, made, law)
    print_written(written)


def _measured(file: Path, stored: Any, design: Design, options: dict[str, bool]) -> MadeSurface:
    """Return the made surface that a height map shows; errors name the file of the map."""
    try:
        with named(ARGUMENTS):
            return mf.calibration.made_surface(stored.values, stored.pixel, design.surface, **options)
    except InvalidInput as error:
        raise InvalidInput(f"{printable(str(file))}: {error}") from None
