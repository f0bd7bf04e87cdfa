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
def place(table, depth):
    """Return the index of the entries around an indentation, and its share of the way from the first."""
    j = min(max(np.searchsorted(table[0], depth), 1), table.shape[1] - 1)
    low, high = table[0, j - 1], table[0, j]
    return j, min(max((depth - low) / (high - low), 0.0), 1.0)


@compiled
def between(values, j, share):
    """Return an entry of a row of a table, interpolated."""
    return values[j - 1] + share * (values[j] - values[j - 1])


@compiled
def total(tables, which, gap, closed, x):
    """Return P/E* [mm^2] and dP/dx [mm] at an approach x."""
    load = rate = 0.0
    for i in range(len(gap)):
        if closed[i]:
            table = tables[which[i]]
            j, share = place(table, x - gap[i])
            load += between(table[2], j, share)
            rate += between(table[3], j, share)
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
            table = tables[which[i]]
            j, share = place(table, x[k] - gap[i])
            radius[k, i] = between(table[1], j, share)
    return radius
