"""Load and contact area of each asperity from a resolved pressure, all in units of the cell.

The second moments of the pressure about its centroid have ``s = sqrt(<x^2><y^2> - <xy>^2)``, and the
pressure on a Hertzian ellipse has the area ``5 pi s``. For other caps s = M/(2 P), and their law then gives
the area. The area of any other contact is found from its edge, near which p^2 falls linearly. The squared
pressure, divided by the square of the law's smooth factor, is extrapolated outwards by quadratic functions
along rows, columns and diagonals. The two outermost rings of cells, which collocation distorts, are left
out. The area is the region where the result, linear in triangles between the centres of the cells, is
positive.
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
# that are filled: the same and three outside.
DISTORTED, FILLED = 2, 5

# In a Hertz contact the edge is found this many cells outside the true one, and the area is smaller by this
# number of cells: means of six offsets, with 5 to 80 cells per radius.
EDGE, CURVED = 0.009, 0.22 * math.pi

# With n cells per radius the areas of a Hertz contact from the edge and from the moments differ by up to the
# first value plus the second times n, in cells over pi (measured at the same offsets); those of other caps
# by up to twice as much (powers from 1 to 8, spheres and tables).
DIFFERENCE, DIFFERENCE_BY_CELL, OTHER_CAPS = 0.5, 0.002, 2.0

# In a gap between two contacts, up to twice this number of cells wide, the level of an open cell is at most
# this negative multiple of that of an adjacent closed cell: the edge is up to 0.62 cells beyond the centre of
# a closed cell. The pressure rises so steeply there that the quadratic functions find the edge farther out.
NARROW, BOUND = 6, 0.61

# With fewer cells than this, 4.7 per radius, the area is the number of cells, corrected at the edge.
SMALL = 70

# A pressure on whole cells extends this far beyond the edge, in cells (measured on one Hertz contact with 12
# to 100 cells per radius).
RIM = 0.115

# Steps to the neighbours of a cell.
STEPS = ((1, 0), (0, 1), (1, 1), (1, -1), (-1, 0), (0, -1), (-1, -1), (-1, 1))


@dataclass(frozen=True, eq=False)
class Contacts:
    """Loads and areas of the asperities (n,), in units of the cell."""

    load: FloatArray  # sum of p/E* over the cells on which the asperity is the highest
    area: FloatArray  # contact area on these cells
    # whether the area is that within the edge instead of the law's area for the second moments
    deformed: NDArray[np.bool_]
    merged: IntArray  # pairs of asperities whose contacts share an edge of a cell, (m, 2)


def measure(patches: list[Patch], pressure: list[FloatArray], summits: Summits) -> Contacts:
    """Sum the pressure of each asperity, and find merged contacts."""
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
        area += _areas(p / shape, patch.owner, count)
    merged = np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)
    difference = DIFFERENCE * math.pi + DIFFERENCE_BY_CELL * np.sqrt(math.pi * area)
    deformed = np.abs(area - lawful) > difference * (1.0 if summits.paraboloids else OTHER_CAPS)
    deformed[merged.ravel()] = True
    return Contacts(load, np.where(deformed, area, lawful), deformed, merged)


def _moments(density: FloatArray) -> tuple[float, FloatArray]:
    """Return s, the root of the determinant of a pressure's second moments, and the centroid (2,)."""
    x, y = (np.arange(n, dtype=np.float64) for n in density.shape)
    along_x, along_y = density.sum(axis=1), density.sum(axis=0)
    centroid = np.array([x @ along_x, y @ along_y])
    x, y = x - centroid[0], y - centroid[1]
    square = (x**2 @ along_x) * (y**2 @ along_y) - (x @ density @ y) ** 2
    return math.sqrt(max(square, 0.0)), centroid


def _areas(pressure: FloatArray, owner: IntArray, count: int) -> FloatArray:
    """Return the area within the edges of the contacts on the cells of each asperity, (n,)."""
    # room for the rings outside and three more cells
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
    return np.asarray(np.where(cells >= SMALL, smooth, np.maximum(cells - RIM * rim, 0.0)))


def _extrapolated(pressure: FloatArray, closed: NDArray[np.bool_]) -> FloatArray:
    """Return squares of the pressure within the contacts and around them; slightly negative far from them."""
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
    """Return the open cells that have closed cells nearby on opposite sides."""
    between = np.zeros_like(closed)
    for dx, dy in STEPS[:4]:
        ahead, behind = (
            np.logical_or.reduce([np.roll(closed, (k * dx, k * dy), (0, 1)) for k in range(*steps)])
            for steps in ((1, NARROW + 1), (-NARROW, 0))
        )
        between |= ahead & behind
    return np.asarray(between & ~closed)


def _surrounded(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return whether all neighbours of each cell are among the cells."""
    return np.asarray(np.logical_and.reduce([np.roll(cells, step, (0, 1)) for step in STEPS]))


def _covered(level: FloatArray, owner: IntArray, count: int) -> FloatArray:
    """Return the area of each asperity, (n,), where the level is positive."""
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
