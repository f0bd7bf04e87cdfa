"""Patches of cells around the contacts, on one common grid.

All lengths are in cells. The origin of the grid is the centre of the bounding box of all summits, so that the
grid moves with the surface. Cell (i, j) has its centre at (i, j).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from metafem._validate import FloatArray
from metafem.models.boundary_elements.far_field import convergence_rate
from metafem.models.boundary_elements.summits import Summits

IntArray = NDArray[np.int64]

# Boxes are merged into one patch if each term of the expansion between them reduces the error by less than
# this factor. At this rate 23 terms per side are needed for the tolerance of the far field, and their table
# costs as much as the patch.
SLOWEST_RATE = 2.4


@dataclass(frozen=True, eq=False)
class Patch:
    """A rectangle of cells around one contact or several close contacts."""

    corner: IntArray  # grid indices of the first cell, (2,)
    gap: FloatArray  # depth of the undeformed surface below the tallest summit, (rows, columns), in cells
    owner: IntArray  # index of the asperity with the highest surface in each cell, (rows, columns)

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns."""
        rows, columns = self.gap.shape
        return rows, columns

    @property
    def centre(self) -> FloatArray:
        """Centre of the rectangle, (2,)."""
        return np.asarray(self.corner + 0.5 * (np.array(self.shape) - 1))


def box_rate(first: IntArray, last: IntArray) -> FloatArray:
    """Return the convergence rates of expansions between boxes of cells, (m, m)."""
    centre = np.asarray(0.5 * (first + last), dtype=np.float64)
    half = np.asarray(0.5 * (last - first + 1), dtype=np.float64)
    return convergence_rate(centre, half)


def boxes(summits: Summits, half_width: FloatArray) -> tuple[list[IntArray], IntArray, IntArray]:
    """Return the members (summits), first cells (m, 2) and last cells (m, 2) of the patches.

    half_width: half the width of the box of cells around each summit, (n,); 0 if it has no cells.
    """
    used = np.flatnonzero(half_width > 0.0)
    first = np.floor(summits.position[used] - half_width[used, None]).astype(np.int64)
    last = np.ceil(summits.position[used] + half_width[used, None]).astype(np.int64)
    members = [np.array([i]) for i in used]
    while len(members) > 1:
        rate = box_rate(first, last)
        a, b = np.nonzero(np.triu(rate < SLOWEST_RATE, 1))
        if a.size == 0:
            break
        graph = coo_array((np.ones(a.size), (a, b)), shape=rate.shape)
        count, label = connected_components(graph, directed=False)
        groups = [np.flatnonzero(label == k) for k in range(count)]
        first = np.array([first[g].min(axis=0) for g in groups])
        last = np.array([last[g].max(axis=0) for g in groups])
        members = [np.concatenate([members[i] for i in g]) for g in groups]
    return members, first, last


def patch(summits: Summits, members: IntArray, first: IntArray, last: IntArray) -> Patch:
    """Return the patch with the cells from `first` to `last`, and the depth of the surface on these cells."""
    inside = np.flatnonzero(((summits.position >= first) & (summits.position <= last)).all(axis=1))
    x, y = (np.arange(a, b + 1, dtype=np.float64) for a, b in zip(first, last, strict=True))
    gap = np.full((len(x), len(y)), np.inf)
    owner = np.zeros(gap.shape, dtype=np.int64)
    for i in np.union1d(members, inside):
        cx, cy = summits.position[i]
        square = (x - cx)[:, None] ** 2 + (y - cy)[None, :] ** 2
        depth = summits.depth[i] + summits.depth_beside(i, square)
        higher = depth < gap
        gap[higher] = depth[higher]
        owner[higher] = i
    return Patch(first, gap, owner)
