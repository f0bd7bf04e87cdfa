"""Data of one image in a file."""

from __future__ import annotations

from dataclasses import dataclass

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
class Page:
    """An image in a file: its number from 1 and, if stated, the size of its pixels.

    `refused` is the reason why it is not read. `index` is its place in the file, including reduced copies of
    other images.
    """

    number: int
    rows: int
    columns: int
    resolution: Resolution | None = None
    refused: str = ""
    index: int = 0


def too_large(rows: int, columns: int) -> str:
    """Return the reason if an image is too large to be read."""
    if rows * columns <= MOST_PIXELS:
        return ""
    return f"has {columns} x {rows} pixels; at most {MOST_PIXELS:.0e} are read, crop it"
