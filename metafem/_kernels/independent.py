"""Load equation of independent Hertzian asperities; all loads are rescaled, P/E* [mm^2].

The gaps are sorted, and gap[0] = 0 belongs to the tallest asperity, so the sums stop at the first open
asperity. At the approach x, d_i = x - gap_i, and P/E* = sum 4/3 sqrt(R_i) d_i^(3/2) is a convex, increasing
function of x.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.contact import hertz
from metafem._kernels.vectors import add

# Maximum number of Newton steps. Far above the root, each step reduces the distance to the root by two
# thirds; near the root, Newton's method converges quadratically. 200 steps suffice for any double-precision
# numbers.
MAX_STEPS = 200

# Maximum number of refinements; usually the first one reduces the error of the load to rounding.
MAX_REFINEMENTS = 3
ROUNDING = 4.0 * np.finfo(np.float64).eps

# Largest relative error of the load before the last step of `areas`, which squares this error.
SETTLED = 1e-8


@compiled
def load_and_slope(gap, root_radius, approach):
    """Return P/E* [mm^2] and its derivative dP/dx [mm] with respect to the approach."""
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
    """Return P/E* [mm^2], A0 [mm^2] and dP/dx [mm] at the approach base + depth, by compensated sums."""
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
    """Return the approach [mm] at a load; `below` is a lower bound of the approach, such as 0."""
    if load <= 0.0:
        return 0.0
    # upper bound: the tallest asperity carries the load by itself
    above = hertz.indentation_at_load(root_radius[0] ** 2, load)
    x = above
    if below > 0.0:
        p, s = load_and_slope(gap, root_radius, below)
        # the tangent of a convex function lies below the function, so this step ends above the root
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
    """Return the gap of the shallowest contact and its indentation, solved for accurately.

    Their sum is the approach. If all indentations are far smaller than the gaps, the difference of approach
    and gap would be inaccurate.
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
    """Fill approach, load, area and slope (m, k) of m surfaces at k increasing loads.

    gap, root_radius: (m, n), with each row sorted by gap. carried: loads recomputed at the approaches.
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
    """Fill load, area and slope (k,) of one surface at approaches (k,)."""
    for j in range(approach.size):
        load[j], area[j], slope[j] = sums(gap, root_radius, 0.0, approach[j])


@partial(compiled, any_order=True)
def quick_sums(gap, root_radius, count, base, depth):
    """Return P/E* [mm^2], dP/dx [mm], A0 [mm^2] and dA0/dx [mm] of the first `count` asperities."""
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
    """Fill only the areas (m, k), in a fifth of the time of `curves`; nan if there is no solution."""
    for i in range(gap.shape[0]):
        x = slope = 0.0
        for j in range(load.size):
            area[i, j] = math.nan if load[j] > 0.0 else 0.0
            if load[j] <= 0.0:
                continue
            # upper bounds as in approach_at_load: the tallest asperity by itself, and the tangent
            above = hertz.indentation_at_load(root_radius[i, 0] ** 2, load[j])
            start = above
            if slope > 0.0:
                above = min(above, x + (load[j] - load[j - 1]) / slope)
                # a power law with the load and slope of the last equilibrium is closer
                start = min(above, x * (load[j] / load[j - 1]) ** (load[j - 1] / (x * slope)))
            x = start
            count = np.searchsorted(gap[i], above)  # other asperities are open below this approach
            for _ in range(MAX_STEPS):
                # as in `refine`, solve for the indentation of the shallowest contact
                last = np.searchsorted(gap[i, :count], x)
                base = gap[i, last - 1]
                carried, slope, total, rate = quick_sums(gap[i], root_radius[i], last, base, x - base)
                step = (load[j] - carried) / slope
                new = min(x + step, above)
                same = new > base and (last == count or new <= gap[i, last])
                # whether a contact that just touches is open or closed depends on rounding
                settled = same or abs(step) <= ROUNDING * x
                if new == x or (settled and abs(carried - load[j]) <= SETTLED * load[j]):
                    area[i, j] = total + rate * step  # exact unless a contact forms
                    x += step
                    break
                x = new


def empty_results(rows: int, columns: int) -> tuple[np.ndarray, ...]:
    """Return the four empty result arrays of `curves`, (rows, columns) each."""
    return tuple(np.empty((rows, columns)) for _ in range(4))
