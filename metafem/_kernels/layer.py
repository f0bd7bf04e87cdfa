"""Piecewise polynomials for the regular part of a radial influence, and sources on a regular grid.

g(s) = pi t (G - 1/(pi r)) with s = r/t. The table (3, pieces, DEGREE + 1) contains, for g, g' and g'', the
coefficients of the powers of y = 2 (s/WIDTH - piece) - 1. Beyond the table the displacement is zero, so
g(s) = -1/s.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from metafem._kernels.compiled import compiled

# Width of a piece and degree of its polynomials. g is analytic in |Im s| < 2, so on pieces of half-width 1/16
# the error decreases by a factor of 64 per degree, to 64^-10 = 1e-18.
WIDTH = 0.125
DEGREE = 9


@compiled
def fill_regular(distance, thickness, table, out):
    """Fill the regular parts of G [1/mm], G' [1/mm^2] and G'' [1/mm^3] at distances r [mm], (3, n)."""
    unit = 1.0 / (math.pi * thickness)
    for i in range(distance.size):
        s = distance[i] / thickness
        piece = int(s / WIDTH)
        if piece >= table.shape[1]:
            value = -1.0 / s
            first = value * value
            second = 2.0 * value * first
        else:
            y = 2.0 * (s / WIDTH - piece) - 1.0
            value = first = second = 0.0
            for k in range(DEGREE, -1, -1):
                value = value * y + table[0, piece, k]
                first = first * y + table[1, piece, k]
                second = second * y + table[2, piece, k]
        out[0, i] = unit * value
        out[1, i] = unit / thickness * first
        out[2, i] = unit / thickness / thickness * second


def regular(distance: np.ndarray, thickness: float, table: np.ndarray) -> np.ndarray:
    """Return the regular parts of G, G' and G'' at distances r of any shape, (3, ...)."""
    found = np.empty((3, np.size(distance)))
    fill_regular(np.ravel(distance), thickness, table, found)
    return found.reshape(3, *np.shape(distance))


def tabulated(function: Callable[..., Any], end: float) -> np.ndarray:
    """Return the read-only table up to `end` of a function of s (m,) that returns g, g' and g''."""
    node = np.cos(math.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    powers = np.linalg.inv(np.vander(node, increasing=True))
    start = np.arange(0.0, end, WIDTH)
    table = np.empty((3, start.size, DEGREE + 1))
    for piece, s in enumerate(start[:, None] + 0.5 * WIDTH * (node + 1.0)):
        table[:, piece] = np.array(function(s)) @ powers.T
    table.flags.writeable = False
    return table


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
