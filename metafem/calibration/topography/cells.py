"""Mean heights of a map over large square cells, for the base plane and the search for summits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.progress import each

# Number of pixels that are read at once, in bands of rows (32 MB in double precision).
AT_ONCE = 2**22

# A cell is used if at least this fraction of its pixels was measured.
MEASURED = 0.1


@dataclass(frozen=True, eq=False)
class HeightMap:
    """Heights [mm] of pixels, (rows, columns), nan where not measured, and the size of the pixels [mm].

    The origin is the lower left corner of the map. y points upwards, and the first row is at the top. `sign`
    is -1 for the map of a mould.
    """

    values: NDArray[np.floating]
    pixel: tuple[float, float]
    sign: float = 1.0

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height of the map [mm]."""
        rows, columns = self.values.shape
        return self.pixel[0] * columns, self.pixel[1] * rows

    def x(self, columns: slice) -> FloatArray:
        """Return the x coordinates of the centres of columns [mm]."""
        return self.pixel[0] * (np.arange(columns.start, columns.stop) + 0.5)

    def y(self, rows: slice) -> FloatArray:
        """Return the y coordinates of the centres of rows [mm]."""
        return self.pixel[1] * (len(self.values) - np.arange(rows.start, rows.stop) - 0.5)

    def window(self, centre: FloatArray, reach: float) -> tuple[slice, slice]:
        """Return the rows and columns of the square window with half-width `reach` [mm] about a point."""
        rows, columns = self.values.shape
        column = np.rint((centre[0] + np.array([-reach, reach])) / self.pixel[0])
        row = np.rint(rows - (centre[1] + np.array([reach, -reach])) / self.pixel[1])
        (left, right), (top, bottom) = np.clip(column, 0, columns), np.clip(row, 0, rows)
        return slice(int(top), int(bottom)), slice(int(left), int(right))

    def heights(self, rows: slice, columns: slice) -> FloatArray:
        """Return the heights in a window in double precision [mm]; values that are not finite become nan."""
        found = np.asarray(self.sign * self.values[rows, columns].astype(np.float64))
        found[~np.isfinite(found)] = np.nan
        return found


@dataclass(frozen=True, eq=False)
class Cells:
    """Mean heights of the cells of a map, (rows, columns); nan if too few pixels of a cell were measured."""

    mean: FloatArray
    x: FloatArray
    y: FloatArray
    size: float


def cells(
    height_map: HeightMap, side: int, expected: Callable[[slice, slice], FloatArray] | None = None
) -> Cells:
    """Return means over cells of `side` x `side` pixels, without incomplete cells at the right and bottom.

    `expected` returns heights for rows and columns that are subtracted from the pixels [mm].
    """
    rows, columns = (length // side for length in height_map.values.shape)
    mean = np.empty((rows, columns))
    at_once = max(1, AT_ONCE // (columns * side * side))
    whole = slice(0, columns * side)
    for start in each("reading the map", range(0, rows, at_once)):
        stop = min(start + at_once, rows)
        within = slice(start * side, stop * side)
        band = height_map.heights(within, whole)
        if expected is not None:
            band -= expected(within, whole)
        blocks = band.reshape(stop - start, side, columns, side)
        known = np.isfinite(blocks)
        count = known.sum(axis=(1, 3))
        total = np.where(known, blocks, 0.0).sum(axis=(1, 3))
        enough = count >= MEASURED * side * side
        mean[start:stop] = np.where(enough, total / np.maximum(count, 1), np.nan)
    width, height = side * height_map.pixel[0], side * height_map.pixel[1]
    x = width * (np.arange(columns) + 0.5)
    y = height_map.pixel[1] * len(height_map.values) - height * (np.arange(rows) + 0.5)
    return Cells(mean, x, y, max(width, height))
