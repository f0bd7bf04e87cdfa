"""Initial guesses for independent asperities whose law is near a target.

*In order of contact.* Between two consecutive samples of the law, a number of new asperities is added, which
need not be an integer. Their summits are at the height of the plane at the first sample. The new and the
earlier asperities together have exactly the area and load of the second sample (eq. S1, as for operating
points). If the earlier asperities already have more friction than the second sample, no asperities are added.
Finally, the asperities are spread over the heights between the levels.

*By least squares, for several tools.* At given approaches x_k of the plane, load and area are linear in the
numbers c of asperities with each tool and each gap: ``sum c P(x_k - g) = P_k``, ``sum c A(x_k - g) = F_k``.
The approaches are not known; powers of the load with several exponents and several largest values are tried.
The solution has few non-zero numbers, which are then rounded to whole asperities.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.optimize import linprog, nnls

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.errors import InvalidInput
from metafem.inversion.bounds import Bounds, at_load, nearest_law
from metafem.inversion.problem import Asperities, Problem
from metafem.inversion.target_law import TargetLaw

# Smallest and largest indentation over R in the table of contacts, and number of tabulated contacts.
TABLE, TABULATED = (1e-18, 10.0), 800

# Indentations, loads and areas of a contact.
Table = tuple[FloatArray, FloatArray, FloatArray]

# Number of depths of the plane among which that of a sample is bracketed, and number of times.
ZOOM, ZOOMS = 32, 2

# If some asperities of an initial guess are lower than allowed, guesses with these fractions of them are
# tried. Raised to the foot, they come into contact earlier, and fewer of them are enough.
LOW_FRACTIONS = (1.0, 0.75, 0.5, 0.25, 0.0)

# If the level of the target is free, levels at these fractions of the range within the bounds are tried.
LEVEL_FRACTIONS = (0.5, 0.25, 0.75, 0.1, 0.9)

# Exponents m of the approaches ``x = X (P/P_K)^(1/m)``, and X over the largest difference of the heights.
POWERS = (1.0, 1.15, 1.3, 1.6, 2.0, 2.6, 3.5)
DEPTHS = (0.03, 0.1, 0.2, 0.3, 0.5, 1.0)

# Largest number of loads, and number of gaps for each tool, which lie at approaches between the loads.
LOADS, GAPS = 30, 40

# Largest number of iterations of the least squares, and of its guesses that are used, the nearest ones.
MOST_STEPS, USED = 2000, 20


def frictions(law: TargetLaw, bounds: Bounds) -> list[FloatArray]:
    """Return frictions (k,) [mm^2] within the bounds for initial guesses, nearest to the target.

    The free parameters of a law lie between those of the lowest and of the highest law within the bounds.
    """
    if not law.is_open:
        return [nearest_law(law, bounds)[1]]
    low, high = bounds.region(law.load)
    rows, right = np.vstack([law.free, -law.free]), np.append(high - law.lower, law.lower - low)
    any_value = [(None, None)] * law.free.shape[1]
    ends = [linprog(sign * law.free.sum(axis=0), rows, right, bounds=any_value) for sign in (1.0, -1.0)]
    if any(end.x is None for end in ends):  # no parameters bring the law within the bounds
        return [np.clip(law.law(np.sqrt(low * high)), low, high)]
    c = [ends[0].x + part * (ends[1].x - ends[0].x) for part in LEVEL_FRACTIONS]
    return [np.clip(law.lower + law.free @ each, low, high) for each in c]


def of_one_tool(
    problem: Problem, load: FloatArray, friction: FloatArray, tool: int, rng: np.random.Generator
) -> Iterator[Asperities]:
    """Yield asperities of one tool whose law is near frictions at loads, (k,) each [mm^2]."""
    span = problem.limits.span
    height = in_order(*problem.tools.laws[tool], load, friction, problem.count)
    inside = int((height >= height[0] - span).sum())
    # if heights are deeper than the span, further guesses have fewer of these heights
    for number in dict.fromkeys(inside + round(part * (len(height) - inside)) for part in LOW_FRACTIONS):
        yield problem.placed(height[:number], np.full(number, tool), rng)


def of_several_tools(
    problem: Problem, load: FloatArray, friction: FloatArray, rng: np.random.Generator
) -> list[Asperities]:
    """Return asperities of the tried tools whose law is near frictions at loads (k,), the nearest first."""
    rows = np.unique(np.linspace(0.0, len(friction) - 1.0, LOADS).round().astype(np.int64))
    load, friction, span = load[rows], friction[rows], problem.limits.span
    law, tried = problem.tools.law, problem.tools.tried
    which, right = np.tile(tried, GAPS), np.ones(2 * len(load))
    found = []
    for depth in DEPTHS:
        for power in POWERS:
            approach = depth * span * (load / load[-1]) ** (1.0 / power)
            at = np.linspace(0.0, len(load) - 1.0, GAPS)[1:]
            gap = np.repeat(np.insert(np.interp(at, np.arange(len(load)), approach), 0, 0.0), len(tried))
            indentation = approach[:, None] - gap
            try:
                one = law.contacts(
                    indentation, np.broadcast_to(problem.tools.summits[which], indentation.shape)
                )
                closed = indentation > 0.0
                areas, loads = np.where(closed, one.area, 0.0), np.where(closed, one.load, 0.0)
                columns = np.vstack([areas / friction[:, None], loads / load[:, None]])
                number, left = nnls(columns, right, maxiter=MOST_STEPS)
            except (InvalidInput, RuntimeError):  # beyond the range of the law, or no solution
                continue
            used = np.flatnonzero(number)
            if used.size:
                height, tool = _rounded(gap[used], which[used], number[used], problem.count)
                found.append((left, problem.placed(height, tool, rng)))
    return [one for _, one in sorted(found, key=lambda each: each[0])[:USED]]


def _rounded(gap: FloatArray, which: IntArray, number: FloatArray, count: int) -> tuple[FloatArray, IntArray]:
    """Return heights [mm] and tools of whole asperities, at most `count`, from any numbers."""
    order = np.lexsort((which, gap))
    total = np.cumsum(number[order])
    most = min(count, max(1, math.ceil(total[-1])))
    middle = (np.arange(most) + 0.5) / most * total[-1]
    rows = order[np.minimum(np.searchsorted(total, middle), len(order) - 1)]
    return gap[rows[0]] - gap[rows], which[rows]


def in_order(law: Contact, radius: float, load: FloatArray, friction: FloatArray, count: int) -> FloatArray:
    """Return at most `count` heights [mm] of asperities of one radius whose law is near the samples.

    The tallest height is first and equal to 0.
    """
    table = _table(law, radius)
    first, loads, areas = table
    if law.power == 1.0:
        # cones have the same P/A at any depth, so the first load is divided among all asperities
        depth = float(at_load(law, load[:1] / count, radius)[0][0])
    else:  # P/A increases with the indentation
        depth = float(np.interp(load[0] / friction[0], loads / areas, first))
    levels, numbers, plane = [0.0], [friction[0] / float(_contacts(table, depth)[1])], -depth
    for p, f in zip(load[1:], friction[1:], strict=True):
        depth, number = _entering(table, np.array(levels) - plane, np.array(numbers), p, f)
        if number > 0.0:
            levels.append(plane)
            numbers.append(number)
        plane -= depth
    return _spread(np.array(levels), np.array(numbers), plane, count)


def _table(law: Contact, radius: float) -> Table:
    """Return indentations [mm], loads and areas [mm^2] of contacts with summits of one radius [mm]."""
    most = min(float(law.largest_indentation(radius)), TABLE[1] * radius)
    depth = np.geomspace(TABLE[0] * radius, most, TABULATED)
    found = law.contacts(depth, np.full(TABULATED, radius))
    return depth, found.load, found.area


def _contacts(table: Table, depth: Any) -> tuple[FloatArray, FloatArray]:
    """Return loads and areas [mm^2] at indentations above 0."""
    at, known = np.log(depth), np.log(table[0])
    return np.interp(at, known, table[1]), np.interp(at, known, table[2])


def _entering(
    table: Table, above: FloatArray, many: FloatArray, load: float, friction: float
) -> tuple[float, float]:
    """Return the depth [mm] of the plane below the new level at a sample, and the number of new asperities.

    above, many: heights above the new level and numbers of the asperities that are in contact.
    """
    low, high = table[0][0], table[0][-1]
    for _ in range(ZOOMS):
        depth = np.geomspace(low, high, ZOOM)
        carried, area = (many @ part for part in _contacts(table, above[:, None] + depth))
        one_load, one_area = _contacts(table, depth)
        number = np.maximum(friction - area, 0.0) / one_area  # eq. S1
        missing = load - carried - number * one_load
        i = int((missing <= 0.0).argmax()) if missing[-1] <= 0.0 else ZOOM - 1
        if carried[0] >= load or i == 0:
            return (0.0, 0.0) if carried[0] >= load else (float(low), float(number[0]))
        low, high = depth[i - 1], depth[i]
    share = min(1.0, missing[i - 1] / (missing[i - 1] - missing[i]))
    return float(low + share * (high - low)), float(number[i - 1] + share * (number[i] - number[i - 1]))


def _spread(levels: FloatArray, numbers: FloatArray, plane: float, count: int) -> FloatArray:
    """Return the heights [mm] of an integer number of asperities.

    The asperities of a level are spread evenly over the heights up and down to half-way to the next levels.
    """
    ends = np.append(np.insert(0.5 * (levels[1:] + levels[:-1]), 0, levels[0]), 0.5 * (levels[-1] + plane))
    total = np.insert(np.cumsum(numbers), 0, 0.0)
    most = min(count, max(1, math.ceil(total[-1])))
    return np.asarray(np.interp((np.arange(most) + 0.5) / most * total[-1], total, ends))
