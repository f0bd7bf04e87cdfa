"""Initial guess for any law, from the number of asperities that come into contact between its samples.

Between two consecutive samples, a number of new asperities is added, which need not be an integer. Their
summits are at the height of the plane at the first sample. The new and the earlier asperities together have
exactly the area and load of the second sample (eq. S1, as for operating points). If the earlier asperities
already have more friction than the second sample, no asperities are added. Finally, the asperities are spread
over the heights between the levels.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.contact.law import contacts
from metafem.inversion.bounds import LEAST_DEPTH, at_load, depth_at_pressure, relative_depth
from metafem.inversion.tools.radii import Radii

# Smallest and largest indentation over R in the table of contacts, and number of tabulated contacts.
TABLE, TABULATED = (1e-9, 10.0), 400

# Smallest indentation of new asperities that is tried, relative to the indentation at which the earlier
# asperities have the required area. Below it, the number of new asperities would be unrealistically large.
SHALLOWEST = 1e-9


def initial_heights(
    law: Contact,
    load: FloatArray,
    friction: FloatArray,
    radius: FloatArray,
    count: int,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return at most `count` heights whose law is near the samples, radii, and heights of few levels [mm].

    The tallest height is first and equal to 0. Asperities added for sample k have the k-th radius. In the
    heights of few levels, asperities added for consecutive samples have one height, as if all came into
    contact between two samples.
    """
    if law.power == 1.0:
        # cones have the same P/A at any depth, so the first load is divided among all asperities
        depth = float(at_load(law, load[:1] / count, radius[0])[0][0])
    else:
        depth = depth_at_pressure(law, load[0] / friction[0], radius[0]) or LEAST_DEPTH * radius[0]
    first = float(contacts(law, np.array(depth), radius[:1]).area[0])
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
    added = np.array(levels), np.array(numbers)
    return *_spread(*added, np.array(kinds), plane, count), _joined(*added, np.array(at), count)


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
        found = contacts(self.law, depth, np.full(TABULATED, radius))
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
            unit = contacts(self.law, np.ones(len(radius)), radius)
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


def slowest_law(
    law: Contact, load: float, friction: float, radii: Radii, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return at most `count` heights and radii [mm] of power caps with the least slope at a point."""
    n = law.power or 2.0
    k, s = math.sqrt(radii.low / radii.high), relative_depth(radii, n)
    small = 1.0 / (k * s) ** 3  # small caps for each large one
    # P and A of one large cap together with its small caps, relative to those of the large cap
    loads, areas = (1.0 + small * k**4 * s ** (2.0 * power) for power in (n + 1.0, 2.0))
    # indentation of the large caps at which all caps together have the required load over friction
    pressure = load / friction * areas / loads
    depth = depth_at_pressure(law, pressure, radii.high)
    at = contacts(law, np.array(depth), np.array(radii.high))
    large = friction / (areas * float(at.area))
    large *= min(1.0, count / (large * (1.0 + small)))
    numbers = max(1, round(large)), max(1, round(large * small))
    relative = float(at.contact_radius) / radii.high * s * s
    deeper = depth - float(law.indentation(relative * radii.low, radii.low))
    height = np.repeat([0.0, -deeper], numbers)
    radius = np.repeat([radii.high, radii.low], numbers)
    return height[:count], radius[:count]


def _joined(levels: FloatArray, numbers: FloatArray, at: IntArray, count: int) -> FloatArray:
    """Return a whole number of heights at the mean level of each run of consecutive samples `at`."""
    run = np.cumsum((np.diff(at, prepend=-1) > 1) | (at == 1))
    weight = np.bincount(run, numbers)
    mean = np.bincount(run, numbers * levels) / np.where(weight > 0.0, weight, 1.0)
    return np.repeat(mean, np.rint(np.minimum(weight, count)).astype(int))[:count]


def _spread(
    levels: FloatArray, numbers: FloatArray, kinds: FloatArray, plane: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return the heights and radii [mm] of an integer number of asperities.

    The asperities of a level are spread evenly over the heights up and down to half-way to the next levels.
    """
    ends = np.append(np.insert(0.5 * (levels[1:] + levels[:-1]), 0, levels[0]), 0.5 * (levels[-1] + plane))
    total = np.insert(np.cumsum(numbers), 0, 0.0)
    most = min(count, max(1, math.ceil(total[-1])))
    middle = (np.arange(most) + 0.5) / most * total[-1]
    level = np.minimum(np.searchsorted(total[1:], middle), len(kinds) - 1)
    return np.interp(middle, total, ends), kinds[level]
