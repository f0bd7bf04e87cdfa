"""Spreading of point sources to a regular grid, and interpolation from the grid, by the same weights."""

from __future__ import annotations

from metafem._kernels.compiled import compiled


@compiled
def spread(first, weight, source, grid):
    """Add sources (n,) to the grid.

    first: row and column of the first grid point of each source, (n, 2); weight: along both, (n, 2, points).
    """
    points = weight.shape[2]
    for i in range(source.size):
        if source[i] == 0.0:
            continue
        for k in range(points):
            amount = source[i] * weight[i, 0, k]
            line = grid[first[i, 0] + k]
            for j in range(points):
                line[first[i, 1] + j] += amount * weight[i, 1, j]


@compiled
def gather(first, weight, grid, out):
    """Fill `out` (n,) with the weighted sums over the grid; arguments as in `spread`."""
    points = weight.shape[2]
    for i in range(out.size):
        total = 0.0
        for k in range(points):
            part = 0.0
            line = grid[first[i, 0] + k]
            for j in range(points):
                part += weight[i, 1, j] * line[first[i, 1] + j]
            total += weight[i, 0, k] * part
        out[i] = total
