"""Image files of contacts, whose grey values are read on access, and the forces at which they were taken."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._extras import refuse_missing
from metafem._given import printable, shown
from metafem.errors import InvalidInput, refuse_if
from metafem.files.disk import MARK, file_label
from metafem.files.tables import Columns, Entries, Table
from metafem.notes import Note
from metafem.progress import message

# Extensions of the files that are read.
FORMATS = (".tif", ".tiff", ".png")

# Weights of red, green and blue in the luminance, from Recommendation ITU-R BT.709.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class ImageFile:
    """One image, which is a file or a page of a file.

    `name` is the path of the file as it was given, or its name in the folder that was given. If the file has
    several pages, the name ends with the number of the page, counted from 1, such as ``stack.tif:3``.
    `broken` is the reason why the image cannot be read, or "".
    """

    name: str
    path: Path
    broken: str = ""
    page: int = 0


class Images(Sequence[NDArray[Any]]):
    """A sequence of the grey values of images, (rows, columns) each, which are read from a file on access.

    The grey values of an image in colour are its luminance. `coloured` holds the names of such images that
    were read.
    """

    def __init__(self, files: Sequence[ImageFile]) -> None:
        self.files = tuple(files)
        self.coloured: dict[str, None] = {}

    def __len__(self) -> int:
        return len(self.files)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return Images(self.files[index])
        values, coloured = read_image(self.files[index])
        if coloured:
            self.coloured[self.files[index].name] = None
        return values


def find_images(sources: Iterable[str | Path]) -> list[ImageFile]:
    """Return all images in files and folders; every page of a file is one image.

    The files of a folder are in natural order, 2 before 10. A file that cannot be opened is returned as an
    image that is `broken`. Raise InvalidInput for a name that does not exist, a file of another format, a
    folder without an image, or two images of one name.
    """
    refuse_missing("imageio", "images", "reading images")
    paths: list[Path] = []
    for source in map(Path, sources):
        paths += _in_folder(source) if source.is_dir() else [_checked(source)]
    files = [image for path in paths for image in _pages(path)]
    for name, count in Counter(image.name for image in files).items():
        refuse_if(count > 1, f"two images have the name {printable(name)}; give them different names")
    return files


def read_image(image: ImageFile) -> tuple[NDArray[Any], bool]:
    """Return the grey values, (rows, columns) with row 0 at the top, and whether the image is in colour.

    Raise InvalidInput, which names the image, if the image cannot be read.
    """
    from imageio.v3 import imread

    refuse_if(image.broken, f"{printable(image.name)}: {image.broken}")
    try:
        return _grey(imread(image.path, index=image.page, plugin="pillow"))
    except (OSError, ValueError, SyntaxError, EOFError) as error:
        raise InvalidInput(f"{printable(image.name)}: {_unreadable(error)}") from None


def natural(name: str) -> list[tuple[int, str]]:
    """Return a key that sorts names with numbers in natural order: a2 before a10."""
    parts = re.split(r"(\d+)", name.casefold())
    return [(int(part), "") if i % 2 else (-1, part) for i, part in enumerate(parts)]


def _grey(values: NDArray[Any]) -> tuple[NDArray[Any], bool]:
    """Return the grey values, (rows, columns), and whether the colours of `values` differ.

    The shape of `values` is (rows, columns) or (rows, columns, channels).
    """
    if values.ndim == 2:
        return values.astype(values.dtype.newbyteorder("="), copy=False), False
    colours = values[..., :3] if values.shape[2] > 2 else values[..., :1]
    if (colours == colours[..., :1]).all():
        return np.ascontiguousarray(colours[..., 0]), False
    grey = colours @ LUMINANCE
    # integers remain integers, because saturated pixels are recognised by the ends of the integer scale
    return (np.rint(grey) if values.dtype.kind in "ui" else grey).astype(values.dtype), True


def _in_folder(folder: Path) -> list[Path]:
    """Return the paths of the images in a folder, in natural order; figures by metafem are left out."""
    names = sorted(folder.iterdir(), key=lambda entry: (natural(entry.name), entry.name))
    found = [entry for entry in names if entry.suffix.lower() in FORMATS and entry.is_file()]
    found = [entry for entry in found if not entry.name.startswith(".")]
    drawn = [entry for entry in found if _is_drawing(entry)]
    if drawn:
        which = printable(", ".join(entry.name for entry in drawn), 80)
        message(f"{file_label(folder)}: not read, because they are drawings by metafem: {which}")
    found = [entry for entry in found if entry not in drawn]
    refuse_if(not found, f"{file_label(folder)} holds no TIFF or PNG image")
    return found


def _is_drawing(path: Path) -> bool:
    """Return whether metafem wrote the file as a figure, for example in an earlier measurement."""
    with suppress(OSError), path.open("rb") as file:
        return MARK.encode() in file.read(200)
    return False


def _checked(path: Path) -> Path:
    """Return the path; raise InvalidInput if there is no such file, or if its format is not read."""
    exists = False
    with suppress(OSError, ValueError):
        exists = path.exists()
    refuse_if(not exists, f"{file_label(path)}: no such file or folder")
    must = "is no image that can be read; save it as TIFF or PNG"
    refuse_if(path.suffix.lower() not in FORMATS, f"{file_label(path)} {must}")
    return path


def _pages(path: Path) -> list[ImageFile]:
    """Return the images in a file; a file that cannot be opened is one broken image."""
    from imageio.v3 import improps

    try:
        everything: Any = ...
        count = improps(path, index=everything, plugin="pillow").n_images or 1
    except (OSError, ValueError, SyntaxError, EOFError) as error:
        return [ImageFile(path.name, path, _unreadable(error))]
    if count == 1:
        return [ImageFile(path.name, path)]
    return [ImageFile(f"{path.name}:{page + 1}", path, page=page) for page in range(count)]


def _unreadable(error: Exception) -> str:
    reason = getattr(error, "strerror", None) or " ".join(str(error).split())
    return f"cannot be read: {printable(reason, 200) or 'it is damaged'}"


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
    from metafem.calibration.contact_table import listed

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
