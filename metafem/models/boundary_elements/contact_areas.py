"""Load and contact area of each asperity from a resolved pressure; all lengths are in cells.

The area follows from ``s = sqrt(<x^2><y^2> - <xy>^2)``, with the second moments of the pressure about its
centroid. A Hertzian ellipse has the area ``5 pi s``. For other caps M = 2 s P, and their law gives the area
for this second moment M.

The area of a contact with another shape is found from its edge, near which p^2 decreases linearly to zero.
The pressure is divided by the smooth factor of the law, squared, and extrapolated outwards by quadratic
functions along rows, columns and diagonals. The extrapolation does not use the two outermost rings of cells,
whose pressure is distorted by collocation. The result is interpolated linearly in triangles between the
centres of the cells, and the contact area is the region where it is positive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.models.boundary_elements.patches import IntArray, Patch
from metafem.models.boundary_elements.summits import Summits

# Number of rings of cells at the edge whose pressure is replaced by the extrapolation, and number of rings
# that the extrapolation fills: these and three more outside.
DISTORTED, FILLED = 2, 5

# Systematic errors of the area within the edge, for Hertz contacts: the edge lies EDGE cells outside the true
# edge, and the area is too small by CURVED cells. Both are means over six offsets with 5 to 80 cells per
# radius.
EDGE, CURVED = 0.009, 0.22 * math.pi

# Largest difference, in cells, between the areas of a Hertz contact from its edge and from its moments: pi
# times the sum of the first value and the second times n, with n cells per radius (measured at the same
# offsets). For other caps the difference is up to twice as large (powers from 1 to 8, spheres and tables).
DIFFERENCE, DIFFERENCE_BY_CELL, OTHER_CAPS = 0.5, 0.002, 2.0

# In a gap between two contacts that is at most 2 NARROW cells wide, the level of an open cell is limited to
# -BOUND times the level of an adjacent closed cell. The edge is then at most 0.62 cells beyond the centre of
# a closed cell. Without this limit the edge would be too far out, because the pressure is so steep there.
NARROW, BOUND = 6, 0.61

# For contacts of fewer cells than this, 4.7 per radius, the area is the number of cells with a correction at
# the edge. Caps other than paraboloids need 8 cells per radius: with fewer the extrapolation starts close to
# the axis, where the pressure is steep or flat, and the area is wrong by up to 100 cells (powers 1.2 to 8),
# while the number of cells is within 4.2 (25 offsets each), and differs by up to 4.7 from the law's area.
SMALL, SMALL_OTHER_CAPS, COUNTED = 70, 200, 5.0

# Distance by which the cells with pressure extend beyond the edge, in cells (measured for one Hertz contact
# with 12 to 100 cells per radius).
RIM = 0.115

# Steps to the neighbours of a cell.
STEPS = ((1, 0), (0, 1), (1, 1), (1, -1), (-1, 0), (0, -1), (-1, -1), (-1, 1))


@dataclass(frozen=True, eq=False)
class Contacts:
    """Loads and areas of the asperities (n,); lengths are in cells."""

    load: FloatArray  # sum of p/E* over the cells in which the asperity is the highest
    area: FloatArray  # contact area on these cells
    # whether the area is the area within the edge instead of the law's area for the second moments
    deformed: NDArray[np.bool_]
    merged: IntArray  # pairs of asperities with adjacent cells in contact, (m, 2)


def measure(patches: list[Patch], pressure: list[FloatArray], summits: Summits) -> Contacts:
    """Return the loads and areas of the asperities, and the merged contacts."""
    count = len(summits.radius)
    load, area, spread, shift = np.zeros((4, count))
    pairs = []
    for patch, p in zip(patches, pressure, strict=True):
        closed = p > 0.0
        for a, b in ((np.s_[1:, :], np.s_[:-1, :]), (np.s_[:, 1:], np.s_[:, :-1])):
            met = closed[a] & closed[b] & (patch.owner[a] != patch.owner[b])
            pairs.append(np.stack([patch.owner[a][met], patch.owner[b][met]], axis=1))
        load += np.bincount(patch.owner.ravel(), p.ravel(), count)
        for i in np.unique(patch.owner[closed]):
            spread[i], centroid = _moments(np.where(patch.owner == i, p, 0.0) / load[i])
            shift[i] = np.linalg.norm(centroid + patch.corner - summits.position[i])
    lawful = summits.areas(spread, load, shift)
    for patch, p in zip(patches, pressure, strict=True):
        shape = summits.pressure_shape(patch.corner, patch.owner, np.sqrt(lawful / math.pi))
        area += _areas(p / shape, patch.owner, count, SMALL if summits.paraboloids else SMALL_OTHER_CAPS)
    merged = np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)
    difference = DIFFERENCE * math.pi + DIFFERENCE_BY_CELL * np.sqrt(math.pi * area)
    if not summits.paraboloids:
        difference = np.where(area < SMALL_OTHER_CAPS, COUNTED, OTHER_CAPS * difference)
    deformed = np.abs(area - lawful) > difference
    deformed[merged.ravel()] = True
    return Contacts(load, np.where(deformed, area, lawful), deformed, merged)


def _moments(density: FloatArray) -> tuple[float, FloatArray]:
    """Return s, the square root of the determinant of the second moments, and the centroid (2,)."""
    x, y = (np.arange(n, dtype=np.float64) for n in density.shape)
    along_x, along_y = density.sum(axis=1), density.sum(axis=0)
    centroid = np.array([x @ along_x, y @ along_y])
    x, y = x - centroid[0], y - centroid[1]
    square = (x**2 @ along_x) * (y**2 @ along_y) - (x @ density @ y) ** 2
    return math.sqrt(max(square, 0.0)), centroid


def _areas(pressure: FloatArray, owner: IntArray, count: int, small: int) -> FloatArray:
    """Return the contact area within the edges on the cells of each asperity, (n,); see `SMALL`."""
    # padding for the rings outside and three more cells
    pressure, owner = np.pad(pressure, FILLED + 3), np.pad(owner, FILLED + 3, mode="edge")
    closed = pressure > 0.0
    edges = np.sum([closed & ~np.roll(closed, step, (0, 1)) for step in STEPS if 0 in step], axis=0)
    cells = np.bincount(owner.ravel(), closed.ravel(), count)
    rim = 0.25 * math.pi * np.bincount(owner.ravel(), edges.ravel(), count)
    level = _extrapolated(pressure, closed)
    beside = np.maximum.reduce([np.roll(level * closed, step, (0, 1)) for step in STEPS if 0 in step])
    level = np.where(_between(closed), np.minimum(level, -BOUND * beside), level)
    covered = _covered(level, owner, count)
    smooth = covered - EDGE * rim + CURVED
    return np.asarray(np.where(cells >= small, smooth, np.maximum(cells - RIM * rim, 0.0)))


def _extrapolated(pressure: FloatArray, closed: NDArray[np.bool_]) -> FloatArray:
    """Return the extrapolated square of the pressure in and near contacts; slightly negative elsewhere."""
    inner = closed
    for _ in range(DISTORTED):
        inner = inner & _surrounded(inner)
    known, level = inner.ravel().copy(), np.where(inner, pressure**2, 0.0).ravel()
    columns = pressure.shape[1]
    offsets = np.array([dx * columns + dy for dx, dy in STEPS])
    outermost = np.flatnonzero(inner & ~_surrounded(inner))
    for _ in range(FILLED):
        ring = np.unique((outermost[:, None] + offsets).ravel())
        ring = ring[~known[ring]]
        one, two, three = (ring[:, None] + k * offsets for k in (1, 2, 3))
        usable = known[one] & known[two] & known[three]
        number = usable.sum(axis=1)
        value = np.where(usable, 3.0 * level[one] - 3.0 * level[two] + level[three], 0.0).sum(axis=1)
        ring, value, number = ring[number > 0], value[number > 0], number[number > 0]
        level[ring] = value / number
        known[ring] = True
        outermost = ring
    level[~known] = -np.finfo(np.float64).tiny
    return level.reshape(pressure.shape)


def _between(closed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return whether each cell is open and has closed cells nearby on opposite sides."""
    between = np.zeros_like(closed)
    for dx, dy in STEPS[:4]:
        ahead, behind = (
            np.logical_or.reduce([np.roll(closed, (k * dx, k * dy), (0, 1)) for k in range(*steps)])
            for steps in ((1, NARROW + 1), (-NARROW, 0))
        )
        between |= ahead & behind
    return np.asarray(between & ~closed)


def _surrounded(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return whether all eight neighbours of each cell belong to `cells`."""
    return np.asarray(np.logical_and.reduce([np.roll(cells, step, (0, 1)) for step in STEPS]))


def _covered(level: FloatArray, owner: IntArray, count: int) -> FloatArray:
    """Return the area with a positive level on the cells of each asperity, (n,)."""
    corners = (np.s_[:-1, :-1], np.s_[1:, :-1], np.s_[1:, 1:], np.s_[:-1, 1:])
    used = np.flatnonzero(np.maximum.reduce([level[corner] for corner in corners]).ravel() > 0.0)
    values = [level[corner].ravel()[used] for corner in corners]
    owners = [owner[corner].ravel()[used] for corner in corners]
    middle = 0.25 * np.sum(values, axis=0)
    area = np.zeros(count)
    for k in range(4):  # triangles between the middle and the corners k and k - 1
        low, mean, high = np.sort([values[k], values[k - 1], middle], axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            one = high**2 / ((high - low) * (high - mean))
            two = 1.0 - low**2 / ((low - mean) * (low - high))
        part = np.where(high <= 0.0, 0.0, np.where(mean <= 0.0, one, np.where(low < 0.0, two, 1.0)))
        for corner in (k, k - 1):
            area += np.bincount(owners[corner], 0.125 * part, count)
    return area
