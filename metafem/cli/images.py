"""The command images: measurement of contacts in images."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
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
from metafem.cli.output import notes_data, show
from metafem.cli.progress import progress
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note, information
from metafem.progress import doing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from metafem.calibration import ContactAreas, DesignSites, TrackedContacts
    from metafem.files import Images, Shot

# Difference of a matched lattice's scale from 1 above which a warning is given: areas are then wrong by 2 %.
SCALE = 0.01


@dataclass(frozen=True)
class Series:
    """Measured images, with their forces and their contacts before and under shear."""

    series: Sequence[Shot]
    areas: Sequence[ContactAreas]
    sheared: Sequence[ContactAreas | None]
    tracked: TrackedContacts
    pixel: float
    notes: tuple[Note, ...]

    @property
    def failed(self) -> list[str]:
        """Names of the images that could not be measured."""
        files = [image for shot in self.series for image in (shot.image, shot.sheared)]
        found = [areas for pair in zip(self.areas, self.sheared, strict=True) for areas in pair]
        pairs = zip(files, found, strict=True)
        return [image.name for image, areas in pairs if image and areas and areas.failed]

    def lines(self) -> tuple[list[str], list[list[str]]]:
        """Return the column titles and the rows of the printed table, without columns that are empty."""
        rows = self.rows()
        names = [name for name in rows[0] if any(row[name] not in (None, "") for row in rows)]
        return [_title(name) for name in names], [[_text(row[name]) for name in names] for row in rows]

    def rows(self) -> list[dict[str, Any]]:
        """Return forces, numbers of contacts and areas of each image, for JSON and the printed table.

        An area is the sum over the contacts that could be measured.
        """
        table, rows = self.tracked.table, []
        for i, name in enumerate(table.image):
            row = {"image": name, "test": table.test[i], "load_N": table.load[i]}
            row["friction_force_N"] = table.friction_force[i]
            row |= _numbers(self.areas[i], table.area[i], table.area_error[i])
            sheared = _numbers(self.sheared[i], table.sheared_area[i], table.sheared_area_error[i])
            row |= {f"sheared_{key}": value for key, value in sheared.items() if key.startswith("area")}
            rows.append(mf.files.plain_data(row))
        return rows

    def sentences(self) -> Iterator[str]:
        """Yield how the contacts were numbered or matched to sites, and the remarks on single contacts."""
        table, match = self.tracked.table, self.tracked.match
        name, count = table.image[self.tracked.reference], len(table.site)
        if match is None:
            yield f"{count} contacts, numbered from top to bottom of {name}"
        else:
            side = "block, mirrored against heights.csv" if match.mirrored else "glass"
            yield (
                f"{int((match.site >= 0).sum())} contacts of {name} matched to {count} sites, seen through "
                f"the {side}: rotation {math.degrees(match.rotation):.2f}°, scale {match.scale:.4f}, rms "
                f"distance {1e3 * match.residual:.3g} µm"
            )
        said = {str(note) for note in self.notes}
        yield from (f"remark: {remark}" for remark in self.tracked.remarks if remark not in said)

    def data(self, files: Sequence[Path]) -> dict[str, Any]:
        """Return the results for JSON; `files` are the files that were written."""
        table, match = self.tracked.table, self.tracked.match
        matched = match and {
            "image": table.image[self.tracked.reference],
            "viewed_from": "block" if match.mirrored else "glass",
            "rotation_deg": math.degrees(match.rotation),
            "scale": match.scale,
            "residual_mm": match.residual,
            "ambiguous": match.ambiguous,
        }
        return {
            "files": [str(path) for path in files],
            "pixel_size_mm": self.pixel,
            "images": self.rows(),
            "match": matched,
            "site": table.site.tolist(),
            "area_mm2": mf.files.plain_data(table.area),
            "failed": self.failed,
            "remarks": list(self.tracked.remarks),
            "notes": notes_data(self.notes),
        }


@command(
    click.argument("source", type=Name(), nargs=-1, required=True, metavar="FOLDER|FILE..."),
    quantity(
        "pixel", "mm", "5.3 um", "Side of a pixel in the plane of the contacts, such as {}.", required=True
    ),
    click.option(
        "--forces",
        type=Name(),
        metavar="FORCES.csv",
        help="Table of the forces: image,load_mN and optionally friction_force_mN, sheared_image, test.",
    ),
    click.option(
        "--sites",
        type=Name(),
        metavar="DIR|HEIGHTS.csv",
        help="Result folder of the design, or its table of heights: contacts are matched to its sites.",
    ),
    click.option(
        "--viewed-from",
        type=click.Choice(["glass", "block"]),
        default="glass",
        help="Side of the camera. Through the glass it sees heights.csv as it is, through the block "
        "mirrored, x -> -x. Default: glass.",
    ),
    quantity(
        "rotation",
        "rad",
        "90 deg",
        "Rotation of the design in the images, anticlockwise, such as {}, to within 5°. Default: 0.",
        default=0.0,
    ),
    click.option("--bright-contacts", is_flag=True, help="Contacts are brighter than the ground."),
    click.option(
        "-o",
        "--output",
        type=Name(),
        metavar="CONTACTS.csv",
        help="Write the table of contacts to this file.",
    ),
    click.option(
        "--picture",
        type=Name(),
        metavar="FOUND.png",
        help="Draw what was found in one image: a file .png or .svg.",
    ),
    click.option(
        "--picture-of", metavar="IMAGE", help="Image that is drawn. Default: the one with most contacts."
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
    needs = "--picture-of needs --picture FOUND.png, the file of the picture"
    refuse_if(picture is None and options["picture_of"] is not None, needs)
    with progress():
        found = _measured(source, options)
        if output is not None:
            mf.files.write_text(output, mf.files.contacts_table(found.tracked.table), force=force)
        if picture is not None:
            with doing("drawing the picture"):
                mf.files.write_figure(picture, *_figure(found, options["picture_of"]), force=force)
    files = [path for path in (output, picture) if path is not None]
    table = (*found.lines(), None)
    show(as_json, found.data(files), tables=[table], lines=found.sentences(), notes=found.notes, files=files)
    if found.failed:
        click.get_current_context().exit(NOT_ACHIEVED)


def _measured(source: tuple[Path, ...], options: dict[str, Any]) -> Series:
    """Return the measured images with tracked contacts; images before and under shear share one threshold."""
    import numpy as np

    from metafem import _validate as check

    pixel, name = check.number("pixel", options["pixel"], above=0.0), options["picture_of"]
    with doing("opening the images"):
        files = mf.files.find_images(source)
        known = [None, *(file.name for file in files if not file.broken)]
        refuse_if(name not in known, f"--picture-of = {name} is not among the images that can be read")
        forces = options["forces"]
        if forces is not None:
            forces = mf.files.read_table(forces, columns_of(options["column"]))
        series, notes = mf.files.shots(files, forces)
    before = [shot.image for shot in series]
    after = [i for i, shot in enumerate(series) if shot.sheared is not None]
    load = np.array([shot.load for shot in series])
    images = mf.files.Images([*before, *(shot.sheared for shot in series if shot.sheared is not None)])
    bright = options["bright_contacts"]
    with hinting(bright):
        found = _areas(images, pixel, np.concatenate([load, load[after]]), bright)
    areas, sheared = found[: len(before)], dict(zip(after, found[len(before) :], strict=True))
    others = [sheared.get(i) for i in range(len(before))]
    with doing("following the contacts"), hinting(bright):
        tracked = mf.calibration.track_contacts(
            areas,
            [file.name for file in before],
            test=[shot.test for shot in series],
            load=load,
            friction_force=[shot.friction_force for shot in series],
            sheared=others,
            sites=_sites(options),
        )
    more = [*notes, *_notes(images, areas, tracked, pixel)]
    # warnings on the match come first, because the sentence on the match is printed before the notes
    first = [note for note in tracked.notes if note.warns]
    last = [note for note in tracked.notes if not note.warns]
    return Series(series, areas, others, tracked, pixel, (*first, *more, *last))


@contextmanager
def hinting(bright: bool) -> Iterator[None]:
    """Add to errors of the body that contacts may be brighter or darker than the ground."""
    try:
        yield
    except InvalidInput as error:
        hint = "if contacts are dark, leave out" if bright else "if contacts are bright, add"
        raise InvalidInput(f"{error}; {hint} --bright-contacts") from None


def _areas(images: Images, pixel: float, load: Any, bright: bool) -> list[ContactAreas]:
    """Return the contacts of each image; their notes name images by their files."""
    import numpy as np

    known = np.isfinite(load)
    # the image at the largest load determines the threshold: images without a load get the smallest load, and
    # without any loads `stack_areas` uses the last image
    order = np.where(known, load, load[known].min() - 1.0) if known.any() else None

    def named(text: str, own: int | None = None) -> str:
        """Return a text in which the files replace the entries of the argument `images`."""
        names = [file.name for file in images.files]
        names = ["this image" if i == own else name for i, name in enumerate(names)]
        return re.sub(r"images\[(\d+)\]", lambda found: names[int(found[1])], text)

    try:
        found = mf.calibration.stack_areas(images, pixel, loads=order, bright_contacts=bright)
    except InvalidInput as error:
        raise InvalidInput(named(str(error))) from None
    return [
        replace(
            areas,
            notes=tuple(replace(note, text=named(note.text, i)) for note in areas.notes),
        )
        for i, areas in enumerate(found)
    ]


def _notes(
    images: Images, areas: Sequence[ContactAreas], tracked: TrackedContacts, pixel: float
) -> Iterator[Note]:
    """Yield the notes that concern all images."""
    from metafem.calibration.contact_table import listed

    if images.coloured:
        names = listed(list(images.coloured))
        yield information(f"in colour, the luminance of ITU-R BT.709 is measured: {names}")
    smallest = max(one.smallest_area for one in areas if not one.failed)
    if smallest > 0.0:
        yield information(
            f"contacts of less than {smallest:.2g} mm² are not found and count as open; ± is the standard "
            "deviation of the sum over the closed ones"
        )
    match = tracked.match
    if match is not None and abs(match.scale - 1.0) > SCALE:
        yield Note(
            f"the sites are {match.scale:.4f} times as far apart as in the design: with pixels of "
            f"{1e3 * pixel / match.scale:.4g} um instead of {1e3 * pixel:.4g} um they would agree, and areas "
            f"would be {100.0 * (match.scale**-2 - 1.0):+.2g} % different"
        )


def _sites(options: dict[str, Any]) -> DesignSites | None:
    """Return the sites of a design, from its table of heights."""
    source = options["sites"]
    if source is None:
        return None
    refuse_if(not source.exists(), f"--sites {source}: no such file or folder")
    position, number = mf.files.read_sites(source / "heights.csv" if source.is_dir() else source)
    return mf.calibration.DesignSites(position, number, options["viewed_from"], options["rotation"])


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


def _numbers(areas: ContactAreas | None, area: Any, error: Any) -> dict[str, Any]:
    """Return the numbers of contacts, and the sum of their areas with its error; None if not measured.

    The errors of closed contacts are independent, so that their squares are added.
    """
    import numpy as np

    measured = areas is not None and not areas.failed
    values = {
        "contacts": int(np.count_nonzero(area > 0.0)),
        "open": int(np.count_nonzero(area == 0.0)),
        "not_measured": int(np.count_nonzero(np.isnan(area))),
        "area_mm2": float(np.nansum(area)),
        "area_error_mm2": float(np.sqrt(np.square(error[area > 0.0]).sum())),
    }
    return {name: value if measured else None for name, value in values.items()}


def _title(name: str) -> str:
    """Return the title of a column of the printed table."""
    base, _, unit = name.rpartition("_")
    units = {"N": "N", "mm2": "mm²"}
    return f"{base.replace('_', ' ')} [{units[unit]}]" if unit in units else name.replace("_", " ")


def _text(value: Any) -> str:
    """Return the text of an entry in the printed table."""
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
