"""Bounds on the friction of every surface of N independent asperities of one contact law.

The law of one contact, P(A) and its derivatives by the indentation d, determines which bounds hold:

1. *P is convex in A* (elastic caps with a convex D(a), as dP/dA = D'/pi: powers of at least 1, the
   sphere). The area of a contact is then a concave function A1(P), and by Jensen's inequality
   ``A1(p) <= A0 <= N A1(p/N)``: a given load p = P/E* has the least area on one contact and the largest on N
   equal ones. If the law scales with R, A1(P) increases with R: the bounds are those of the smallest and the
   largest radius.
2. *P is log-concave in d as well* (elastic caps: dP/dd = 2 a, and P/a increases). By Chebyshev's sum
   inequality the local exponent ``d ln A0/d ln p`` of asperities of one radius is then at least the smallest
   exponent of a single contact up to that load; for a power cap rho^n that is 2/(n + 1). New contacts raise
   it.
3. *Power caps of several radii.* The exponent is ``2/(n + 1) <x^(n-1)> <x^(1-n)>`` with x = a/R and the
   means weighted by R^2 x^2 and R x. It is least for two kinds of contact, large caps with a/R = x and small
   ones with a/R = s^2 x: by Jensen's inequality for the contacts of each radius, and as the minimum is at the
   extreme radii. With k^2 = R1/R2 and ``1/(k s)^3`` small caps for each large one it is
   ``2/(n + 1) ((k s^n + s^(1-n))/(1 + k s))^2``, least at the root s > 1 of
   ``(n - 1) k^2 s^(2n) + n k s^(2n-1) - n k s - (n - 1)``.
4. *Steepest slope.* For power caps with n <= 2, Hoelder's inequality between the sums of a, a^2 and a^(n+1)
   gives ``dA0/dp <= 2/(n + 1) K p/A0^n`` with ``K p^2 = (N A1(p/N))^(n+1)``: A0^(n+1) - K p^2 cannot rise
   along a law. For n > 2 a contact begins with an infinite slope. For elastic caps of one radius whose area
   is concave in d, ``A0(p) - A0(q) <= N A(d1(p) - d1(q))`` with the indentation d1 of one contact: the plane
   moves by d1(p) - d1(q) at the most, as the stiffness 2 a is a subadditive function of the load, and no
   area grows by more than that of a new contact.

Laws other than power laws are checked at CONTACTS indentations up to the largest load. With adhesion a
contact has an area at zero load, and no bound is used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.law import Contacts, contacts
from metafem.inversion.limits import Limits, Radii
from metafem.models import Independent

# A value this close to a bound counts as equal: values computed from a surface must not fail by rounding.
ROUNDING = 1e-9

# Number of indentations at which a law is checked, evenly spaced in the logarithm, and their relative range.
CONTACTS, SHALLOWEST = 400, 1e-12

# Maximum number of load doublings in the search for the end of a line.
MOST_DOUBLINGS = 60

# Smallest and largest indentation over R in searches for the contact of a given pressure.
LEAST_DEPTH, MOST_DEPTH = 1e-12, 1e2


@dataclass(frozen=True)
class Bounds:
    """Proven bounds for at most `count` independent asperities of a law, up to a load `last` [mm^2].

    If no bound is proven, they are 0 and infinite.
    """

    law: Contact
    radii: Radii
    count: int
    last: float

    @property
    def least_power(self) -> float:
        """Exponent 2/(n + 1) of the friction of a fixed number of equal power caps."""
        return 2.0 / (1.0 + (self.law.power or math.inf))

    def region(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Friction of one asperity and of N equal asperities at rescaled loads, (k,) [mm^2]."""
        equal = self.count * at_load(self.law.without_adhesion, load / self.count, self.radii.high)[1]
        return at_load(self.law.without_adhesion, load, self.radii.low)[1], equal

    def friction(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest friction at rescaled loads, (k,) [mm^2]."""
        if self.convex:
            return self.region(load)
        return np.zeros(len(load)), np.full(len(load), math.inf)

    @cached_property
    def convex(self) -> bool:
        """Whether the load of one contact is a convex function of its area, for all radii."""
        if self.law.adhesive or not (self.radii.single or self.law.similar):
            return False
        if self.law.power is not None:
            return bool(self.law.power >= 1.0)
        found, area_slope = self._examined
        return _rises(found.stiffness / area_slope)

    @cached_property
    def _examined(self) -> tuple[Contacts, FloatArray]:
        """Contacts of the least radius up to the last load, and the derivatives of their areas [mm]."""
        law, radius = self.law.without_adhesion, self.radii.low
        deepest, _ = at_load(law, np.array([self.last]), radius)
        depth = deepest * np.geomspace(SHALLOWEST, 1.0, CONTACTS)
        found = contacts(law, depth, np.full(CONTACTS, radius))
        return found, law.area_slope(found.contact_radius, np.full(CONTACTS, radius))

    @cached_property
    def least_exponent(self) -> float:
        """Least local exponent of a law."""
        n, radii = self.law.power, self.radii
        if n is not None and self.convex:
            k, s = math.sqrt(radii.low / radii.high), relative_depth(radii, n)
            return float(self.least_power * ((s ** (1.0 - n) + k * s**n) / (1.0 + k * s)) ** 2)
        if not (self.convex and radii.single):
            return 0.0
        found, area_slope = self._examined
        if not _rises(found.load / found.stiffness):
            return 0.0
        return float((found.load * area_slope / (found.stiffness * found.area)).min())

    def largest_exponent(self, load_range: tuple[float, float]) -> float:
        """Largest exponent over a range: from one asperity to N equal ones."""
        if not self.convex:
            return math.inf
        low, high = self.region(np.array(load_range))
        return math.log(high[1] / low[0]) / math.log(load_range[1] / load_range[0])

    def steepest(self, load: float, friction: float, margin: float = 0.0) -> float:
        """Largest slope dA0/d(P/E*) of a law through a point, with a margin on the highest friction."""
        n = self.law.power
        if n is None or n > 2.0 or not self.convex:
            return math.inf
        highest = float(self.region(np.array([load]))[1][0]) * (1.0 + margin)
        return float(self.least_power * (highest / friction) ** n * highest / load)

    def highest_after(self, load: FloatArray, friction: FloatArray) -> FloatArray:
        """Highest friction [mm^2] at each of increasing loads (k,), given the friction at smaller loads."""
        n = self.law.power
        if not self.convex:
            return np.full(len(load), math.inf)
        if n is not None and n <= 2.0:
            rise = self.region(load)[1] ** (n + 1.0)
            least = np.minimum.accumulate(np.insert(friction ** (n + 1.0) - rise, 0, 0.0))[:-1]
            return np.asarray((least + rise) ** (1.0 / (n + 1.0)))
        elastic = self.law.largest_order > 1 and self.radii.single
        if not elastic or (n is None and not _rises(-self._examined[1])):
            return np.full(len(load), math.inf)
        moved = np.diff(at_load(self.law, load, self.radii.low)[0], prepend=0.0)
        new = self.count * contacts(self.law, moved, np.full(len(load), self.radii.low)).area
        return np.asarray(new + np.insert(friction, 0, 0.0)[:-1])

    def largest_load(self, limits: Limits) -> float:
        """Load P/E* [mm^2] that N asperities carry when the plane reaches the base plane."""
        law, most = self.law.without_adhesion, 0.0
        for radius in (self.radii.low, self.radii.high):
            depth = min(limits.top, float(law.largest_indentation(radius)))
            most = max(most, float(contacts(law, np.array(depth), np.array(radius)).load))
        return self.count * most

    def start_of_line(self, slope: float) -> float:
        """Load [mm^2] below which one asperity has more friction than a line through the origin."""
        if not self.convex:
            return 0.0
        return load_at_pressure(self.law, 1.0 / slope, self.radii.low)

    def end_of_line(self, slope: float, intercept: float, margin: float = 0.0) -> float:
        """Load beyond which no law has the friction and slope of a line ``slope p + intercept`` [mm^2]."""
        if not self.convex:
            return math.inf
        if self.law.power == 2.0:
            # m (m p + b)^2 = (2/3) K p: the slope is possible between the two roots
            highest = float(self.region(np.ones(1))[1][0]) * (1.0 + margin)
            shift = intercept / slope
            half = self.least_power * highest**3 / (2.0 * slope**3) - shift
            return half + math.sqrt(max(half**2 - shift**2, 0.0))
        # without the intercept, N equal asperities have less friction from N times the load of one on
        end = self.count * load_at_pressure(self.law, (1.0 + margin) / slope, self.radii.high)

        def above(p: float) -> float:
            return slope * p + intercept - float(self.region(np.array([p]))[1][0]) * (1.0 + margin)

        # the highest friction is concave in the load: a line leaves it once
        low, high = end, end
        for _ in range(MOST_DOUBLINGS):
            if above(high) > 0.0:
                break
            low, high = high, 2.0 * high
        for _ in range(MOST_DOUBLINGS):
            if above(low) <= 0.0:
                break
            low *= 0.5
        return float(brentq(above, low, high)) if above(low) <= 0.0 < above(high) else high

    def tangent_load(self, slope: float) -> float:
        """Load at which the friction of one asperity has a slope [mm^2]."""
        return load_at_pressure(self.law.without_adhesion, 1.0 / slope, self.radii.low, tangent=True)


def at_load(law: Contact, load: FloatArray, radius: float) -> tuple[FloatArray, FloatArray]:
    """Return indentation [mm] and friction [mm^2] of one asperity at rescaled loads, (k,).

    Above the largest load of the law, they are the values at that load.
    """
    n = law.power
    if n is None:
        deepest = np.array(law.largest_indentation(radius))
        if np.isfinite(deepest):
            load = np.minimum(load, contacts(law, deepest, np.array(radius)).load)
        depth, _, area, _ = Independent(contact=law).curves(np.zeros(1), radius, load)
        return depth[0], area[0]
    unit = contacts(law, np.ones(1), np.array([radius]))
    relative = load / unit.load
    return relative ** (n / (n + 1.0)), unit.area * relative ** (2.0 / (n + 1.0))


def relative_depth(radii: Radii, power: float = 2.0) -> float:
    """Return s for two kinds of contact of power caps: a/R of the small ones is s^2 times the other."""
    if radii.single:
        return 1.0
    n, k = power, math.sqrt(radii.low / radii.high)

    def slope(s: float) -> float:
        odd = n * k * (s ** (2.0 * n - 1.0) - s)
        return float((n - 1.0) * (k * k * s ** (2.0 * n) - 1.0) + odd)

    # at k^(-1/n) the first bracket vanishes
    return float(brentq(slope, 1.0, k ** (-1.0 / n)))


def depth_at_pressure(law: Contact, pressure: float, radius: float, *, tangent: bool = False) -> float:
    """Return the indentation [mm] at which P/A, or with `tangent` dP/dA, of one contact has a value.

    The value is over E* [-], and the quotient increases; beyond its range, 0 or the largest indentation.
    """

    def excess(logarithm: float) -> float:
        found = contacts(law, np.array(math.exp(logarithm)), np.array(radius))
        if tangent:
            return math.log(found.stiffness / law.area_slope(found.contact_radius, radius) / pressure)
        return math.log(found.load / found.area / pressure)

    most = min(float(law.largest_indentation(radius)), MOST_DEPTH * radius)
    low, high = math.log(LEAST_DEPTH * radius), math.log(most)
    if excess(high) <= 0.0:
        return most
    # most values are near this one
    middle = min(math.log(radius) - 3.0, high)
    low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    if excess(low) >= 0.0:
        return 0.0
    return math.exp(brentq(excess, low, high, xtol=1e-15, rtol=4.0 * np.finfo(float).eps))


def load_at_pressure(law: Contact, pressure: float, radius: float, *, tangent: bool = False) -> float:
    """Return the load of one contact [mm^2] at the indentation of `depth_at_pressure`."""
    depth = depth_at_pressure(law, pressure, radius, tangent=tangent)
    return float(contacts(law, np.array(depth), np.array(radius)).load)


def _rises(values: FloatArray) -> bool:
    """Whether values do not decrease, up to rounding."""
    return bool((np.diff(values) >= -ROUNDING * np.abs(values[1:])).all())
