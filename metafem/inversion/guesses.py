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
from collections.abc import Callable, Iterator

import numpy as np
from scipy.optimize import brentq, linprog, nnls

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.errors import InvalidInput
from metafem.inversion.bounds import Bounds, at_load, nearest_law
from metafem.inversion.problem import Asperities, Problem
from metafem.inversion.target_law import TargetLaw

# Smallest and largest indentation over R in the table of contacts, and number of tabulated contacts.
TABLE, TABULATED = (1e-9, 10.0), 400

# Smallest indentation of new asperities that is tried, relative to the indentation at which the earlier
# asperities have the required area. Below it, the number of new asperities would be unrealistically large.
SHALLOWEST = 1e-9

# Smallest and largest indentation over R in the search for the contact that has a certain pressure.
LEAST_DEPTH, MOST_DEPTH = 1e-12, 1e2

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
    if any(end.x is None for end in ends):
        return [nearest_law(law, bounds)[1]]
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
    law: Contact,
    load: FloatArray,
    friction: FloatArray,
    radius: FloatArray,
    count: int,
) -> tuple[FloatArray, IntArray]:
    """Return at most `count` heights [mm] whose law is near the samples, and the samples they are added for.

    The tallest height is first and equal to 0. Asperities added for sample k have the k-th radius.
    """
    if law.power == 1.0:
        # cones have the same P/A at any depth, so the first load is divided among all asperities
        depth = float(at_load(law, load[:1] / count, radius[0])[0][0])
    else:
        depth = depth_at_pressure(law, load[0] / friction[0], radius[0]) or LEAST_DEPTH * radius[0]
    first = float(law.contacts(np.array(depth), radius[:1]).area[0])
    levels, numbers, kinds = [0.0], [friction[0] / first], [radius[0]]
    plane, widest, single, at = -depth, float(radius.max()), _Single(law, radius), [0]
    for k, (p, f, new) in enumerate(zip(load[1:], friction[1:], radius[1:], strict=True), start=1):
        earlier = np.array([np.array(levels) - plane, kinds, numbers])
        depth, number = _entering(single, earlier, p, f, new, widest)
        if number > 0.0:
            levels.append(plane)
            numbers.append(number)
            kinds.append(new)
            at.append(k)
        plane -= depth
    return _spread(np.array(levels), np.array(numbers), np.array(at), plane, count)


def _entering(
    single: _Single, asperities: FloatArray, load: float, friction: float, radius: float, widest: float
) -> tuple[float, float]:
    """Return the depth [mm] of the plane below the new level at a sample, and the number of new asperities.

    `asperities` (3, q) holds the heights above the new level, the radii and the numbers of the earlier
    asperities, which are all in contact.
    """
    above, kind, number = asperities
    most, sums = float((single.deepest(kind) - above).min()), single.sums(kind, number)

    def at(depth: float) -> tuple[float, float]:
        """Return the load and area [mm^2] of the earlier asperities if the plane is at this depth."""
        return sums(above + depth)

    def depth_of(index: int, value: float) -> float:
        """Return the depth [mm] at which the load (index 0) or area (1) has a value, or the largest depth."""
        high = min(widest, most)
        while at(high)[index] < value:
            if high >= most:
                return most
            high = min(2.0 * high, most)
        return _root(lambda depth: at(depth)[index] - value, 0.0, high, high)

    carried, area = at(0.0)
    deepest = depth_of(1, friction) if area < friction else 0.0
    if area >= friction or deepest <= 0.0 or at(deepest)[0] <= load:
        return (0.0 if carried >= load else depth_of(0, load)), 0.0
    one = single.sums(np.array([radius]), np.ones(1))

    def missing(depth: float) -> tuple[float, float]:
        """Return the excess load [mm^2] and the number of new asperities that have the missing area."""
        carried, area = at(depth)
        new_load, new_area = one(np.array([depth]))
        number = (friction - area) / new_area
        return carried + number * new_load - load, number  # eq. S1

    low = SHALLOWEST * deepest
    if missing(low)[0] >= 0.0:
        return low, max(missing(low)[1], 0.0)
    if missing(deepest)[0] <= 0.0:  # the earlier asperities also have this load, up to rounding
        return deepest, 0.0
    depth = _root(lambda d: missing(d)[0], low, deepest, low)
    return depth, max(missing(depth)[1], 0.0)


class _Single:
    """Loads and areas of contacts: closed forms for power laws, otherwise interpolated in logarithms."""

    def __init__(self, law: Contact, radius: FloatArray) -> None:
        self.law = law
        self.tables = {} if law.power is not None else {R: self._table(R) for R in np.unique(radius).tolist()}

    def _table(self, radius: float) -> tuple[FloatArray, ...]:
        """Return the logarithm of the indentation, and load and area of one contact, (400,) each.

        Without adhesion, load and area are logarithms, too.
        """
        most = min(float(self.law.largest_indentation(radius)), TABLE[1] * radius)
        depth = np.geomspace(TABLE[0] * radius, most, TABULATED)
        found = self.law.contacts(depth, np.full(TABULATED, radius))
        if self.law.adhesive:
            return np.log(depth), found.load, found.area
        return np.log(depth), np.log(found.load), np.log(found.area)

    def deepest(self, radius: FloatArray) -> FloatArray:
        """Return the largest tabulated indentations [mm]."""
        if not self.tables:
            return self.law.largest_indentation(radius)
        return np.array([math.exp(self.tables[R][0][-1]) for R in radius.tolist()])

    def sums(self, radius: FloatArray, number: FloatArray) -> Callable[[FloatArray], tuple[float, float]]:
        """Return the total load and area [mm^2] as a function of the indentations of asperities (q,) [mm]."""
        n = self.law.power
        if n is not None:
            unit = self.law.contacts(np.ones(len(radius)), radius)
            loads, areas, by_load, by_area = unit.load * number, unit.area * number, 1.0 + 1.0 / n, 2.0 / n
            return lambda depth: (float(loads @ depth**by_load), float(areas @ depth**by_area))
        parts = [(self.tables[R], radius == R) for R in np.unique(radius).tolist()]
        tabulated = (lambda value: value) if self.law.adhesive else np.exp

        def sums(depth: FloatArray) -> tuple[float, float]:
            load = area = 0.0
            # an open contact is treated as a contact at the smallest tabulated indentation
            logarithm = np.log(np.maximum(depth, np.finfo(float).tiny))
            for (x, by_load, by_area), which in parts:
                at, weight = logarithm[which], number[which]
                load += float(tabulated(np.interp(at, x, by_load)) @ weight)
                area += float(tabulated(np.interp(at, x, by_area)) @ weight)
            return load, area

        return sums


def _root(function: Callable[[float], float], low: float, high: float, scale: float) -> float:
    return float(brentq(function, low, high, xtol=1e-12 * scale, rtol=1e-12))


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


def depth_at_pressure(law: Contact, pressure: float, radius: float) -> float:
    """Return the indentation [mm] at which P/A of one contact is `pressure` E*.

    P/A increases with the indentation. For a pressure [-] outside its range, the result is 0 or the largest
    indentation.
    """

    def excess(logarithm: float) -> float:
        found = law.contacts(np.array(math.exp(logarithm)), np.array(radius))
        # an adhesive contact has a negative load at small indentations
        return math.log(max(float(found.load), np.finfo(float).tiny) / found.area / pressure)

    most = min(float(law.largest_indentation(radius)), MOST_DEPTH * radius)
    if law.power is not None and law.power > 1.0:  # P/A ~ d^(1 - 1/n)
        n = law.power
        unit = law.contacts(np.array(radius), np.array(radius))
        at_radius = float(unit.load / unit.area)
        return float(min(radius * (pressure / at_radius) ** (n / (n - 1.0)), most))
    low, high = math.log(LEAST_DEPTH * radius), math.log(most)
    if excess(high) <= 0.0:
        return most
    # most indentations are near this value, which shortens the search
    middle = min(math.log(radius) - 3.0, high)
    low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    if excess(low) >= 0.0:
        return 0.0
    return math.exp(brentq(excess, low, high, xtol=1e-15, rtol=4.0 * np.finfo(float).eps))
