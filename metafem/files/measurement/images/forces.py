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

EXAMPLE = "image,load_mN"
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


def shots(images: Sequence[ImageFile], forces: str | Path | None = None) -> tuple[list[Shot], list[str]]:
    """Return the images with their forces, in the order of the images, and the names of those without.

    `forces` is a table with the columns ``image`` and ``load`` with its unit, as ``load_mN``, and optionally
    ``friction_force`` with its unit, ``sheared_image`` and ``test``. An image is named by its file, a page of
    a stack as ``stack.tif:3``. Raise InvalidInput, which names line and column, for what cannot be read and
    for images that do not exist.
    """
    if forces is None:
        return [Shot(image) for image in images], []
    table, rows = _rows(Path(forces))
    names = {image.name: image for image in images}
    names |= {f"{image.name}:1": image for image in images if f"{image.name}:1" not in names}
    used: dict[str, int] = {}
    found: dict[str, Shot] = {}
    for row in rows:
        both = []
        for column, name in (("image", row.image), ("sheared_image", row.sheared_image)):
            image = _named(table, row.line, column, name, names) if name else None
            if image is not None:
                if image.name in used:
                    raise InvalidInput(
                        f"{table.name}, line {row.line}: {column} = {shown(name, 60)} is in line "
                        f"{used[image.name]} too"
                    )
                used[image.name] = row.line
            both.append(image)
        if both[0] is None:
            raise InvalidInput(f"{table.name}, line {row.line}: image is empty; write the name of the image")
        found[both[0].name] = Shot(both[0], both[1], row.test, row.load, row.friction_force)
    without = [image.name for image in images if image.name not in used]
    ordered = [found.get(image.name) or Shot(image) for image in images if _leads(image, found, used)]
    return ordered, without


def _leads(image: ImageFile, found: dict[str, Shot], used: dict[str, int]) -> bool:
    """Whether an image is not the sheared one of another."""
    return image.name in found or image.name not in used


def _named(table: Table, line: int, column: str, name: str, names: dict[str, ImageFile]) -> ImageFile:
    """Return the image of a name in the table."""
    if name in names:
        return names[name]
    pages = list(dict.fromkeys(image.name for image in names.values() if image.name.startswith(f"{name}:")))
    near = get_close_matches(name, list(names), 1)
    hint = f"; did you mean {printable(near[0], 60)}?" if near else ""
    if pages:
        hint = f"; it has {len(pages)} pages, name one as {printable(pages[0], 60)}"
    raise InvalidInput(
        f"{table.name}, line {line}: {column} = {shown(name, 60)} is not among the images{hint}"
    )


def _rows(path: Path) -> tuple[Table, list[Row]]:
    """Read the table."""
    table = read_table(path, EXAMPLE)
    columns = _columns(table)
    table.report_unread([table.header[column] for column, _ in columns.values()])
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
    return table, rows


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
