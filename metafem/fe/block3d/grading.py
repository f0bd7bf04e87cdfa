"""Lines of vertices whose tensor product is the mesh of a quarter of the block."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.surface import Block

# Growth of the cell size per distance from the bonded edge, and from the loaded region. With 1, each cell is
# at most e times as large as its neighbour nearer to the edge. Steeper grading reduces the accuracy; gentler
# grading only adds cells.
EDGE_GROWTH = 1.0
OUTER_GROWTH = 0.4

# Largest number of cells in a quarter; the factorisation of the 55,000 unknowns takes 2 GiB and a minute. If
# more cells are needed, as in a wide and thin block, all cells are enlarged in steps of a tenth.
MOST_CELLS = 2000
STRETCH = 1.1


def quarter_lines(
    block: Block, position: FloatArray, cell: float, edge_cell: float
) -> tuple[list[FloatArray], float]:
    """Return the vertices of a mesh for loads at `position`, (n, 2) [mm], and the factor on its cell sizes.

    The vertices run along x and y from the symmetry planes to the sides, and along z from the top to the
    base. `cell` is the size of the largest cells near the loads and `edge_cell` that of the last cells at the
    base and the sides, in units of the thickness. Both are enlarged if the mesh would exceed `MOST_CELLS`.
    """
    thickness, stretch = block.thickness, 1.0
    reach = np.abs(position).max(axis=0) + thickness
    if block.width == block.length:  # keep the mesh symmetric about the diagonal
        reach[:] = reach.max()
    spans = (0.5 * block.width, reach[0]), (0.5 * block.length, reach[1]), (thickness, thickness)
    while True:
        sizes = stretch * thickness * cell, stretch * thickness * edge_cell
        # count before making the cells: a thin block has millions of cells until they are enlarged
        if math.prod(math.ceil(_counts(length, far, *sizes)[-1]) for length, far in spans) <= MOST_CELLS:
            return [graded_line(length, far, *sizes) for length, far in spans], stretch
        stretch *= STRETCH


def graded_line(length: float, reach: float, cell: float, edge_cell: float) -> FloatArray:
    """Return the ascending ends of cells from 0 to `length`; the cells have the size `cell` up to `reach`.

    The size at s is ``min(cell + OUTER_GROWTH (s - reach)+, start + EDGE_GROWTH (length - s))``, where
    `start` makes the last cell equal `edge_cell`. The number of cells up to s is the integral of 1/size, in
    closed form.
    """
    start, uniform, outer, total = _counts(length, reach, cell, edge_cell)
    number = np.linspace(0.0, total, math.ceil(total) + 1)
    beyond = np.clip(number, uniform, outer) - uniform
    left = cell * (np.minimum(number, uniform) + np.expm1(OUTER_GROWTH * beyond) / OUTER_GROWTH)
    right = start * np.expm1(EDGE_GROWTH * (total - np.maximum(number, outer))) / EDGE_GROWTH
    line = np.where(number < outer, left, length - right)
    line[0] = 0.0
    return np.asarray(line)


def _counts(length: float, reach: float, cell: float, edge_cell: float) -> tuple[float, float, float, float]:
    """Return `start` and the numbers of cells up to `reach`, to the point of equal sizes, and in total."""
    start = min(edge_cell, cell) * EDGE_GROWTH / math.expm1(EDGE_GROWTH)
    top = start + EDGE_GROWTH * length - cell
    meeting = top / EDGE_GROWTH
    if meeting > reach:
        meeting = (top + OUTER_GROWTH * reach) / (OUTER_GROWTH + EDGE_GROWTH)
    meeting = min(max(meeting, 0.0), length)
    uniform = min(reach, meeting) / cell
    outer = uniform + math.log1p(OUTER_GROWTH * max(meeting - reach, 0.0) / cell) / OUTER_GROWTH
    return start, uniform, outer, outer + math.log1p(EDGE_GROWTH * (length - meeting) / start) / EDGE_GROWTH
