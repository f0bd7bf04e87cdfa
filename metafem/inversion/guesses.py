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

# Up to this number of sites, random initial guesses come first, and their number; their heights are drawn to
# this multiple of the indentation of half of the sites.
FEW, RANDOM, DEEP = 12, 40, 4.0


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
    law, summit = problem.tools.laws[tool]
    height, _ = in_order(law, load, friction, np.full(len(load), summit), problem.count)
    inside = int((height >= height[0] - span).sum())
    # if heights are deeper than the span, further guesses have fewer of these heights
    for number in dict.fromkeys(inside + round(part * (len(height) - inside)) for part in LOW_FRACTIONS):
        yield problem.placed(height[:number], np.full(number, tool), rng)


def of_several_tools(
    problem: Problem, load: FloatArray, friction: FloatArray, rng: np.random.Generator
) -> Iterator[Asperities]:
    """Yield asperities of several tools whose law is near frictions at loads, (k,) each [mm^2]."""
    tools, count = problem.tools, problem.count
    if count <= FEW:
        law, summit = tools.laws[len(tools) // 2]
        depth, _ = at_load(law.without_adhesion, load[-1:] / max(1.0, 0.5 * count), summit)
        for number in rng.integers((count + 1) // 2, count + 1, size=RANDOM).tolist():
            height = -rng.uniform(0.0, min(DEEP * float(depth[0]), problem.limits.span), number)
            yield problem.placed(height, rng.integers(len(tools), size=number), rng)
    if tools.same_shape:  # radii that increase or decrease with the depth
        order = np.argsort([tool.radius for tool in tools.all], kind="stable")
        ramp = order[np.linspace(0.0, len(tools) - 1.0, len(load)).round().astype(np.int64)]
        for which in (ramp, ramp[::-1]):
            height, sample = in_order(tools.law, load, friction, tools.summits[which], count)
            yield problem.placed(height, which[sample], rng)
    yield from by_least_squares(problem, load, friction, rng)


def by_least_squares(
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


def in_order(
    law: Contact, load: FloatArray, friction: FloatArray, radius: FloatArray, count: int
) -> tuple[FloatArray, IntArray]:
    """Return at most `count` heights [mm] whose law is near the samples, and the samples they are added for.

    The tallest height is first and equal to 0. Asperities added for sample k have the k-th radius.
    """
    tables = {size: _Table(law, size) for size in np.unique(radius).tolist()}
    first = tables[radius[0]]
    if law.power == 1.0:
        # cones have the same P/A at any depth, so the first load is divided among all asperities
        depth = float(at_load(law, load[:1] / count, radius[0])[0][0])
    else:  # P/A increases with the indentation
        depth = float(np.interp(load[0] / friction[0], first.load / first.area, first.depth))
    levels, numbers, at, plane = [0.0], [friction[0] / float(first.contacts(depth)[1])], [0], -depth
    for k, (p, f, new) in enumerate(zip(load[1:], friction[1:], radius[1:], strict=True), start=1):
        above, kinds, many = np.array(levels) - plane, radius[at], np.array(numbers)
        parts = [(tables[size], above[kinds == size], many[kinds == size]) for size in set(kinds.tolist())]
        depth, number = _entering(tables[new], parts, p, f)
        if number > 0.0:
            levels.append(plane)
            numbers.append(number)
            at.append(k)
        plane -= depth
    return _spread(np.array(levels), np.array(numbers), np.array(at), plane, count)


class _Table:
    """Indentations [mm], loads and areas [mm^2] of contacts with summits of one radius [mm]."""

    def __init__(self, law: Contact, radius: float) -> None:
        most = min(float(law.largest_indentation(radius)), TABLE[1] * radius)
        self.depth = np.geomspace(TABLE[0] * radius, most, TABULATED)
        found = law.contacts(self.depth, np.full(TABULATED, radius))
        self.load, self.area, self.logarithm = found.load, found.area, np.log(self.depth)

    def contacts(self, depth: Any) -> tuple[FloatArray, FloatArray]:
        """Return loads and areas [mm^2] at indentations above 0."""
        at = np.log(depth)
        return np.interp(at, self.logarithm, self.load), np.interp(at, self.logarithm, self.area)


def _entering(
    new: _Table, earlier: list[tuple[_Table, FloatArray, FloatArray]], load: float, friction: float
) -> tuple[float, float]:
    """Return the depth [mm] of the plane below the new level at a sample, and the number of new asperities.

    earlier: tables, heights above the new level and numbers of the asperities that are in contact.
    """
    low, high = new.depth[0], new.depth[-1]
    for _ in range(ZOOMS):
        depth = np.geomspace(low, high, ZOOM)
        carried = area = np.zeros(ZOOM)
        for table, above, many in earlier:
            loads, areas = table.contacts(above[:, None] + depth)
            carried, area = carried + many @ loads, area + many @ areas
        one_load, one_area = new.contacts(depth)
        number = np.maximum(friction - area, 0.0) / one_area  # eq. S1
        missing = load - carried - number * one_load
        i = int((missing <= 0.0).argmax()) if missing[-1] <= 0.0 else ZOOM - 1
        if carried[0] >= load or i == 0:
            return (0.0, 0.0) if carried[0] >= load else (float(low), float(number[0]))
        low, high = depth[i - 1], depth[i]
    share = min(1.0, missing[i - 1] / (missing[i - 1] - missing[i]))
    return float(low + share * (high - low)), float(number[i - 1] + share * (number[i] - number[i - 1]))


def _spread(
    levels: FloatArray, numbers: FloatArray, at: IntArray, plane: float, count: int
) -> tuple[FloatArray, IntArray]:
    """Return the heights [mm] of an integer number of asperities, and the samples they are added for.

    The asperities of a level are spread evenly over the heights up and down to half-way to the next levels.
    """
    ends = np.append(np.insert(0.5 * (levels[1:] + levels[:-1]), 0, levels[0]), 0.5 * (levels[-1] + plane))
    total = np.insert(np.cumsum(numbers), 0, 0.0)
    most = min(count, max(1, math.ceil(total[-1])))
    middle = (np.arange(most) + 0.5) / most * total[-1]
    level = np.minimum(np.searchsorted(total[1:], middle), len(at) - 1)
    return np.interp(middle, total, ends), at[level]
