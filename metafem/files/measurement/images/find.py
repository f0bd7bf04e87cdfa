"""Image files of contacts: TIFF, with one or several pages, and PNG. Grey values are read on access."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._extras import refuse_missing
from metafem._given import printable
from metafem.errors import InvalidInput, refuse_if
from metafem.files.atomic import is_of_kind
from metafem.files.measurement.images import png, tiff
from metafem.files.measurement.images.pages import Damaged, ImageFile
from metafem.files.reading import file_label
from metafem.progress import message

# Readers by the extension of a file, and extensions of images and videos that are not read.
FORMATS = {".tif": tiff, ".tiff": tiff, ".png": png}
OTHERS = {".jpg", ".jpeg", ".bmp", ".gif", ".webp", ".avi", ".mp4", ".czi", ".nd2", ".lif", ".raw", ".jp2"}

# Weights of red, green and blue in the luminance, from Recommendation ITU-R BT.709.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


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
    image that is `broken`. Raise InvalidInput for a name that does not exist, a file of another format or a
    folder without an image.
    """
    refuse_missing("tifffile", "images", "reading images")
    paths: list[Path] = []
    for source in map(Path, sources):
        paths += _in_folder(source) if source.is_dir() else [_checked(source)]
    once: dict[Path, Path] = {}
    for path in paths:
        once.setdefault(path.absolute(), path)
    files = [image for path in once.values() for image in _pages(path)]
    count = Counter(image.name for image in files)
    # images of the same name in different folders are named with their folders
    return [
        replace(image, name=str(image.path.parent / image.name)) if count[image.name] > 1 else image
        for image in files
    ]


def read_image(image: ImageFile) -> tuple[NDArray[Any], bool]:
    """Return the grey values, (rows, columns) with row 0 at the top, and whether the image is in colour.

    Raise InvalidInput, which names the image, if the image cannot be read.
    """
    refuse_if(image.broken, f"{printable(image.name)}: {image.broken}")
    try:
        values = FORMATS[image.path.suffix.lower()].read(image)
    except Damaged as error:
        raise InvalidInput(f"{printable(image.name)}: {error}") from None
    return _grey(values)


def natural(name: str) -> list[tuple[int, str]]:
    """Return a key that sorts names with numbers in natural order: a2 before a10."""
    parts = re.split(r"(\d+)", name.casefold())
    return [(int(part), "") if i % 2 else (-1, part) for i, part in enumerate(parts)]


def _grey(values: NDArray[Any]) -> tuple[NDArray[Any], bool]:
    """Return the grey values, (rows, columns), and whether the colours of `values` differ.

    The shape of `values` is (rows, columns) or (rows, columns, channels).
    """
    if values.ndim == 2:
        return values, False
    colours = values[..., :3] if values.shape[2] > 2 else values[..., :1]
    if (colours == colours[..., :1]).all():
        return np.ascontiguousarray(colours[..., 0]), False
    grey = colours @ LUMINANCE
    # integers remain integers, because saturated pixels are recognised by the ends of the integer scale
    return (np.rint(grey) if values.dtype.kind in "ui" else grey).astype(values.dtype), True


def _in_folder(folder: Path) -> list[Path]:
    """Return the paths of the images in a folder, in natural order; figures by metafem are left out."""
    names = [entry for entry in folder.iterdir() if not entry.name.startswith(".")]
    names.sort(key=lambda entry: (natural(entry.name), entry.name))
    found = [entry for entry in names if entry.suffix.lower() in FORMATS and not entry.is_dir()]
    drawn = [entry for entry in found if _is_drawing(entry)]
    for what, entries in (
        ("no TIFF or PNG", [entry for entry in names if entry.suffix.lower() in OTHERS]),
        ("drawings by metafem", drawn),
    ):
        which = printable(", ".join(entry.name for entry in entries), 80)
        if entries:
            message(f"{file_label(folder)}: not read, because they are {what}: {which}")
    found = [entry for entry in found if entry not in drawn]
    refuse_if(not found, f"{file_label(folder)} holds no TIFF or PNG image")
    return found


def _is_drawing(path: Path) -> bool:
    """Return whether metafem wrote the file as a figure, for example in an earlier measurement."""
    with suppress(OSError):
        return is_of_kind(path, "figure")
    return False


def _checked(path: Path) -> Path:
    """Return the path; raise InvalidInput if there is no such file, or if its format is not read."""
    exists = False
    with suppress(OSError, ValueError):
        exists = path.exists()
    refuse_if(not exists, f"{file_label(path)}: no such file or folder")
    kind = path.suffix.lower()
    why = "; JPEG changes grey levels at the edges of contacts" if kind in (".jpg", ".jpeg") else ""
    must = f"is no image that can be read; save it as TIFF or PNG{why}"
    refuse_if(kind not in FORMATS, f"{file_label(path)} {must}")
    return path


def _pages(path: Path) -> list[ImageFile]:
    """Return the images in a file; the part of a stack after a damaged page is one broken image."""
    images: list[ImageFile]
    try:
        images, damage = FORMATS[path.suffix.lower()].pages(path)
    except Damaged as error:
        return [ImageFile(path.name, path, str(error))]
    if damage:
        images = [*images, ImageFile(path.name, path, damage, len(images) + 1)]
    if len(images) == 1:
        return images
    return [replace(image, name=f"{path.name}:{image.number}") for image in images]
