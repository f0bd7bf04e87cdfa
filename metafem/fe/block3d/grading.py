"""Lines of nodes whose tensor product meshes a quarter of the block."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.surface import Block

# Each cell is at most e times its neighbour nearer to the bonded edge; beyond the loaded region cells
# grow by 0.4 of the distance. Steeper grading costs accuracy; gentler grading only adds cells.
EDGE_GROWTH = 1.0
OUTER_GROWTH = 0.4

# Largest number of cells in a quarter: with 55,000 unknowns the factorisation takes 2 GiB and a minute. If
# more are needed, as in a wide and thin block, all cells are enlarged in steps of a tenth.
MOST_CELLS = 2000
STRETCH = 1.1


@dataclass(frozen=True)
class Lines:
    """Vertices along x and y, from the symmetry planes to the sides, and z, from the top to the base [mm]."""

    x: FloatArray
    y: FloatArray
    z: FloatArray
    stretch: float = 1.0  # enlargement of the cells


def quarter_lines(block: Block, position: FloatArray, cell: float, edge_cell: float) -> Lines:
    """Return the lines of a mesh for loads at `position`, (n, 2) [mm].

    `cell` and `edge_cell` are the largest cell near the loads and the last one at the base and the
    sides, in units of the thickness; both are enlarged if needed to respect `MOST_CELLS`.
    """
    thickness, stretch = block.thickness, 1.0
    reach = np.abs(position).max(axis=0) + thickness
    if block.width == block.length:  # keep the symmetry about the diagonal
        reach[:] = reach.max()
    lengths = 0.5 * block.width, 0.5 * block.length, thickness
    while True:
        sizes = stretch * thickness * cell, stretch * thickness * edge_cell
        x, y, z = (Grading(*each, *sizes) for each in zip(lengths, (*reach.tolist(), thickness), strict=True))
        if x.cells * y.cells * z.cells <= MOST_CELLS:
            return Lines(x.vertices(), y.vertices(), z.vertices(), stretch)
        stretch *= STRETCH


@dataclass(frozen=True)
class Grading:
    """Cells from 0 to `length`: `cell` up to `reach`, larger beyond it, and `edge_cell` at the end.

    The size is ``min(cell + OUTER_GROWTH (s - reach)+, start + EDGE_GROWTH (length - s))``. The number of
    cells is the integral of its reciprocal, in closed form.
    """

    length: float
    reach: float
    cell: float
    edge_cell: float

    @property
    def cells(self) -> int:
        """Number of cells."""
        return math.ceil(self._outer(self._meeting) + self._inner(self.length - self._meeting))

    def vertices(self) -> FloatArray:
        """Return the ends of the cells, ascending [mm]."""
        outer, inner = self._outer(self._meeting), self._inner(self.length - self._meeting)
        number = np.linspace(0.0, outer + inner, self.cells + 1)
        uniform = min(self.reach, self._meeting) / self.cell
        beyond = np.clip(number, uniform, outer) - uniform
        left = self.cell * (np.minimum(number, uniform) + np.expm1(OUTER_GROWTH * beyond) / OUTER_GROWTH)
        right = (
            self._start * np.expm1(EDGE_GROWTH * (inner + outer - np.maximum(number, outer))) / EDGE_GROWTH
        )
        line = np.where(number < outer, left, self.length - right)
        line[0] = 0.0
        return np.asarray(line)

    @property
    def _start(self) -> float:
        """Size at the end, for which the last cell is `edge_cell`."""
        return min(self.edge_cell, self.cell) * EDGE_GROWTH / math.expm1(EDGE_GROWTH)

    @property
    def _meeting(self) -> float:
        """Position at which the two sizes are equal."""
        top = self._start + EDGE_GROWTH * self.length - self.cell
        position = top / EDGE_GROWTH
        if position > self.reach:
            position = (top + OUTER_GROWTH * self.reach) / (OUTER_GROWTH + EDGE_GROWTH)
        return min(max(position, 0.0), self.length)

    def _outer(self, position: float) -> float:
        """Number of cells between 0 and a position before the meeting."""
        beyond = max(position - self.reach, 0.0)
        return (position - beyond) / self.cell + math.log1p(OUTER_GROWTH * beyond / self.cell) / OUTER_GROWTH

    def _inner(self, distance: float) -> float:
        """Number of cells within a distance from the end."""
        return math.log1p(EDGE_GROWTH * distance / self._start) / EDGE_GROWTH
