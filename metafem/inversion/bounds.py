"""Bounds on the friction of all surfaces with N independent asperities and one contact law.

The law P(A) of one contact and its derivatives with respect to the indentation d determine which bounds hold:

1. *P is convex in A.* For elastic caps dP/dA = D'/pi, so this holds if D(a) is convex: for powers of at least
   1 and for the sphere. The area of a contact is then a concave function A1(P), and Jensen's inequality gives
   ``A1(p) <= A0 <= N A1(p/N)``: at a fixed load p = P/E*, one contact has the smallest area and N equal
   contacts have the largest. If the law scales with R, A1(P) increases with R. The lower bound is then that
   of the smallest radius, and the upper bound that of the largest radius.
2. *P is also log-concave in d* (elastic caps: dP/dd = 2 a, and P/a increases). Chebyshev's sum inequality
   then gives a lower bound for the local exponent ``d ln A0/d ln p`` of asperities of one radius: the
   smallest exponent of a single contact up to that load, which is 2/(n + 1) for a power cap rho^n. New
   contacts raise the exponent.
3. *Power caps of several radii.* The exponent is ``2/(n + 1) <x^(n-1)> <x^(1-n)>`` with x = a/R and the
   means weighted by R^2 x^2 and R x. By Jensen's inequality it is smallest if all contacts of one radius
   have the same x, and the minimum is at the extreme radii R1 and R2. The surface then has large caps with
   a/R = x and small caps with a/R = s^2 x. With k^2 = R1/R2 and ``1/(k s)^3`` small caps for each large cap,
   the exponent is ``2/(n + 1) ((k s^n + s^(1-n))/(1 + k s))^2``. Its minimum is at the root s > 1 of
   ``(n - 1) k^2 s^(2n) + n k s^(2n-1) - n k s - (n - 1)``.
4. *Steepest slope.* For power caps with n <= 2, Hoelder's inequality between the sums of a, a^2 and a^(n+1)
   gives ``dA0/dp <= 2/(n + 1) K p/A0^n`` with ``K p^2 = (N A1(p/N))^(n+1)``, so A0^(n+1) - K p^2 cannot rise
   along a law. For n > 2 the area of a contact begins with an infinite slope, and this bound does not exist.
   For elastic caps of one radius whose area is concave in d,
   ``A0(p) - A0(q) <= N A(d1(p) - d1(q))`` with the indentation d1 of one contact. The plane
   moves by at most d1(p) - d1(q), because the stiffness 2 a is a subadditive function of the load, and no
   area grows by more than the area of a new contact.

For laws other than power laws, these conditions are checked at CONTACTS indentations up to the largest load.
With adhesion a contact has an area at zero load, and no bound is used.
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
from metafem.inversion.limits import Limits
from metafem.inversion.tools.radii import Radii
from metafem.models import Independent

# A value within this relative distance of a bound counts as equal to the bound. Otherwise rounding could
# exclude values that were computed from a surface.
ROUNDING = 1e-9

# Number of logarithmically spaced indentations at which a law is checked, and the ratio of the smallest
# indentation to the largest.
CONTACTS, SHALLOWEST = 400, 1e-12

# Maximum number of doublings, and of halvings, of the load in the search for the end of a line.
MOST_DOUBLINGS = 60

# Smallest and largest indentation over R in searches for the contact that has a certain pressure.
LEAST_DEPTH, MOST_DEPTH = 1e-12, 1e2


@dataclass(frozen=True)
class Bounds:
    """Proven bounds on the friction of at most `count` independent asperities up to a load `last` [mm^2].

    Without a proof the lower bound is 0 and the upper bound is infinite.
    """

    law: Contact
    radii: Radii
    count: int
    last: float

    @property
    def least_power(self) -> float:
        """Exponent 2/(n + 1) [-] of the friction of equal power caps that are all in contact."""
        return 2.0 / (1.0 + (self.law.power or math.inf))

    def region(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the friction of one and of N equal asperities at rescaled loads (k,), each (k,) [mm^2]."""
        equal = self.count * at_load(self.law.without_adhesion, load / self.count, self.radii.high)[1]
        return at_load(self.law.without_adhesion, load, self.radii.low)[1], equal

    def friction(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and the highest friction at rescaled loads (k,), each (k,) [mm^2]."""
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
        """Contacts of the smallest radius up to the last load, and their dA/dd, (CONTACTS,) [mm]."""
        law, radius = self.law.without_adhesion, self.radii.low
        deepest, _ = at_load(law, np.array([self.last]), radius)
        depth = deepest * np.geomspace(SHALLOWEST, 1.0, CONTACTS)
        found = contacts(law, depth, np.full(CONTACTS, radius))
        return found, law.area_slope(found.contact_radius, np.full(CONTACTS, radius))

    @cached_property
    def least_exponent(self) -> float:
        """Lower bound of the local exponent d ln A0/d ln p [-]; 0 if none is proven."""
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
        """Return the largest mean exponent [-] over a range of loads.

        The friction then rises from that of one asperity to that of N equal asperities.
        """
        if not self.convex:
            return math.inf
        low, high = self.region(np.array(load_range))
        return math.log(high[1] / low[0]) / math.log(load_range[1] / load_range[0])

    def steepest(self, load: float, friction: float, margin: float = 0.0) -> float:
        """Return the largest slope dA0/d(P/E*) [-] of a law through a point.

        The relative margin raises the highest friction.
        """
        n = self.law.power
        if n is None or n > 2.0 or not self.convex:
            return math.inf
        highest = float(self.region(np.array([load]))[1][0]) * (1.0 + margin)
        return float(self.least_power * (highest / friction) ** n * highest / load)

    def highest_after(self, load: FloatArray, friction: FloatArray) -> FloatArray:
        """Return the highest friction at increasing loads from the friction at smaller loads, (k,) [mm^2]."""
        n = self.law.power
        if not self.convex:
            return np.full(len(load), math.inf)
        if n is not None and n <= 2.0:
            rise = self.region(load)[1] ** (n + 1.0)
            least = np.minimum.accumulate(np.insert(friction ** (n + 1.0) - rise, 0, 0.0))[:-1]
            return np.asarray((least + rise) ** (1.0 / (n + 1.0)))
        elastic = (self.law.largest_order > 1 or self.law.adhesive) and self.radii.single
        if not elastic or (n is None and not _rises(-self._examined[1])):
            return np.full(len(load), math.inf)
        moved = np.diff(at_load(self.law, load, self.radii.low)[0], prepend=0.0)
        new = self.count * contacts(self.law, moved, np.full(len(load), self.radii.low)).area
        return np.asarray(new + np.insert(friction, 0, 0.0)[:-1])

    def largest_load(self, limits: Limits) -> float:
        """Return the load P/E* [mm^2] of N summits of maximum height with the plane at the base plane."""
        law, most = self.law.without_adhesion, 0.0
        for radius in (self.radii.low, self.radii.high):
            depth = min(limits.top, float(law.largest_indentation(radius)))
            most = max(most, float(contacts(law, np.array(depth), np.array(radius)).load))
        return self.count * most

    def start_of_line(self, slope: float) -> float:
        """Return the load [mm^2] below which one asperity has more friction than ``slope p``."""
        if not self.convex:
            return 0.0
        return load_at_pressure(self.law, 1.0 / slope, self.radii.low)

    def end_of_line(self, slope: float, intercept: float, margin: float = 0.0) -> float:
        """Return the load [mm^2] beyond which no law follows the line ``slope p + intercept``."""
        if not self.convex:
            return math.inf
        if self.law.power == 2.0:
            # the slope m is possible between the two roots of m (m p + b)^2 = (2/3) K p
            highest = float(self.region(np.ones(1))[1][0]) * (1.0 + margin)
            shift = intercept / slope
            half = self.least_power * highest**3 / (2.0 * slope**3) - shift
            return half + math.sqrt(max(half**2 - shift**2, 0.0))
        # without an intercept the line ends at N times the load at which one asperity meets the line
        end = self.count * load_at_pressure(self.law, (1.0 + margin) / slope, self.radii.high)
        return self._crossing(end, slope, intercept, margin)

    def _crossing(self, end: float, slope: float, intercept: float, margin: float) -> float:
        """Return the load [mm^2] at which a line crosses the highest friction; `end` is an initial guess."""

        def above(p: float) -> float:
            return slope * p + intercept - float(self.region(np.array([p]))[1][0]) * (1.0 + margin)

        # the highest friction is a concave function of the load, so a line crosses it only once
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
        """Return the load [mm^2] at which the friction of one asperity has this slope."""
        return load_at_pressure(self.law.without_adhesion, 1.0 / slope, self.radii.low, tangent=True)


def at_load(law: Contact, load: FloatArray, radius: float) -> tuple[FloatArray, FloatArray]:
    """Return the indentation [mm] and friction [mm^2] of one asperity at rescaled loads, (k,) each.

    Above the largest load of the law, both are the values at the largest load.
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
    """Return s [-]: the exponent is smallest if a/R of small power caps is s^2 times a/R of large ones."""
    if radii.single:
        return 1.0
    n, k = power, math.sqrt(radii.low / radii.high)

    def slope(s: float) -> float:
        odd = n * k * (s ** (2.0 * n - 1.0) - s)
        return float((n - 1.0) * (k * k * s ** (2.0 * n) - 1.0) + odd)

    # at s = k^(-1/n) the first bracket is zero and the slope is positive
    return float(brentq(slope, 1.0, k ** (-1.0 / n)))


def depth_at_pressure(law: Contact, pressure: float, radius: float, *, tangent: bool = False) -> float:
    """Return the indentation [mm] at which P/A, or with `tangent` dP/dA, of one contact is `pressure` E*.

    P/A and dP/dA increase with the indentation. For a pressure [-] outside their range, the result is 0 or
    the largest indentation.
    """

    def excess(logarithm: float) -> float:
        found = contacts(law, np.array(math.exp(logarithm)), np.array(radius))
        if tangent:
            return math.log(found.stiffness / law.area_slope(found.contact_radius, radius) / pressure)
        # an adhesive contact has a negative load at small indentations
        return math.log(max(float(found.load), np.finfo(float).tiny) / found.area / pressure)

    most = min(float(law.largest_indentation(radius)), MOST_DEPTH * radius)
    if law.power is not None and law.power > 1.0:  # P/A ~ d^(1 - 1/n), and dP/dA = (n + 1)/2 P/A
        n = law.power
        unit = contacts(law, np.array(radius), np.array(radius))
        at_radius = float(unit.load / unit.area) * (0.5 * (n + 1.0) if tangent else 1.0)
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


def load_at_pressure(law: Contact, pressure: float, radius: float, *, tangent: bool = False) -> float:
    """Return the load P/E* [mm^2] of one contact at the indentation of `depth_at_pressure`."""
    depth = depth_at_pressure(law, pressure, radius, tangent=tangent)
    return float(contacts(law, np.array(depth), np.array(radius)).load)


def _rises(values: FloatArray) -> bool:
    """Return whether values do not decrease, up to rounding."""
    return bool((np.diff(values) >= -ROUNDING * np.abs(values[1:])).all())
