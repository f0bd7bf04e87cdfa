"""`metafem images`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem import _validate as check
from metafem.cli.group import NOT_ACHIEVED, Name, force_option, json_option, main
from metafem.cli.measurement.image_series import measured_series
from metafem.cli.measurement.quantities import quantities
from metafem.cli.progress import progress
from metafem.cli.terminal import print_json, print_notes, print_table, print_written, say, terminal
from metafem.errors import refuse_if
from metafem.progress import doing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from metafem.cli.measurement.image_series import Series


@main.command(short_help="Measure contact areas in images.")
@click.argument("source", type=Name(), nargs=-1, required=True, metavar="FOLDER|FILE...")
@click.option(
    "--pixel",
    metavar="LENGTH",
    required=True,
    help='Side of a pixel in the plane of the contacts, such as "5.3 um".',
)
@click.option(
    "--forces",
    type=Name(),
    metavar="FORCES.csv",
    help="Table of the forces: image,load_mN and optionally friction_force_mN, sheared_image, test.",
)
@click.option(
    "--sites",
    type=Name(),
    metavar="DIR|HEIGHTS.csv",
    help="Result folder of the design, or its table of heights: contacts are matched to its sites.",
)
@click.option(
    "--viewed-from",
    type=click.Choice(["glass", "block"]),
    default="glass",
    help="Side of the camera. Through the glass it sees heights.csv as it is, through the block mirrored, "
    "x -> -x. Default: glass.",
)
@click.option(
    "--rotation",
    metavar="ANGLE",
    help='Rotation of the design in the images, anticlockwise, such as "90 deg", to within 5°. Default: 0.',
)
@click.option("--bright-contacts", is_flag=True, help="Contacts are brighter than the ground.")
@click.option(
    "-o",
    "--output",
    type=Name(),
    metavar="CONTACTS.csv",
    help="Write the table of contacts to this file.",
)
@click.option(
    "--picture",
    type=Name(),
    metavar="FOUND.png",
    help="Draw what was found in one image: a file .png or .svg.",
)
@click.option(
    "--picture-of", metavar="IMAGE", help="Image that is drawn. Default: the one with most contacts."
)
@force_option
@json_option
def images(
    source: tuple[Path, ...],
    output: Path | None,
    picture: Path | None,
    force: bool,
    as_json: bool,
    **options: Any,
) -> None:
    """Measure the areas of contacts in images: TIFF, also with several pages, and PNG.

    The images in a folder are read in natural order, 2 before 10. The image at the largest load determines
    the threshold for all images. FORCES.csv has one line for each image. It names an image by its file, and a
    page of a stack as stack.tif:3. If an image shows the contacts at the peak of the friction force, name it
    in the column sheared_image, in the line of the image before shear.

    With --sites, the image with the most contacts is used to match the contacts to the sites of the design.
    Without --sites, the contacts are numbered. CONTACTS.csv has one line for each image and contact; metafem
    calibrate and metafem compare read it. An open contact has the area 0. An area that could not be measured
    is empty, and a remark states why.

    A contact that is cut by the edge of an image, or that has merged with another contact, has no area in
    that image. Its area is measured in the images that show it completely. Without --sites, the
    contacts are numbered in the image with the most contacts. A contact at the edge of this image has a
    number if another image shows it completely; merged contacts have no number.

    If an image cannot be read or measured, its name is printed, the other images are measured, and the exit
    code is 1.

    Example: metafem images pictures --pixel "5.3 um" --forces forces.csv -o contacts.csv --picture found.png
    """
    if output is not None:
        mf.files.refuse_existing(output, force)
    if picture is not None:
        mf.files.refuse_figure(picture, force)
    else:
        needs = "--picture-of needs --picture FOUND.png, the file of the picture"
        refuse_if(options["picture_of"] is not None, needs)
    with progress():
        found = _measured(source, options)
        if output is not None:
            text = mf.files.contacts_table(found.tracked.table)
            mf.files.write_text(output, text, force=force)
        if picture is not None:
            with doing("drawing the picture"):
                mf.files.write_figure(picture, *_figure(found, options["picture_of"]), force=force)
    files = [path for path in (output, picture) if path is not None]
    if as_json:
        print_json(found.data(files))
    else:
        _print(found, files)
    if found.failed:
        click.get_current_context().exit(NOT_ACHIEVED)


def _measured(source: tuple[Path, ...], options: dict[str, Any]) -> Series:
    """Return the measured images with tracked contacts."""
    given = quantities({"pixel": ("mm", "5.3 um", ""), "rotation": ("rad", "90 deg", "")}, options)
    pixel, name = check.number("--pixel", given["pixel"], above=0.0), options["picture_of"]
    with doing("opening the images"):
        files = mf.files.find_images(source)
        known = [None, *(file.name for file in files if not file.broken)]
        refuse_if(name not in known, f"--picture-of = {name} is not among the images that can be read")
        series, notes = mf.files.shots(files, options["forces"])
    return measured_series(series, pixel, notes, given["rotation"] or 0.0, options)


def _figure(found: Series, name: str | None) -> tuple[Figure, str]:
    """Return the figure of an image and its title; default: the image with the most contacts."""
    from metafem.calibration.figures import found_figure

    name = name or found.tracked.table.image[found.tracked.reference]
    index, file, areas, sheared = next(
        (index, file, areas, file is shot.sheared)
        for index, shot in enumerate(found.series)
        for file, areas in ((shot.image, found.areas[index]), (shot.sheared, found.sheared[index]))
        if file is not None and areas is not None and file.name == name
    )
    return found_figure(mf.files.Images([file])[0], areas, found.tracked, index, sheared), name


def _print(found: Series, files: list[Path]) -> None:
    """Print a table of the images, sentences on the positions of the contacts, remarks and notes."""
    console = terminal()
    columns, rows = found.lines()
    print_table(console, columns, rows)
    say(console, *found.sentences())
    print_notes(console, found.notes)
    said = {str(note) for note in found.notes}
    say(console, *(f"remark: {remark}" for remark in found.tracked.remarks if remark not in said))
    print_written(files)
