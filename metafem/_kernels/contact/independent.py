"""Load equation of independent asperities with tabulated laws; all loads are rescaled, P/E* [mm^2].

At the approach x, d_i = x - gap_i, and P/E* = sum p(d_i) increases with x. `contact.tabulated` evaluates the
laws; `_kernels.independent` solves the equation for Hertz contacts.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.contact import tabulated
from metafem._kernels.vectors import add

# Maximum number of steps. Each step either doubles the number of correct digits, by Newton's method, or
# halves the bracket.
MAX_STEPS = 200
ROUNDING = 4.0 * np.finfo(np.float64).eps


@compiled
def load_and_slope(law, gap, approach):
    """Return P/E* [mm^2] and its derivative with respect to the approach x [mm]."""
    _, which, scale, data = law
    load = rest = slope = 0.0
    for i in range(gap.size):
        z = approach - gap[i]
        if z > 0.0:
            p, rate = tabulated.load_and_rate(data, which[i], scale[i], z)
            load, rest = add(load, rest, p)
            slope += rate
    return load + rest, slope


@compiled
def approach_at_load(law, gap, load, below, carried, slope):
    """Return the approach [mm] at a load.

    below: a lower bound, 0 or the approach of a previous equilibrium with load `carried` and slope `slope`.
    """
    i = int(np.argmin(gap))
    high = gap[i] + tabulated.indentation_at_load(law.data, law.which[i], law.scale[i], load)
    high *= 1.0 + 1e-9  # allows for the rounding of the tables
    low = below
    x = high
    if below > 0.0 and slope > 0.0:
        # a power law with the load and slope of the last equilibrium
        x = min(high, below * (load / carried) ** (carried / (below * slope)))
    for _ in range(MAX_STEPS):
        p, s = load_and_slope(law, gap, x)
        if p >= load:
            high = min(high, x)
        else:
            low = max(low, x)
        new = x - (p - load) / s if s > 0.0 else 0.5 * (low + high)
        if abs(new - x) <= ROUNDING * x:
            return new
        x = new if low < new < high else 0.5 * (low + high)
        if not high - low > ROUNDING * high:
            break
    return x


@compiled
def at_approach(law, gap, approach):
    """Return P/E* [mm^2], A0 [mm^2] and the derivative of P/E* [mm] at the approach x."""
    _, which, scale, data = law
    load = load_rest = square = square_rest = slope = 0.0
    for i in range(gap.size):
        z = approach - gap[i]
        if z > 0.0:
            p, rate, own, _ = tabulated.pressed(data, which[i], scale[i], z)
            load, load_rest = add(load, load_rest, p)
            square, square_rest = add(square, square_rest, own)
            slope += rate
    return load + load_rest, math.pi * (square + square_rest), slope


@compiled
def curves(law, gap, load, approach, carried, area, slope):
    """Fill approach, load, area and slope (m, k) of m surfaces at k increasing loads; gap: (m, n)."""
    for row in range(gap.shape[0]):
        of_row = tabulated.part(law, row)
        x = p = s = 0.0
        for j in range(load.size):
            if load[j] > 0.0:
                x = approach_at_load(of_row, gap[row], load[j], x, p, s)
            p, area[row, j], s = at_approach(of_row, gap[row], x)
            approach[row, j], carried[row, j], slope[row, j] = x, p, s


@compiled
def each(law, indentation, load, stiffness, area, area_slope):
    """Fill P/E* [mm^2], dP/dd [mm], area [mm^2] and dA/dd [mm] of contacts at indentations (k, n)."""
    _, which, scale, data = law
    for j in range(indentation.shape[0]):
        for i in range(indentation.shape[1]):
            load[j, i] = stiffness[j, i] = area[j, i] = area_slope[j, i] = 0.0
            if indentation[j, i] > 0.0:
                p, rate, square, widening = tabulated.pressed(data, which[i], scale[i], indentation[j, i])
                load[j, i], stiffness[j, i], area[j, i] = p, rate, math.pi * square
                area_slope[j, i] = math.pi * widening * rate
