"""The command images: measurement of contacts in images."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli import NOT_ACHIEVED
from metafem.cli.options import (
    Name,
    column_option,
    columns_of,
    command,
    file_option,
    force_option,
    json_option,
    quantity,
    refuse_files,
)
from metafem.cli.output import in_rows, notes_data, progress, show
from metafem.errors import refuse_if
from metafem.notes import Note
from metafem.progress import doing

if TYPE_CHECKING:
    from pandas import DataFrame

    from metafem.calibration import SiteMatch

# Formats of the picture of what was found.
FORMATS = (".svg", ".png")

# Difference of a matched lattice's scale from 1 above which a warning is given: areas are then wrong by 2 %.
SCALE = 0.01


@command(
    click.argument("source", type=Name(), nargs=-1, required=True, metavar="FOLDER|FILE..."),
    quantity("pixel", "mm", "5.3 um", "Side of a pixel in the plane of the contacts, {}.", required=True),
    file_option("--forces", "FORCES.csv", "Table of the forces at which the images were taken."),
    file_option("--sites", "DIR|HEIGHTS.csv", "Design, or its heights: contacts are matched to its sites."),
    click.option(
        "--viewed-from",
        type=click.Choice(["glass", "block"]),
        default="glass",
        help="Side of the camera. Through the glass it sees heights.csv as it is, through the block "
        "mirrored, x -> -x. Default: glass.",
    ),
    quantity(
        "rotation", "rad", "90 deg", "Rotation in the images, {}, to within 5°. Default: 0.", default=0.0
    ),
    click.option("--bright-contacts", is_flag=True, help="Contacts are brighter than the ground."),
    file_option("-o --output", "CONTACTS.csv", "File of the table of contacts."),
    file_option(
        "--picture", "FOUND.png", "Draw what was found in the image with most contacts, .png or .svg."
    ),
    column_option,
    force_option,
    json_option,
    short_help="Measure contact areas in images.",
)
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
    the threshold for all images. FORCES.csv has one line for each image, with the columns image,load_mN and
    optionally friction_force_mN, sheared_image and test. It names an image by its file, and a page of a stack
    as stack.tif:3. If an image shows the contacts at the peak of the friction force, name it in the column
    sheared_image, in the line of the image before shear.

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
    refuse_files(force, output, picture)
    wrong = picture is not None and picture.suffix.lower() not in FORMATS
    refuse_if(wrong, f"--picture {picture} must end with .svg or .png, the formats of figures")
    from metafem.calibration.sites import found_figure
    from metafem.drawing import RESOLUTION

    with progress():
        files, forces, known, notes = _opened(source, options)
        areas, said = _measured(files, forces, options)
        with doing("following the contacts"):
            table, reference, found, more = mf.calibration.track_contacts(areas, forces, **known)
        if output is not None:
            mf.files.write_text(output, mf.files.contacts_table(table), force=force)
        if picture is not None:
            with doing("drawing the picture"), mf.files.staged(picture, force) as fresh:
                image, own = files[reference](), table[table["image"] == reference]
                figure = found_figure(image, areas[reference], own, found)
                figure.savefig(fresh, format=picture.suffix[1:].lower(), dpi=RESOLUTION)
    failed = [name for name, one in areas.items() if one is None]
    notes = [*more, *notes, *said, *_wrong_size(options["pixel"], found)]
    rows = mf.files.plain_data(_sums(table).to_dict("records"))
    match = found and {
        "image": reference,
        "matched": int((found.site >= 0).sum()),
        "viewed_from": "block" if found.mirrored else "glass",
        "rotation_deg": math.degrees(found.rotation),
        "scale": found.scale,
        "residual_mm": found.residual,
        "ambiguous": found.ambiguous,
    }
    data = {
        "files": [str(path) for path in (output, picture) if path is not None],
        "pixel_size_mm": options["pixel"],
        "images": rows,
        "match": match,
        "failed": failed,
        "notes": notes_data(notes),
    }
    tables = map(in_rows, filter(None, [rows, match and [match]]))
    show(as_json, data, tables=tables, notes=notes, files=[output, picture])
    if failed:
        click.get_current_context().exit(NOT_ACHIEVED)


def _opened(source: tuple[Path, ...], options: dict[str, Any]) -> tuple[Any, DataFrame, dict[str, Any], Any]:
    """Return the images, their forces, the sites to which they are matched, and notes."""
    with doing("opening the images"):
        files = mf.files.find_images(source)
        table, sites = options["forces"], options["sites"]
        if table is not None:
            table = mf.files.read_table(table, columns_of(options["column"]))
        forces, notes = mf.files.read_forces([*files], table)
        if sites is None:
            return files, forces, {}, notes
        position, number = mf.files.read_sites(sites / "heights.csv" if sites.is_dir() else sites)
    known = {name: options[name] for name in ("viewed_from", "rotation")}
    return files, forces, {"site_position": position, "site_number": number, **known}, notes


def _measured(files: Any, forces: DataFrame, options: dict[str, Any]) -> tuple[dict[str, Any], list[Note]]:
    """Return the areas in each image, and notes; all images share one threshold."""
    import numpy as np

    sheared = forces[forces["sheared_image"] != ""]
    names, load = [*forces["image"], *sheared["sheared_image"]], np.append(forces["load"], sheared["load"])
    # images without a load come last; without any loads the last image determines the threshold
    order = np.nan_to_num(load, nan=np.nanmin(load) - 1.0) if np.isfinite(load).any() else None
    given = {"names": names, "bright_contacts": options["bright_contacts"]}
    images = [files[name] for name in names]
    found, notes = mf.calibration.stack_areas(images, options["pixel"], order, **given)
    return dict(zip(names, found, strict=True)), notes


def _wrong_size(pixel: float, match: SiteMatch | None) -> list[Note]:
    """Return a note if the sites are farther apart, or nearer, than in the design."""
    scale = 1.0 if match is None else match.scale
    agrees = f"with pixels of {1e3 * pixel / scale:.4g} um they would agree"
    text = f"the sites are {scale:.4f} times as far apart as in the design; {agrees}, and areas would change"
    return [Note(text)] * (abs(scale - 1.0) > SCALE)


def _sums(table: DataFrame) -> DataFrame:
    """Return forces, numbers of contacts and the sum of the measured areas of each image.

    The errors of closed contacts are independent, so that their squares are added.
    """
    area = table["area"]
    rows = table.assign(contacts=area > 0.0, open=area == 0.0, not_measured=area.isna())
    areas, errors = ["area", "sheared_area"], ["area_error", "sheared_area_error"]
    rows[errors] = rows[errors].where(rows[areas].to_numpy() > 0.0) ** 2
    by, counts = ["image", "test", "load", "friction_force"], ["contacts", "open", "not_measured"]
    sums = rows.groupby(by, sort=False, dropna=False)[[*counts, *areas, *errors]].sum(min_count=1)
    sums[errors] **= 0.5
    units = {**dict.fromkeys(by[2:], "N"), **dict.fromkeys([*areas, *errors], "mm2")}
    return sums.reset_index().rename(columns={name: f"{name}_{unit}" for name, unit in units.items()})
