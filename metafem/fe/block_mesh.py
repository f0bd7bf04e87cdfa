"""Lines of nodes whose tensor product meshes a quarter of the block."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.surface import Block

# Each cell is at most e times its neighbour nearer to the bonded edge; beyond the loads' reach cells
# grow by 0.4 of the distance. Steeper ones cost accuracy, gentler ones add cells only.
EDGE_GROWTH = 1.0
OUTER_GROWTH = 0.4

# Most cells in a quarter, 55,000 unknowns: their factor takes half of 4 GiB and a minute a problem. Where
# the wanted cells are more, as in a wide and thin block, they grow by a tenth until they are not.
MOST_CELLS = 2000
STRETCH = 1.1

# Points per cell at which the wanted cell size is integrated.
SAMPLES = 64


@dataclass(frozen=True)
class Lines:
    """Vertices along x and y, from the symmetry planes to the sides, and z, from the top to the base [mm]."""

    x: FloatArray
    y: FloatArray
    z: FloatArray
    cell: float  # largest near the loads, in units of the thickness


def quarter_lines(block: Block, position: FloatArray, cell: float, edge_cell: float) -> Lines:
    """Return the lines of a mesh for loads at `position`, (n, 2) [mm].

    `cell` and `edge_cell` are the largest cell near the loads, which may be exceeded to keep to
    `MOST_CELLS`, and the last one at the base and the sides, in units of the thickness.
    """
    thickness = block.thickness
    reach = np.abs(position).max(axis=0) + thickness
    if block.width == block.length:  # keep the symmetry about the diagonal
        reach[:] = reach.max()
    lengths = 0.5 * block.width, 0.5 * block.length, thickness
    while True:
        sizes = thickness * cell, thickness * edge_cell
        x, y, z = (graded_line(*each, *sizes) for each in zip(lengths, (*reach, thickness), strict=True))
        if (x.size - 1) * (y.size - 1) * (z.size - 1) <= MOST_CELLS:
            return Lines(x, y, z, cell)
        cell *= STRETCH


def graded_line(length: float, reach: float, cell: float, edge_cell: float) -> FloatArray:
    """Return vertices from 0 to `length`: cells of `cell` up to `reach`, down to `edge_cell` at the end."""
    start = min(edge_cell, cell) * EDGE_GROWTH / math.expm1(EDGE_GROWTH)
    count = SAMPLES * math.ceil(length / cell)
    # the samples themselves must resolve the small cells
    distance = start * np.expm1(np.linspace(math.log1p(length / start), 0.0, count))
    s = length - distance
    size = np.minimum(cell + OUTER_GROWTH * np.maximum(s - reach, 0.0), start + EDGE_GROWTH * distance)
    cells = np.concatenate([[0.0], np.cumsum(np.diff(s) * 0.5 * (1.0 / size[1:] + 1.0 / size[:-1]))])
    whole = np.arange(math.ceil(cells[-1]) + 1) * (cells[-1] / math.ceil(cells[-1]))
    line = np.interp(whole, cells, s)
    line[[0, -1]] = 0.0, length
    return np.asarray(line)
