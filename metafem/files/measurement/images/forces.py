"""Tables of the forces at which images were taken."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from metafem._given import printable, shown
from metafem.errors import InvalidInput
from metafem.files.csv_rows import Table, read_table
from metafem.files.measurement.images.find import ImageFile
from metafem.files.units import factor
from metafem.notes import Note

EXAMPLE = "image,load_mN"
# Images that a note names.
NAMED = 5

FORCES, TEXTS = ("load", "friction_force"), ("image", "sheared_image", "test")


@dataclass(frozen=True)
class Shot:
    """One image, the image at the peak of the friction force if there is one, and the forces [N]."""

    image: ImageFile
    sheared: ImageFile | None = None
    test: str = ""
    load: float = math.nan
    friction_force: float = math.nan


@dataclass(frozen=True)
class Row:
    """One line of a table of forces [N]."""

    line: int
    image: str
    sheared_image: str
    test: str
    load: float
    friction_force: float


def shots(images: Sequence[ImageFile], forces: str | Path | None = None) -> tuple[list[Shot], list[Note]]:
    """Return the images with their forces, in the order of the images, and warnings of what is left out.

    `forces` is a table with the columns ``image`` and ``load`` with its unit, as ``load_mN``, and optionally
    ``friction_force`` with its unit, ``sheared_image`` and ``test``. An image is named by its file, a page of
    a stack as ``stack.tif:3``. A line whose image does not exist is left out, as is a sheared image. Raise
    InvalidInput, which names line and column, for what cannot be read and if no line is left.
    """
    if forces is None:
        return [Shot(image) for image in images], []
    table, rows, notes = _rows(Path(forces))
    names = {image.name: image for image in images}
    names |= {f"{image.name}:1": image for image in images if f"{image.name}:1" not in names}
    used: dict[str, int] = {}
    found: dict[str, Shot] = {}
    absent: InvalidInput | None = None
    for row in rows:
        both: list[ImageFile | None] = []
        for column, name in (("image", row.image), ("sheared_image", row.sheared_image)):
            if not name and column == "image":
                raise InvalidInput(
                    f"{table.name}, line {row.line}: image is empty; write the name of the image"
                )
            if name and name not in names:
                absent = InvalidInput(_absent(table, row.line, column, name, names))
                what = "the line" if column == "image" else "the sheared image"
                notes.append(Note(f"{what} is left out: {absent}"))
                if column == "image":
                    break
            image = names.get(name)
            if image is not None:
                if image.name in used:
                    raise InvalidInput(
                        f"{table.name}, line {row.line}: {column} = {shown(name, 60)} is in line "
                        f"{used[image.name]} too"
                    )
                used[image.name] = row.line
            both.append(image)
        if both and both[0] is not None:
            found[both[0].name] = Shot(both[0], both[1], row.test, row.load, row.friction_force)
    if absent is not None and not found:
        raise absent
    without = [image.name for image in images if image.name not in used]
    ordered = [found.get(image.name) or Shot(image) for image in images if _leads(image, found, used)]
    if without:
        which = ", ".join(without[:NAMED]) + (
            f" and {len(without) - NAMED} more" if len(without) > NAMED else ""
        )
        are = "is" if len(without) == 1 else "are"
        notes.append(Note(f"{which} {are} not in the table of forces: the load is empty"))
    return ordered, notes


def _leads(image: ImageFile, found: dict[str, Shot], used: dict[str, int]) -> bool:
    """Whether an image is not the sheared one of another."""
    return image.name in found or image.name not in used


def _absent(table: Table, line: int, column: str, name: str, names: dict[str, ImageFile]) -> str:
    """Return that a name in the table is not that of an image."""
    pages = list(dict.fromkeys(image.name for image in names.values() if image.name.startswith(f"{name}:")))
    near = get_close_matches(name, list(names), 1)
    hint = f"; did you mean {printable(near[0], 60)}?" if near else ""
    if pages:
        hint = f"; it has {len(pages)} pages, name one as {printable(pages[0], 60)}"
    return f"{table.name}, line {line}: {column} = {shown(name, 60)} is not among the images{hint}"


def _rows(path: Path) -> tuple[Table, list[Row], list[Note]]:
    """Read the table, with warnings of columns whose names may be misspelt."""
    table = read_table(path, EXAMPLE)
    columns = _columns(table)
    misspelt = _misspelt(table, columns)
    table.report_unread([*(table.header[column] for column, _ in columns.values()), *misspelt])
    rows = []
    for line, entries in table.entries():
        text = {name: entries[columns[name][0]].strip() if name in columns else "" for name in TEXTS}
        force = {name: _force(table, line, entries, columns.get(name)) for name in FORCES}
        if math.isnan(force["load"]):
            title = table.header[columns["load"][0]]
            raise InvalidInput(f"{table.name}, line {line}: {title} is empty; write the load of the image")
        names = (text["image"], text["sheared_image"], text["test"])
        rows.append(Row(line, *names, force["load"], force["friction_force"]))
    if not rows:
        raise InvalidInput(f"{table.name} names columns but holds no image")
    notes = [
        Note(f"{table.name}: the column {printable(title, 40)} is not read; did you mean {near}?")
        for title, near in misspelt.items()
    ]
    return table, rows, notes


def _misspelt(table: Table, columns: dict[str, tuple[int, str]]) -> dict[str, str]:
    """Return the columns that are not read and whose names are near to those of one that is lacking."""
    read = {column for column, _ in columns.values()}
    unit = columns["load"][1]
    lacking = [title for title in (f"friction_force_{unit}", *TEXTS) if not title.startswith(tuple(columns))]
    near = {
        title: get_close_matches(title, lacking, 1)
        for column, title in enumerate(table.header)
        if column not in read
    }
    return {title: names[0] for title, names in near.items() if names}


def _force(table: Table, line: int, entries: list[str], column: tuple[int, str] | None) -> float:
    """Return a force [N], nan where it is empty."""
    if column is None or not entries[column[0]].strip():
        return math.nan
    return float(table.number(line, column[0], entries[column[0]]) * factor(column[1], "N"))


def _columns(table: Table) -> dict[str, tuple[int, str]]:
    """Return the number of each known column and its unit."""
    found: dict[str, tuple[int, str]] = {}
    for column, title in enumerate(table.header):
        name, _, unit = (title, "", "") if title in TEXTS else title.rpartition("_")
        if title in FORCES:
            raise InvalidInput(
                f"{table.name}: column {title} needs a unit in its name; write {title}_mN or {title}_N"
            )
        if name not in FORCES and name not in TEXTS:
            continue
        if name in found:
            raise InvalidInput(f"{table.name}: {name} is in two columns; keep one")
        if name in FORCES:
            try:
                factor(unit, "N")
            except InvalidInput as error:
                raise InvalidInput(f"{table.name}: column {printable(title, 40)} {error}") from None
        found[name] = (column, unit)
    missing = [title for name, title in (("image", "image"), ("load", "load_mN")) if name not in found]
    if missing:
        raise InvalidInput(
            f"{table.name} lacks the column{'s' * (len(missing) > 1)} {', '.join(missing)}; it has "
            f"{printable(', '.join(table.header))}. The first line must be {EXAMPLE}, optionally with "
            "friction_force_mN, sheared_image and test"
        )
    return found
