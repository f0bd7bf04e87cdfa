"""Images in files: one file, or a page of one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

# Largest number of pixels of an image that is read: 1e8 pixels take 2 GiB during the measurement.
MOST_PIXELS = 10**8


class Damaged(Exception):
    """An image that cannot be read; the text states the reason and follows its name."""


@dataclass(frozen=True)
class Resolution:
    """Sides of a pixel [mm] along x and y, and where they are stated."""

    x: float
    y: float
    source: str


@dataclass(frozen=True)
class ImageFile:
    """One image: a file, or a page of one.

    `name` is the name of the file, with the number of the page from 1 if it has several, as ``stack.tif:3``.
    `broken` is the reason why it is not read, "" for an image that is. `resolution` is the size of its
    pixels, if stated, and `index` its place in the file, including reduced copies of other images.
    """

    name: str
    path: Path
    broken: str = ""
    number: int = 1
    shape: tuple[int, int] = (0, 0)
    resolution: Resolution | None = None
    index: int = 0


def too_large(rows: int, columns: int) -> str:
    """Return the reason if an image is too large to be read."""
    if rows * columns <= MOST_PIXELS:
        return ""
    return f"has {columns} x {rows} pixels; at most {MOST_PIXELS:.0e} are read, crop it"


def damaged(error: BaseException, foreign: str, kind: str) -> Damaged:
    """Return the error of a file; `foreign` is a part of the library's text for a file of another `kind`."""
    text = getattr(error, "strerror", None) or " ".join(str(error).split())
    text = f"it is no {kind}, or damaged" if foreign in text else text or "it is damaged"
    return Damaged(f"cannot be read: {text}")
