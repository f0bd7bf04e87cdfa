"""Nearest sites of a surface, among all periods if it has a periodic cell."""

from __future__ import annotations

import math

import numpy as np
import scipy

from metafem._validate import FloatArray, IntArray
from metafem.material import PeriodicCell

# Number of nearest neighbours that short-ranged sums include. On a lattice, asperities farther away add less
# than a hundredth.
NEIGHBOURS = 24


def neighbours(
    position: FloatArray, cell: PeriodicCell | None, some: int
) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return distances [mm], indices and relative positions of the nearest neighbours, (n, q), (n, q, 2).

    There are `some` neighbours, or fewer without a cell. With a cell they include sites of other periods, in
    particular those of the site itself.
    """
    if cell is None:
        distance, other = scipy.spatial.cKDTree(position).query(position, k=min(some + 1, len(position)))
        distance, other = distance[:, 1:], other[:, 1:]
        return distance, other, position[:, None] - position[other]
    # periods on each side, so that there are enough sites at the distances of the neighbours
    reach = math.sqrt((some + 1) * cell.area / len(position))
    sides = np.array([cell.width, cell.length])
    steps = [np.arange(-most, most + 1) for most in np.ceil(reach / sides).astype(int)]
    shift = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 1, 2) * sides
    images = (position + shift).reshape(-1, 2)
    distance, other = scipy.spatial.cKDTree(images).query(position, k=min(some + 1, len(images)))
    distance, other = distance[:, 1:], other[:, 1:]
    return distance, other % len(position), position[:, None] - images[other]


def close_pairs(
    position: FloatArray, cell: PeriodicCell | None, reach: float
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the pairs i, j of sites up to a distance, and their distances [mm].

    With a cell, the neighbours of each site are searched among all periods; each pair then counts once.
    """
    if cell is None:
        tree = scipy.spatial.cKDTree(position)
        i, j = tree.query_pairs(reach, output_type="ndarray").T
        return i, j, np.hypot(*(tree.data[i] - tree.data[j]).T)
    distance, other, apart = neighbours(position, cell, NEIGHBOURS)
    site = np.broadcast_to(np.arange(len(position))[:, None], other.shape)
    # of the two equal directions between periods of one site, only one counts
    once = (site < other) | ((site == other) & ((apart > 0.0) @ [2, 1] > (apart < 0.0) @ [2, 1]))
    kept = once & (distance <= reach)
    return site[kept], other[kept], distance[kept]
