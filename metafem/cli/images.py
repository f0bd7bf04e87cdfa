"""The command images: measurement of contacts in images."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli.group import NOT_ACHIEVED
from metafem.cli.options import (
    Name,
    column_option,
    columns_of,
    command,
    force_option,
    json_option,
    quantity,
    refuse_files,
)
from metafem.cli.output import Printed, in_columns, notes_data, show
from metafem.cli.progress import progress
from metafem.errors import refuse_if
from metafem.notes import Note
from metafem.progress import doing

if TYPE_CHECKING:
    from pandas import DataFrame

    from metafem.calibration import TrackedContacts

# Sums over the contacts of an image that are printed; the errors are last.
SUMS = ["contacts", "open", "not_measured", "area_mm2", "sheared_area_mm2"]
SUMS += ["area_error_mm2", "sheared_area_error_mm2"]

# Difference of a matched lattice's scale from 1 above which a warning is given: areas are then wrong by 2 %.
SCALE = 0.01


def file_option(name: str, metavar: str, text: str, **more: Any) -> Any:
    """Return the option of a file or folder."""
    return click.option(*name.split(), type=Name(), metavar=metavar, help=text, **more)


@command(
    click.argument("source", type=Name(), nargs=-1, required=True, metavar="FOLDER|FILE..."),
    quantity("pixel", "mm", "5.3 um", "Side of a pixel in the plane of the contacts, {}.", required=True),
    file_option(
        "--forces",
        "FORCES.csv",
        "Table of the forces: image,load_mN and optionally friction_force_mN, sheared_image, test.",
    ),
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
    file_option("-o --output", "CONTACTS.csv", "Write the table of contacts to this file."),
    file_option(
        "--picture", "FOUND.png", "Draw what was found in the image with most contacts: a file .png or .svg."
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
    refuse_files(force, output, figure=picture)
    within = picture is not None and any(picture.parent.resolve() == one.resolve() for one in source)
    refuse_if(
        within, "--picture is in the folder of the images, and would be one of them; give another folder"
    )
    with progress():
        files, areas, tracked, notes = _measured(source, options)
        if output is not None:
            mf.files.write_text(output, mf.files.contacts_table(tracked.table), force=force)
        if picture is not None:
            with doing("drawing the picture"):
                figure = _figure(files[tracked.name](), areas[tracked.name], tracked)
                mf.files.write_figure(picture, figure, tracked.name, force=force)
    failed = [name for name, one in areas.items() if one is None]
    written = [path for path in (output, picture) if path is not None]
    data = {
        "files": [str(path) for path in written],
        "pixel_size_mm": options["pixel"],
        "images": _rows(tracked.table),
        "match": _match(tracked),
        "failed": failed,
        "notes": notes_data(notes),
    }
    tables = [printed(data["images"]), *([printed([data["match"]])] if data["match"] else [])]
    show(as_json, data, tables=tables, notes=notes, files=written)
    if failed:
        click.get_current_context().exit(NOT_ACHIEVED)


def _measured(source: tuple[Path, ...], options: dict[str, Any]) -> tuple[Any, Any, TrackedContacts, Any]:
    """Return the images, their areas, the tracked contacts and notes; all images share one threshold."""
    import numpy as np

    with doing("opening the images"):
        files = mf.files.find_images(source)
        table = options["forces"]
        if table is not None:
            table = mf.files.read_table(table, columns_of(options["column"]))
        forces, notes = mf.files.read_forces([*files], table)
    sheared = forces["sheared_image"] != ""
    names = [*forces["image"], *forces["sheared_image"][sheared]]
    load = np.append(forces["load"], forces["load"][sheared])
    # images without a load come last; without any loads the last image determines the threshold
    order = np.nan_to_num(load, nan=np.nanmin(load) - 1.0) if np.isfinite(load).any() else None
    images, bright = [files[name] for name in names], options["bright_contacts"]
    found, said = mf.calibration.stack_areas(
        images, options["pixel"], order, names=names, bright_contacts=bright
    )
    areas = dict(zip(names, found, strict=True))
    with doing("following the contacts"):
        tracked = mf.calibration.track_contacts(areas, forces, **_sites(options))
    scale = 1.0 if tracked.match is None else tracked.match.scale
    text = (
        f"the sites are {scale:.4f} times as far apart as in the design: with pixels of "
        f"{1e3 * options['pixel'] / scale:.4g} um they would agree, and areas would be "
        f"{100.0 * (scale**-2 - 1.0):+.2g} % different"
    )
    return files, areas, tracked, [*tracked.notes, *notes, *said, *[Note(text)] * (abs(scale - 1.0) > SCALE)]


def _sites(options: dict[str, Any]) -> dict[str, Any]:
    """Return the sites of a design, from its table of heights, as `track_contacts` takes them."""
    source = options["sites"]
    if source is None:
        return {}
    refuse_if(not source.exists(), f"--sites {source}: no such file or folder")
    position, number = mf.files.read_sites(source / "heights.csv" if source.is_dir() else source)
    view = {name: options[name] for name in ("viewed_from", "rotation")}
    return {"site_position": position, "site_number": number, **view}


def _figure(image: Any, areas: Any, tracked: TrackedContacts) -> Any:
    """Return the figure of the image with the most contacts."""
    from metafem.calibration.figures import found_figure

    rows, match = tracked.table[tracked.table["image"] == tracked.name], tracked.match
    where = rows[["x", "y"]].to_numpy() if match is None else match.to_image(rows[["x", "y"]])
    title = f"{tracked.name}: numbers are those of the column {'contact' if match is None else 'site'}"
    return found_figure(image, areas, rows, where, title)


def _rows(table: DataFrame) -> list[dict[str, Any]]:
    """Return forces, numbers of contacts and the sum of the measured areas of each image.

    The errors of closed contacts are independent, so that their squares are added.
    """
    area = table["area"]
    rows = table.assign(contacts=area > 0.0, open=area == 0.0, not_measured=area.isna())
    rows = rows.rename(columns={"load": "load_N", "friction_force": "friction_force_N"})
    for name in ("area", "sheared_area"):
        rows[f"{name}_mm2"] = table[name]
        rows[f"{name}_error_mm2"] = table[f"{name}_error"].where(table[name] > 0.0) ** 2
    by = ["image", "test", "load_N", "friction_force_N"]
    sums = rows.groupby(by, sort=False, dropna=False)[SUMS].sum(min_count=1).reset_index()
    for name in SUMS[-2:]:
        sums[name] **= 0.5
    data: list[dict[str, Any]] = mf.files.plain_data(sums.to_dict("records"))
    return data


def _match(tracked: TrackedContacts) -> dict[str, Any] | None:
    """Return how the image with the most contacts was matched to the sites."""
    match = tracked.match
    return (
        match
        if match is None
        else {
            "image": tracked.name,
            "matched": int((match.site >= 0).sum()),
            "viewed_from": "block" if match.mirrored else "glass",
            "rotation_deg": math.degrees(match.rotation),
            "scale": match.scale,
            "residual_mm": match.residual,
            "ambiguous": match.ambiguous,
        }
    )


def printed(rows: Sequence[Mapping[str, Any]]) -> Printed:
    """Return the printed table of rows of data, without columns that are empty."""
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    return in_columns({name: values for name, values in columns.items() if {*values} - {None, ""}})
