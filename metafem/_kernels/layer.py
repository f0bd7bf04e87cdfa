"""Piecewise polynomials for the regular part of a bonded layer's influence.

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
def regular(s, table):
    """Return g, g' and g'' at a distance s [-]."""
    piece = int(s / WIDTH)
    if piece >= table.shape[1]:
        inverse = 1.0 / s
        return -inverse, inverse * inverse, -2.0 * inverse * inverse * inverse
    y = 2.0 * (s / WIDTH - piece) - 1.0
    value = first = second = 0.0
    for k in range(DEGREE, -1, -1):
        value = value * y + table[0, piece, k]
        first = first * y + table[1, piece, k]
        second = second * y + table[2, piece, k]
    return value, first, second


@compiled
def value(s, table):
    """Return g at a distance s [-]."""
    piece = int(s / WIDTH)
    if piece >= table.shape[1]:
        return -1.0 / s
    y = 2.0 * (s / WIDTH - piece) - 1.0
    g = 0.0
    for k in range(DEGREE, -1, -1):
        g = g * y + table[0, piece, k]
    return g


@compiled
def fill_regular(distance, thickness, table, value, first, second):
    """Fill the regular parts of G [1/mm], G' [1/mm^2] and G'' [1/mm^3] at distances r [mm], all (n,)."""
    unit = 1.0 / (math.pi * thickness)
    for i in range(distance.size):
        g, slope, bend = regular(distance[i] / thickness, table)
        value[i] = unit * g
        first[i] = unit / thickness * slope
        second[i] = unit / thickness / thickness * bend


def tabulated(function: Callable[..., Any], end: float) -> np.ndarray:
    """Return the table up to `end` of a function of s (m,) that returns g, g' and g''."""
    node = np.cos(math.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    powers = np.linalg.inv(np.vander(node, increasing=True))
    start = np.arange(0.0, end, WIDTH)
    table = np.empty((3, start.size, DEGREE + 1))
    for piece, s in enumerate(start[:, None] + 0.5 * WIDTH * (node + 1.0)):
        table[:, piece] = np.array(function(s)) @ powers.T
    return table


def empty_results(count: int) -> tuple[np.ndarray, ...]:
    """Return the three empty result arrays of `fill_regular`, (count,) each."""
    return tuple(np.empty(count) for _ in range(3))
