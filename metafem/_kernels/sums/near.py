"""Sums over the pairs of points within a reach; the points are sorted into square cells.

The influence at a distance r is ``1/(pi scale) (1/s + g(s))`` with ``s = r/scale`` and the piecewise
polynomial g of `metafem._kernels.layer`; it vanishes beyond the table. The sources may be a part of the
points; the targets are all.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.layer import regular, value


class Cells(NamedTuple):
    """Sources sorted by cell; cell (row, column) contains the sources from start[row columns + column]."""

    position: np.ndarray  # row and column of the sources [mm], (m, 2)
    start: np.ndarray  # (rows columns + 1,)
    rows: int
    columns: int
    size: float  # side of a cell [mm]
    reach: float  # largest distance of pairs [mm]
    most: int  # upper bound of the number of sources that are near a target


@compiled
def rows_around(y, cells):
    """Return the first row of cells within reach, and the first row beyond."""
    first = max(0, math.floor((y - cells.reach) / cells.size))
    return first, min(cells.rows, math.floor((y + cells.reach) / cells.size) + 1)


@compiled
def sources_around(y, x, row, cells):
    """Return the first source in a row of cells whose cell is within reach, and the first source beyond."""
    away = max(row * cells.size - y, y - (row + 1) * cells.size, 0.0)
    half = math.sqrt(max(cells.reach * cells.reach - away * away, 0.0))
    first = max(0, math.floor((x - half) / cells.size))
    last = min(cells.columns - 1, math.floor((x + half) / cells.size))
    if last < first:
        return 0, 0
    return cells.start[row * cells.columns + first], cells.start[row * cells.columns + last + 1]


@compiled
def collect(y, x, cells, found, square):
    """Fill indices and squared distances [mm^2] of the sources within reach, except at 0; return how many.

    The loop has no branches, which the processor could not predict.
    """
    limit = cells.reach * cells.reach
    count = 0
    first, beyond = rows_around(y, cells)
    for row in range(first, beyond):
        start, end = sources_around(y, x, row, cells)
        for j in range(start, end):
            dy, dx = y - cells.position[j, 0], x - cells.position[j, 1]
            found[count] = j
            square[count] = dx * dx + dy * dy
            count += 1 if 0.0 < square[count] < limit else 0
    return count


@compiled
def displacements(position, cells, load, scale, table, low, high, out):
    """Fill G p [mm] at the targets from `low` to `high`."""
    found, square = np.empty(cells.most, dtype=np.int64), np.empty(cells.most)
    for i in range(low, high):
        count = collect(position[i, 0], position[i, 1], cells, found, square)
        total = 0.0
        for k in range(count):
            s = math.sqrt(square[k]) / scale
            total += load[found[k]] * (1.0 / s + value(s, table))
        out[i] = total / (math.pi * scale)


@compiled
def moments(position, cells, moment, scale, table, low, high, out):
    """Fill lap v + grad . w [mm] at the targets from `low` to `high`; moment: v, and w by row and column.

    The derivatives are at the source.
    """
    found, square = np.empty(cells.most, dtype=np.int64), np.empty(cells.most)
    for i in range(low, high):
        y, x = position[i, 0], position[i, 1]
        count = collect(y, x, cells, found, square)
        total = 0.0
        for k in range(count):
            j = found[k]
            tilt, laplacian = derivatives(math.sqrt(square[k]) / scale, table)
            dy, dx = y - cells.position[j, 0], x - cells.position[j, 1]
            total += laplacian * moment[0, j] - tilt * (dy * moment[1, j] + dx * moment[2, j])
        out[i] = total / (math.pi * scale * scale * scale)


@compiled
def fields(position, cells, load, scale, table, low, high, out):
    """Fill the Laplacian and the slopes by row and column of G p at the targets from `low` to `high`."""
    found, square = np.empty(cells.most, dtype=np.int64), np.empty(cells.most)
    unit = 1.0 / (math.pi * scale * scale * scale)
    for i in range(low, high):
        y, x = position[i, 0], position[i, 1]
        count = collect(y, x, cells, found, square)
        curvature = along = across = 0.0
        for k in range(count):
            j = found[k]
            tilt, laplacian = derivatives(math.sqrt(square[k]) / scale, table)
            curvature += laplacian * load[j]
            along += tilt * (y - cells.position[j, 0]) * load[j]
            across += tilt * (x - cells.position[j, 1]) * load[j]
        out[0, i] = unit * curvature
        out[1, i] = unit * along
        out[2, i] = unit * across


@compiled
def derivatives(s, table):
    """Return G'/s and the Laplacian G'' + G'/s of 1/s + g(s)."""
    _, first, second = regular(s, table)
    inverse = 1.0 / s
    cube = inverse * inverse * inverse
    tilt = first * inverse - cube
    return tilt, second + 2.0 * cube + tilt


@compiled
def fill_smooth(y, x, scale, table, out):
    """Fill ``-g(r/scale)/(pi scale)`` at the grid points (y, x)."""
    for i in range(y.size):
        for k in range(x.size):
            g = value(math.sqrt(y[i] * y[i] + x[k] * x[k]) / scale, table)
            out[i, k] = -g / (math.pi * scale)
