"""Approaches of adhesive contacts that do not interact, by tables of single contacts.

A table (4, m) holds increasing indentations [mm], and contact radii [mm], loads P/E* [mm^2] and dP/dd [mm] at
them. Contact i has the table ``which[i]`` and the indentation ``x - gap[i]`` at the approach x. Between two
jumps into contact the total load of the closed ones is an increasing and convex function of x, so that
Newton's method converges from above.
"""

from __future__ import annotations

import numpy as np

from metafem._kernels.compiled import compiled


@compiled
def contact(table, depth):
    """Return contact radius, load and dP/dd at an indentation, interpolated within the table."""
    j = min(max(np.searchsorted(table[0], depth), 1), table.shape[1] - 1)
    low, high = table[:, j - 1], table[:, j]
    share = min(max((depth - low[0]) / (high[0] - low[0]), 0.0), 1.0)
    radius, load, rate = low[1:] + share * (high[1:] - low[1:])
    return radius, load, rate


@compiled
def total(tables, which, gap, closed, x):
    """Return P/E* [mm^2] and dP/dx [mm] at an approach x."""
    load = rate = 0.0
    for i in range(len(gap)):
        if closed[i]:
            _, own, slope = contact(tables[which[i]], x - gap[i])
            load += own
            rate += slope
    return load, rate


@compiled
def loads(tables, which, gap, closed, x):
    """Return P/E* (k,) [mm^2] at approaches (k,)."""
    load = np.empty(len(x))
    for k in range(len(x)):
        load[k], _ = total(tables, which, gap, closed[k], x[k])
    return load


@compiled
def approached(tables, which, gap, closed, load, x, goal, most):
    """Change upper bounds x (k,) [mm] to the approaches at loads (k,); return the contact radii (k, n) [mm].

    The last of at most `most` steps is below `goal` over the approach.
    """
    radius = np.empty((len(x), len(gap)))
    for k in range(len(x)):
        for _ in range(most):
            carried, rate = total(tables, which, gap, closed[k], x[k])
            step = (load[k] - carried) / rate
            x[k] += step
            if abs(step) <= goal * x[k]:
                break
        for i in range(len(gap)):
            radius[k, i], _, _ = contact(tables[which[i]], x[k] - gap[i])
    return radius
