"""Load equation of independent asperities, for any law; all loads are rescaled, P/E* [mm^2].

At the approach x, d_i = x - gap_i, and P/E* = sum P(d_i) increases with x. The gaps are sorted, and
gap[0] = 0 belongs to the tallest asperity. The unknown is the indentation `depth` of the shallowest contact
`last`, with x = gap[last] + depth: a difference of x and a gap would be inaccurate for indentations far
smaller than the gaps.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from metafem._kernels import law as contact
from metafem._kernels.compiled import compiled, inlined
from metafem._kernels.vectors import add, total_of

# Relative error of the load at which the iteration ends: the rounding of the logarithms in the tables.
ROUNDING = 32.0 * np.finfo(np.float64).eps

# Least stiffness [mm] by which is divided; open contacts have none.
TINY = np.finfo(np.float64).tiny


@partial(compiled, any_order=True)
def hertz_block(radius, gap, start, stop, base, depth):
    """Return P/E* [mm^2], dP/dx [mm] and A0 [mm^2] of some Hertz contacts at the approach base + depth."""
    load = slope = area = 0.0
    for i in range(start, stop):
        d = max(depth + (base - gap[i]), 0.0)
        square = radius[i] * d
        a = math.sqrt(square)
        load += a * d
        slope += a
        area += square
    return contact.LOAD * load, contact.STIFFNESS * slope, math.pi * area


@compiled
def tabulated_block(law, gap, start, stop, base, depth):
    """Return the results of `hertz_block` for tabulated laws."""
    load = slope = area = 0.0
    for i in range(start, stop):
        d = depth + (base - gap[i])
        if d > 0.0:
            p, rate, square, _ = contact.pressed(law.data, law.which[i], law.scale[i], d)
            load += p
            slope += rate
            area += square
    return load, slope, math.pi * area


@compiled
def sums(law, gap, last, depth):
    """Return P/E* [mm^2], dP/dx [mm] and A0 [mm^2] of the asperities up to `last`."""
    load = slope = area = load_rest = slope_rest = area_rest = 0.0
    # sums of 64 contacts by vector instructions, and compensated sums of these sums
    for start in range(0, last + 1, 64):
        stop = min(start + 64, last + 1)
        if law.data.size:
            p, rate, own = tabulated_block(law, gap, start, stop, gap[last], depth)
        else:
            p, rate, own = hertz_block(law.radius, gap, start, stop, gap[last], depth)
        load, load_rest = add(load, load_rest, p)
        slope, slope_rest = add(slope, slope_rest, rate)
        area, area_rest = add(area, area_rest, own)
    return load + load_rest, slope + slope_rest, area + area_rest


@compiled
def shallowest(gap, approach):
    """Return the index of the shallowest contact at an approach [mm], and its indentation [mm]."""
    last = max(np.searchsorted(gap, approach) - 1, 0)
    return last, approach - gap[last]


@compiled
def stepped(gap, last, depth, step, low, high):
    """Return the shallowest contact and its indentation after a step, which stays between low and high."""
    x = gap[last] + depth
    if abs(step) > ROUNDING * x and not low < x + step < high:
        step = 0.5 * (low + high) - x
    new = depth + step
    if new > 0.0 and (last + 1 == gap.size or new <= gap[last + 1] - gap[last]):
        return last, new
    return shallowest(gap, x + step)


@compiled
def curves(law, gap, load, approach, carried, area, slope):
    """Fill approach, load, area and slope (m, k) of m surfaces at k increasing loads; gap: (m, n).

    carried: loads recomputed at the approaches. Return the indices (m,) and the indentations (m,) of the
    shallowest contacts at the last load.
    """
    lasts, depths = np.zeros(gap.shape[0], dtype=np.int64), np.zeros(gap.shape[0])
    for row in range(gap.shape[0]):
        own, gaps = contact.part(law, row), gap[row]
        last, depth = 0, 0.0
        p = s = a = 0.0
        for j in range(load.size):
            if load[j] > 0.0:
                # beyond it the tallest alone carries more; the factor allows for the rounding of the tables
                low, high, before = 0.0, contact.alone(own, 0, load[j]) * (1.0 + 1e-9), math.inf
                if p == 0.0:
                    last, depth = shallowest(gaps, high)
                    p, s, a = sums(own, gaps, last, depth)
                for _ in range(200):  # each doubles the number of correct digits or halves the bracket
                    error, x = load[j] - p, gaps[last] + depth
                    # a small error that does not decrease is due to rounding
                    stalled = abs(error) >= before and before <= 1e-9 * load[j]
                    if stalled or abs(error) <= ROUNDING * load[j]:
                        break
                    before = abs(error)
                    low, high = (x, high) if error > 0.0 else (low, x)
                    step = error / s
                    if before > 0.01 * load[j]:  # Newton's step for logarithms, exact for a power law
                        step = x * ((load[j] / p) ** (p / (x * s)) - 1.0)
                    last, depth = stepped(gaps, last, depth, step, low, high)
                    p, s, a = sums(own, gaps, last, depth)
            approach[row, j] = gaps[last] + depth
            carried[row, j], area[row, j], slope[row, j] = p, a, s
        lasts[row], depths[row] = last, depth
    return lasts, depths


@compiled
def curve_at_approach(law, gap, approach, load, area, slope):
    """Fill load, area and slope (k,) of one surface at approaches (k,)."""
    for j in range(approach.size):
        if approach[j] > 0.0:
            last, depth = shallowest(gap, approach[j])
            load[j], slope[j], area[j] = sums(law, gap, last, depth)


@inlined
def press(law, z, load, stiffness, area, area_slope):
    """Fill P/E* [mm^2], dP/dd [mm], area [mm^2] and dA/dd [mm] of contacts at indentations z (n,)."""
    for i in range(z.size):  # vector instructions need loops that fill few arrays
        stiffness[i] = contact.STIFFNESS * math.sqrt(law.radius[i] * max(z[i], 0.0))
    for i in range(z.size):
        load[i] = contact.LOAD / contact.STIFFNESS * stiffness[i] * max(z[i], 0.0)
    for i in range(z.size):
        area_slope[i] = math.pi * law.radius[i] if z[i] > 0.0 else 0.0
    for i in range(z.size):
        area[i] = area_slope[i] * z[i]
    for i in range(z.size if law.data.size else 0):
        if z[i] > 0.0:
            p, rate, square, by_load = contact.pressed(law.data, law.which[i], law.scale[i], z[i])
            load[i], stiffness[i] = p, rate
            area[i], area_slope[i] = math.pi * square, math.pi * by_load * rate


@partial(compiled, any_order=True)
def rates(law, indentation, load, stiffness, area, area_slope):
    """Fill the results of `press` for indentations (k, n)."""
    for j in range(indentation.shape[0]):
        press(law, indentation[j], load[j], stiffness[j], area[j], area_slope[j])


@partial(compiled, any_order=True)
def sink(law, indentation, stiffness, area_slope, displacement, carried, load, results):
    """Let the base sink, at fixed loads `carried` (k,), under displacements (k, n) of the contacts.

    indentation, stiffness, area_slope: those without the displacements. Fill the loads of the contacts
    (k, n), and `results` (3, k): the sinking, the part of its derivative by the load that is due to the
    curvature of P(d), and the area. For every elastic law dP/dd = 2 a, with the derivative 2/pi
    (dA/dd)/(dP/dd).
    """
    d, rate, area, wider = np.empty((4, indentation.shape[1]))
    for j in range(carried.size):
        sinking = bend = 0.0
        whole = total_of(stiffness[j])
        for i in range(d.size):
            sinking += stiffness[j, i] * displacement[j, i] / whole
        for i in range(d.size):
            apart = displacement[j, i] - sinking
            d[i] = indentation[j, i] - apart
            bend += area_slope[j, i] * apart / max(stiffness[j, i], TINY)
        press(law, d, load[j], rate, area, wider)
        missing = (carried[j] - total_of(load[j])) / total_of(rate)
        for i in range(d.size):
            load[j, i] += rate[i] * missing
        results[0, j], results[1, j] = sinking, 2.0 / math.pi * bend / (whole * whole)
        results[2, j] = total_of(area) + total_of(wider) * missing
