"""The description of an image, which is a file or a page of a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

# Largest number of pixels of an image that is read; the measurement of 1e8 pixels takes 2 GiB of memory.
MOST_PIXELS = 10**8


class Damaged(Exception):
    """Error for an image that cannot be read; its text is the reason, without the name of the image."""


@dataclass(frozen=True)
class Resolution:
    """Sides of a pixel along x and y [mm], and the part of the file that states them."""

    x: float
    y: float
    source: str


@dataclass(frozen=True)
class ImageFile:
    """One image, which is a file or a page of a file.

    `name` is the name of the file. If the file has several pages, the name ends with the number of the page,
    counted from 1, such as ``stack.tif:3``. `broken` is the reason why the image cannot be read, or "".
    `resolution` is the size of the pixels, if the file states it. `index` is the index of the page in the
    file, where reduced copies of images count as pages.
    """

    name: str
    path: Path
    broken: str = ""
    number: int = 1
    shape: tuple[int, int] = (0, 0)
    resolution: Resolution | None = None
    index: int = 0


def too_large(rows: int, columns: int) -> str:
    """Return the reason why an image is too large to be read, or "" if it is not too large."""
    if rows * columns <= MOST_PIXELS:
        return ""
    return f"has {columns} x {rows} pixels; at most {MOST_PIXELS:.0e} are read, crop it"


def damaged(error: BaseException, foreign: str, kind: str) -> Damaged:
    """Return the error for a file that a library cannot read.

    `foreign` is a part of the library's message for a file that is not of the kind `kind`.
    """
    text = getattr(error, "strerror", None) or " ".join(str(error).split())
    text = f"it is no {kind}, or damaged" if foreign in text else text or "it is damaged"
    return Damaged(f"cannot be read: {text}")
