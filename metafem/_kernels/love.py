"""Love's solution for a uniformly loaded square; all lengths are in cells.

Unit pressure p/E* on the unit square about the origin causes at (x, y) the displacement
``1/pi`` times the integral of ``1/r`` over the square. Love, Phil. Trans. R. Soc. A 228, 377 (1929),
doi:10.1098/rsta.1929.0009; Johnson, Contact Mechanics (1985), eq. 3.25, doi:10.1017/CBO9781139171731.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels.compiled import compiled

# Largest distance at which the closed form is used [cells]. The closed form is a second difference of terms
# of size r, whose rounding error is about r^2 units in the last place. Beyond this distance five Gauss points
# per side have an error of about (4 r)^-10 < 1e-15, without cancellation.
CLOSED_FORM_DISTANCE = 8.0

# Gauss-Legendre rule on [-1/2, 1/2].
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
NODES = 0.5 * _NODES
WEIGHTS = 0.5 * _WEIGHTS


@compiled
def asinh_difference(b, a, s):
    """Return asinh(b/s) - asinh(a/s) for b >= a and s >= 0, without cancellation."""
    if s == 0.0 and a <= 0.0 <= b:
        return 0.0  # the result is always multiplied by s
    ra = math.hypot(a, s)
    rb = math.hypot(b, s)
    if a >= 0.0:
        # (b + rb)/(a + ra) = 1 + (b - a)(1 + (a + b)/(ra + rb))/(a + ra)
        return math.log1p((b - a) * (1.0 + (a + b) / (ra + rb)) / (a + ra))
    if b <= 0.0:
        return math.log1p((b - a) * (1.0 - (a + b) / (ra + rb)) / (rb - b))
    return math.log((b + rb) / s) + math.log((ra - a) / s)


@compiled
def displacement(x, y):
    """Return the displacement [cells] at (x, y) by unit pressure p/E* on the unit square about the origin."""
    x = abs(x)
    y = abs(y)
    if max(x, y) > CLOSED_FORM_DISTANCE:
        total = 0.0
        for i in range(NODES.size):
            for j in range(NODES.size):
                total += WEIGHTS[i] * WEIGHTS[j] / math.hypot(x - NODES[i], y - NODES[j])
        return total / math.pi
    x1, x2, y1, y2 = x - 0.5, x + 0.5, y - 0.5, y + 0.5
    return (
        x2 * asinh_difference(y2, y1, x2)
        - x1 * asinh_difference(y2, y1, abs(x1))
        + y2 * asinh_difference(x2, x1, y2)
        - y1 * asinh_difference(x2, x1, abs(y1))
    ) / math.pi


@compiled
def table(rows, columns):
    """Return the displacements [cells] at offsets of (i, j) cells, (rows, columns)."""
    result = np.empty((rows, columns))
    for i in range(rows):
        for j in range(columns):
            if i > j and i < columns and j < rows:
                result[i, j] = result[j, i]
            else:
                result[i, j] = displacement(float(i), float(j))
    return result
