"""Load equation of independent Hertzian asperities, all in rescaled load P/E* [mm^2].

Gaps are sorted: gap[0] = 0 belongs to the tallest asperity, so the sums stop at the first open one.
With the approach x, d_i = x - gap_i and P/E* = sum 4/3 sqrt(R_i) d_i^(3/2) is convex and increasing.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.contact import hertz
from metafem._kernels.vectors import add

# From the right, Newton's method first reduces the distance by two thirds per step and then converges
# quadratically; 200 steps are enough for any double.
MAX_STEPS = 200

# The first refinement reduces the error of the load to rounding.
MAX_REFINEMENTS = 3
ROUNDING = 4.0 * np.finfo(np.float64).eps

# Relative error of the load before the last step of `areas`; the step squares it.
SETTLED = 1e-8


@compiled
def load_and_slope(gap, root_radius, approach):
    """Return P/E* [mm^2] and its derivative by the approach [mm]."""
    load = 0.0
    slope = 0.0
    for i in range(gap.size):
        d = approach - gap[i]
        if d <= 0.0:
            break
        s = root_radius[i] * math.sqrt(d)  # contact radius a_i
        load += s * d
        slope += s
    return hertz.LOAD * load, hertz.STIFFNESS * slope


@compiled
def sums(gap, root_radius, base, depth):
    """Return P/E* [mm^2], A0 [mm^2] and slope [mm] at the approach base + depth, with compensated sums."""
    load = area = slope = 0.0
    load_rest = area_rest = slope_rest = 0.0
    for i in range(gap.size):
        d = depth + (base - gap[i])
        if d <= 0.0:
            break
        s = root_radius[i] * math.sqrt(d)
        load, load_rest = add(load, load_rest, s * d)
        area, area_rest = add(area, area_rest, s * s)
        slope, slope_rest = add(slope, slope_rest, s)
    load, area, slope = load + load_rest, area + area_rest, slope + slope_rest
    return hertz.LOAD * load, math.pi * area, hertz.STIFFNESS * slope


@compiled
def approach_at_load(gap, root_radius, load, below):
    """Return the approach [mm] at a load; `below` is a lower bound of it, such as 0."""
    if load <= 0.0:
        return 0.0
    # upper bracket: contact of the tallest asperity only
    above = hertz.indentation_at_load(root_radius[0] ** 2, load)
    x = above
    if below > 0.0:
        p, s = load_and_slope(gap, root_radius, below)
        # the tangent of a convex function lies below it: this step ends on the right of the root
        x = min(above, below + (load - p) / s)
    for _ in range(MAX_STEPS):
        p, s = load_and_slope(gap, root_radius, x)
        if p <= load:
            break
        new = x - (p - load) / s
        if new < below:
            new = 0.5 * (below + x)
        if new >= x:
            break
        x = new
    return x


@compiled
def refine(gap, root_radius, load, approach):
    """Split an approach into the gap of the last contact and its indentation, and solve for the latter.

    If all indentations are far smaller than the gaps, they cannot be computed accurately from the approach.
    """
    if approach <= 0.0:
        return 0.0, approach
    last = 0
    while last + 1 < gap.size and gap[last + 1] < approach:
        last += 1
    base = gap[last]
    depth = approach - base
    for _ in range(MAX_REFINEMENTS):
        p, _, slope = sums(gap, root_radius, base, depth)
        new = depth - (p - load) / slope
        if not (new > 0.0 and abs(p - load) > load * ROUNDING):
            break
        depth = new
    return base, depth


@compiled
def curves(gap, root_radius, load, approach, carried, area, slope):
    """Fill (m, k) results for m surfaces of n asperities and k increasing loads.

    gap, root_radius: (m, n), rows sorted by gap. carried: the load recomputed at the approach.
    """
    for i in range(gap.shape[0]):
        x = 0.0
        for j in range(load.size):
            x = approach_at_load(gap[i], root_radius[i], load[j], x)
            base, depth = refine(gap[i], root_radius[i], load[j], x)
            approach[i, j] = base + depth
            carried[i, j], area[i, j], slope[i, j] = sums(gap[i], root_radius[i], base, depth)


@compiled
def curve_at_approach(gap, root_radius, approach, load, area, slope):
    """Fill load, area and slope (k,) of one surface at given approaches (k,)."""
    for j in range(approach.size):
        load[j], area[j], slope[j] = sums(gap, root_radius, 0.0, approach[j])


@partial(compiled, any_order=True)
def quick_sums(gap, root_radius, count, base, depth):
    """Return P/E* [mm^2], its slope [mm], A0 [mm^2] and its slope [mm]; the first `count` may touch."""
    load = slope = area = rate = 0.0
    for i in range(count):
        d = max(depth + (base - gap[i]), 0.0)
        s = root_radius[i] * math.sqrt(d)
        load += s * d
        slope += s
        area += s * s
        rate += root_radius[i] * root_radius[i] if d > 0.0 else 0.0
    return hertz.LOAD * load, hertz.STIFFNESS * slope, math.pi * area, math.pi * rate


@compiled
def areas(gap, root_radius, load, area):
    """Fill only the areas (m, k) of `curves`, in a fifth of its time; nan without a solution."""
    for i in range(gap.shape[0]):
        x = slope = 0.0
        for j in range(load.size):
            area[i, j] = math.nan if load[j] > 0.0 else 0.0
            if load[j] <= 0.0:
                continue
            # upper bounds, as in approach_at_load: contact of the tallest asperity only, or the tangent
            above = hertz.indentation_at_load(root_radius[i, 0] ** 2, load[j])
            start = above
            if slope > 0.0:
                above = min(above, x + (load[j] - load[j - 1]) / slope)
                # a power law through the last equilibrium, with its slope, is closer
                start = min(above, x * (load[j] / load[j - 1]) ** (load[j - 1] / (x * slope)))
            x = start
            count = np.searchsorted(gap[i], above)  # no others touch at a smaller approach
            for _ in range(MAX_STEPS):
                # the unknown is that of `refine`: the indentation of the shallowest contact
                last = np.searchsorted(gap[i, :count], x)
                base = gap[i, last - 1]
                carried, slope, total, rate = quick_sums(gap[i], root_radius[i], last, base, x - base)
                step = (load[j] - carried) / slope
                new = min(x + step, above)
                same = new > base and (last == count or new <= gap[i, last])
                # rounding decides whether a contact that just touches is open or closed
                settled = same or abs(step) <= ROUNDING * x
                if new == x or (settled and abs(carried - load[j]) <= SETTLED * load[j]):
                    area[i, j] = total + rate * step  # exact unless a contact is added
                    x += step
                    break
                x = new


def empty_results(rows: int, columns: int) -> tuple[np.ndarray, ...]:
    """Return the four result arrays of `curves`."""
    return tuple(np.empty((rows, columns)) for _ in range(4))
