"""Reading of the forces at which images were taken."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from metafem._given import printable, shown
from metafem.calibration.contact_table import listed
from metafem.errors import InvalidInput
from metafem.files.images import ImageFile
from metafem.files.tables import Columns, Entries, Table
from metafem.notes import Note

COLUMNS = Columns(
    "image,load_mN,friction_force_mN,sheared_image,test",
    ("image,load",),
    "image",
    "image,load_mN (or in another unit), optionally with friction_force_mN, sheared_image and test",
)


@dataclass(frozen=True)
class Shot:
    """An image with its forces [N]; `sheared` is the image at the peak of the friction force, if any."""

    image: ImageFile
    sheared: ImageFile | None = None
    test: str = ""
    load: float = math.nan
    friction_force: float = math.nan


def shots(
    images: Sequence[ImageFile], forces: str | Path | Table | None = None
) -> tuple[list[Shot], list[Note]]:
    """Return the images with their forces, in the order of the images, and warnings on what is left out.

    `forces` is a table. Its columns are ``image``, ``load`` with its unit, such as ``load_mN``, and
    optionally ``friction_force`` with its unit, ``sheared_image`` and ``test``. An image is named by its
    file, and a page of a stack as ``stack.tif:3``. A line is left out if its image does not exist, and a
    sheared image is left out if it does not exist. Raise InvalidInput, with line and column, if an entry
    cannot be read or if no line is left.
    """
    if forces is None:
        return [Shot(image) for image in images], []
    entries = COLUMNS.read(forces)
    load, force = entries.numbers("load", empty=True), entries.numbers("friction_force", empty=True)
    rows = zip(*(entries.texts(name) for name in ("image", "sheared_image", "test")), strict=True)
    notes = _misspelt(entries)
    names = {f"{image.name}:1": image for image in images} | {image.name: image for image in images}
    used: dict[str, int] = {}
    found: dict[str, Shot] = {}
    absent: InvalidInput | None = None
    for row, (first, second, test) in enumerate(rows):
        for column, what, empty in (("image", "name", not first), ("load", "load", math.isnan(load[row]))):
            if empty:
                raise InvalidInput(f"{entries.cell(row, column)} is empty; write the {what} of the image")
        both: list[ImageFile | None] = []
        for column, name, what in (("image", first, "line"), ("sheared_image", second, "sheared image")):
            image = names.get(name)
            if image is not None:
                if image.name in used:
                    raise InvalidInput(
                        f"{entries.cell(row, column)} = {shown(name, 60)} is in line {used[image.name]} too"
                    )
                used[image.name] = entries.table.rows[row][0]
            elif name:
                absent = InvalidInput(f"{entries.cell(row, column)} = {_absent(name, names)}")
                notes.append(Note(f"the {what} is left out: {absent}"))
            both.append(image)
            if both[0] is None:
                break
        if both[0] is not None:
            found[both[0].name] = Shot(both[0], both[1], test, float(load[row]), float(force[row]))
    if absent is not None and not found:
        raise absent
    without = [image.name for image in images if image.name not in used]
    if without:
        are = "is" if len(without) == 1 else "are"
        notes.append(Note(f"{listed(without)} {are} not in the table of forces: the load is empty"))
    # a sheared image belongs to the Shot of its image before shear, and does not get its own Shot
    leading = [image for image in images if image.name in found or image.name not in used]
    return [found.get(image.name) or Shot(image) for image in leading], notes


def _absent(name: str, names: dict[str, ImageFile]) -> str:
    """Return the error text for a name in the table that is not the name of an image."""
    pages = list(dict.fromkeys(image.name for image in names.values() if image.name.startswith(f"{name}:")))
    near = get_close_matches(name, list(names), 1)
    hint = f"; did you mean {printable(near[0], 60)}?" if near else ""
    if pages:
        hint = f"; it has {len(pages)} pages, name one as {printable(pages[0], 60)}"
    return f"{shown(name, 60)} is not among the images{hint}"


def _misspelt(entries: Entries) -> list[Note]:
    """Return warnings on columns that are not read, but whose names resemble that of a missing column."""
    known = {*COLUMNS.units, *COLUMNS.plain}
    lacking = [COLUMNS.title(name) for name in sorted(known - entries.columns.keys())]
    near = ((title, get_close_matches(title, lacking, 1)) for title in entries.unread)
    return [
        Note(f"{entries.table.name}: the column {printable(title, 40)} is not read; did you mean {names[0]}?")
        for title, names in near
        if names
    ]
