"""Influence between the sites of a block, from solutions on a quarter of the block."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.fe.quarter import Quarter
from metafem.progress import each
from metafem.surface import Block

# Ratio of neighbouring cells near the bonded edge, and growth of the cell size per distance of the cell's
# outer end from the loaded region. Steeper grading reduces the accuracy: on 90 mm the influence is 1.2e-5 /mm
# off the layer's with 0.4, and 9e-6 /mm with 0.33. Gentler grading only adds cells.
EDGE_RATIO, OUTER_GROWTH = math.e, 0.33

# Largest number of cells in a quarter; the factorisation of the 55,000 unknowns takes 2 GiB and a minute. If
# more cells are needed, as in a wide and thin block, all cells are enlarged in steps of a tenth.
MOST_CELLS, STRETCH = 2000, 1.1

# Cell size of the second mesh, which serves the error estimate, over that of the first mesh.
COARSER = 1.6

# Step of the finite differences, over the distance from the site to the nearest face of the block. The field
# is analytic within this distance. The relative errors in the Laplacian are 2e-5 by truncation and 1e-11 by
# rounding.
STEP = 0.02

# Number of positions evaluated at once; the fields on the faces of the largest mesh then take 100 MB.
MOST_PLACES = 256

# Signs of a load's mirror images in x = 0 and in y = 0.
PARITIES = ((1, 1), (1, -1), (-1, 1), (-1, -1))


def site_influence(
    block: Block, poisson_ratio: float, position: FloatArray, cell: float, edge_cell: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, float, float]:
    """Return the fields of a `BlockInfluence` between sites (n, 2) [mm], computed on two meshes."""
    lines, stretch = quarter_lines(block, position, cell, edge_cell)
    coarser = COARSER * stretch
    fewer, _ = quarter_lines(block, position, coarser * cell, coarser * edge_cell)
    (value, *slopes), (coarse, *_) = (
        _remainder(block, Quarter(mesh, poisson_ratio), position) for mesh in each("mesh", (lines, fewer))
    )
    dx, dy = (position[:, None] - position).transpose(2, 0, 1)
    r = np.hypot(dx, dy)
    np.fill_diagonal(r, math.inf)
    point = 1.0 / (math.pi * r)
    return (
        point + 0.5 * (value + value.T),
        slopes[0] - point * dx / r**2,
        slopes[1] - point * dy / r**2,
        slopes[2] + point / r**2,
        float(np.abs(value - value.T).max()),
        float(np.abs(value - coarse).max()),
    )


def quarter_lines(
    block: Block, position: FloatArray, cell: float, edge_cell: float
) -> tuple[list[FloatArray], float]:
    """Return the vertices of a mesh for loads at `position`, (n, 2) [mm], and the factor on its cell sizes.

    The vertices run along x and y from the symmetry planes to the sides, and along z from the top to the
    base. `cell` is the size of the largest cells near the loads and `edge_cell` that of the last cells at the
    base and the sides, in units of the thickness. Both are enlarged if the mesh would exceed `MOST_CELLS`.
    """
    length = np.array([0.5 * block.width, 0.5 * block.length, block.thickness])
    reach = np.append(np.abs(position).max(axis=0), 0.0) + block.thickness
    # cells of equal size up to `reach` alone: a thin block would have millions until they are enlarged
    fewest = np.prod(np.minimum(length, reach) / (block.thickness * cell))
    stretch = max(1.0, float(fewest / MOST_CELLS) ** (1.0 / 3.0))
    while True:
        sizes = stretch * block.thickness * np.array([cell, edge_cell])
        lines = [graded_line(*span, *sizes) for span in zip(length, reach, strict=True)]
        if math.prod(len(line) - 1 for line in lines) <= MOST_CELLS:
            return lines, stretch
        stretch *= STRETCH


def graded_line(length: float, reach: float, cell: float, edge_cell: float) -> FloatArray:
    """Return the ascending ends of cells from 0 to `length`, of at most the size `cell` up to `reach`.

    From `length` inwards the sizes grow by EDGE_RATIO, beginning with at most `edge_cell`.
    """
    distance, size = [0.0], min(edge_cell, cell)
    while distance[-1] < length:
        distance.append(distance[-1] + size)
        beyond = max(length - distance[-1] - reach, 0.0)
        size = min(EDGE_RATIO * size, cell + OUTER_GROWTH * beyond)
    return length * (1.0 - np.array(distance[::-1]) / distance[-1])


def _remainder(block: Block, quarter: Quarter, position: FloatArray) -> FloatArray:
    """Return value, gradient and Laplacian of w between sites, (4, n, n).

    For each of the four parities, the load and its three mirror images with the signs of the parity are
    applied together. A single load is a quarter of the sum over the parities.
    """
    # one load for sites that are mirror images up to rounding
    folded = np.abs(position)
    _, first, orbit = np.unique(
        np.round(folded / block.thickness, 12), axis=0, return_index=True, return_inverse=True
    )
    site, side = folded[first], np.where(position < 0.0, -1.0, 1.0)
    step = STEP * np.minimum(0.5 * np.array([block.width, block.length]) - site, block.thickness).min(axis=1)
    around = step[:, None] * np.array([[[0, 0]], [[1, 0]], [[-1, 0]], [[0, 1]], [[0, -1]]])
    places = np.array_split((site + around).reshape(-1, 2), -(-5 * len(site) // MOST_PLACES))
    h, total = step[:, None], np.zeros((4, len(position), len(position)))
    for parity in each("load case", PARITIES):
        field = quarter.solve(parity, site)
        values = np.concatenate([quarter.influence(field, part) for part in places])
        w, east, west, north, south = values.reshape(5, len(site), -1)
        slopes = (east - west) / (2.0 * h), (north - south) / (2.0 * h)
        result = np.stack([w, *slopes, (east + west + north + south - 4.0 * w) / h**2])
        sign = np.prod(np.where(np.array(parity) < 0, side, 1.0), axis=1)
        total += 0.25 * result[:, orbit[:, None], orbit] * sign[:, None] * sign
    total[1:3] *= side.T[:, :, None]
    return total
