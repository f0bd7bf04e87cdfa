"""Spreading of point sources to a regular grid, and interpolation from the grid, by a smooth window.

The window is a table of polynomials, one for each grid point that it covers.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels.compiled import compiled


@compiled
def weights(position, table, out):
    """Fill the window values (points,) around a position [grid steps]; return the first grid point.

    table: coefficients of the powers of y for each point, (degree + 1, points); y from -1 to 1 is the
    position between two grid points.
    """
    degree, points = table.shape[0] - 1, table.shape[1]
    first = math.ceil(position - 0.5 * points)
    y = 2.0 * (first - position + 0.5 * points) - 1.0
    for k in range(points):
        out[k] = table[degree, k]
    for power in range(degree - 1, -1, -1):
        for k in range(points):
            out[k] = out[k] * y + table[power, k]
    return first


@compiled
def spread(position, table, source, grid):
    """Add sources (n,) at positions (n, 2), row and column [grid steps], to the grid."""
    points = table.shape[1]
    wy, wx = np.empty(points), np.empty(points)
    for i in range(source.size):
        if source[i] == 0.0:
            continue
        row, column = weights(position[i, 0], table, wy), weights(position[i, 1], table, wx)
        for k in range(points):
            amount = source[i] * wy[k]
            line = grid[row + k]
            for j in range(points):
                line[column + j] += amount * wx[j]


@compiled
def gather(position, table, grid, low, high, out):
    """Add the sums over the grid, weighted by the windows at positions (n, 2), to `out` from low to high."""
    points = table.shape[1]
    wy, wx = np.empty(points), np.empty(points)
    for i in range(low, high):
        row, column = weights(position[i, 0], table, wy), weights(position[i, 1], table, wx)
        total = 0.0
        for k in range(points):
            part = 0.0
            line = grid[row + k]
            for j in range(points):
                part += wx[j] * line[column + j]
            total += wy[k] * part
        out[i] += total


@compiled
def spread_hats(corner, fraction, stride, source, grid):
    """Add sources (n,) to the four corners of their cells on a flat grid, with bilinear weights.

    corner: index of the first corner, (n,); fraction: position in the cell, row and column, (n, 2); stride:
    number of grid points in a row.
    """
    for i in range(source.size):
        if source[i] == 0.0:
            continue
        k, y, x = corner[i], fraction[i, 0], fraction[i, 1]
        lower, upper = source[i] * (1.0 - y), source[i] * y
        grid[k] += lower * (1.0 - x)
        grid[k + 1] += lower * x
        grid[k + stride] += upper * (1.0 - x)
        grid[k + stride + 1] += upper * x


@compiled
def gather_hats(corner, fraction, stride, grid, out):
    """Fill `out` (n,) with the bilinear interpolation from a flat grid; arguments as in `spread_hats`."""
    for i in range(out.size):
        k, y, x = corner[i], fraction[i, 0], fraction[i, 1]
        lower = grid[k] * (1.0 - x) + grid[k + 1] * x
        upper = grid[k + stride] * (1.0 - x) + grid[k + stride + 1] * x
        out[i] = lower * (1.0 - y) + upper * y
