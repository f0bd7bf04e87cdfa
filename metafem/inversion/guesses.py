"""Initial guesses for independent asperities whose law is near a target.

*In order of contact.* Between two consecutive samples of the law, a number of new asperities is added, which
need not be an integer. Their summits are at the height of the plane at the first sample. The new and the
earlier asperities together have exactly the area and load of the second sample (eq. S1, as for operating
points). If the earlier asperities already have more friction than the second sample, no asperities are added.
Finally, the asperities are spread over the heights between the levels.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.optimize import linprog

from metafem._validate import FloatArray
from metafem.contact import Contact
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
    height = in_order(law, load, friction, summit, problem.count)
    inside = int((height >= height[0] - span).sum())
    # if heights are deeper than the span, further guesses have fewer of these heights
    for number in dict.fromkeys(inside + round(part * (len(height) - inside)) for part in LOW_FRACTIONS):
        yield problem.placed(height[:number], np.full(number, tool), rng)


def in_order(law: Contact, load: FloatArray, friction: FloatArray, radius: Any, count: int) -> FloatArray:
    """Return at most `count` heights [mm] with summits of one radius, whose law is near the samples.

    The tallest height is first and equal to 0.
    """
    table = _Table(law, radius)
    if law.power == 1.0:
        # cones have the same P/A at any depth, so the first load is divided among all asperities
        depth = float(at_load(law, load[:1] / count, radius)[0][0])
    else:  # P/A increases with the indentation
        depth = float(np.interp(load[0] / friction[0], table.load / table.area, table.depth))
    levels, numbers, plane = [0.0], [friction[0] / float(table.contacts(depth)[1])], -depth
    for p, f in zip(load[1:], friction[1:], strict=True):
        depth, number = _entering(table, np.array(levels) - plane, np.array(numbers), p, f)
        if number > 0.0:
            levels.append(plane)
            numbers.append(number)
        plane -= depth
    return _spread(np.array(levels), np.array(numbers), plane, count)


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
    table: _Table, above: FloatArray, numbers: FloatArray, load: float, friction: float
) -> tuple[float, float]:
    """Return the depth [mm] of the plane below the new level at a sample, and the number of new asperities.

    above, numbers: heights above the new level and numbers of the asperities that are in contact.
    """
    low, high = table.depth[0], table.depth[-1]
    for _ in range(ZOOMS):
        depth = np.geomspace(low, high, ZOOM)
        loads, areas = table.contacts(above[:, None] + depth)
        carried, area = numbers @ loads, numbers @ areas
        one_load, one_area = table.contacts(depth)
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
