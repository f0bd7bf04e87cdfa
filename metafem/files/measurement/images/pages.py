"""What a file states of one of its images."""

from __future__ import annotations

from dataclasses import dataclass

# Pixels of the largest image that is read: one of 1e8 takes 2 GiB while it is measured.
MOST_PIXELS = 10**8


class Damaged(Exception):
    """An image that cannot be read; the text says why and follows its name."""


@dataclass(frozen=True)
class Resolution:
    """Sides of a pixel [mm] along x and y, and where they are stated."""

    x: float
    y: float
    source: str


@dataclass(frozen=True)
class Page:
    """An image in a file: its number from 1 and, if stated, the size of its pixels.

    `refused` says why it is not read. `index` is its place in the file, where reduced copies of other images
    count too.
    """

    number: int
    rows: int
    columns: int
    resolution: Resolution | None = None
    refused: str = ""
    index: int = 0


def too_large(rows: int, columns: int) -> str:
    """Return why an image is not read, if it is too large."""
    if rows * columns <= MOST_PIXELS:
        return ""
    return f"has {columns} x {rows} pixels; at most {MOST_PIXELS:.0e} are read, crop it"
