"""Bounds on the friction of all surfaces with N independent asperities made by given tools.

The law P(A) of one contact and its derivatives with respect to the indentation d determine which bounds hold:

1. *P is convex in A.* For elastic caps dP/dA = D'/pi, so this holds if D(a) is convex: for powers of at least
   1 and for the sphere. The area A_t(P) of one contact of tool t is then a concave function of its load that
   begins at 0. At a fixed load p = P/E* a contact with a part of the load has at least the same part of
   A_t(p), so that A0 is at least the least A_t(p) of all tools. By Jensen's inequality A0 is at most
   N H(p/N), where H is the least concave function above all A_t.
2. *P is also log-concave in d* (elastic caps: dP/dd = 2 a, and P/a increases). Chebyshev's sum inequality
   then gives a lower bound for the local exponent ``d ln A0/d ln p`` of asperities of one tool: the smallest
   exponent of a single contact up to that load, which is 2/(n + 1) for a power cap rho^n. New contacts raise
   the exponent.
3. *Power caps of several radii.* The exponent is ``2/(n + 1) <x^(n-1)> <x^(1-n)>`` with x = a/R and the
   means weighted by R^2 x^2 and R x. By Jensen's inequality it is smallest if all contacts of one radius
   have the same x, and the minimum is at the extreme radii R1 and R2. The surface then has large caps with
   a/R = x and small caps with a/R = s^2 x. With k^2 = R1/R2 and ``1/(k s)^3`` small caps for each large cap,
   the exponent is ``2/(n + 1) ((k s^n + s^(1-n))/(1 + k s))^2``. Its minimum is at the root s > 1 of
   ``(n - 1) k^2 s^(2n) + n k s^(2n-1) - n k s - (n - 1)``.
4. *Steepest slope.* For power caps with n <= 2, Hoelder's inequality between the sums of a, a^2 and a^(n+1)
   gives ``dA0/dp <= 2/(n + 1) K p/A0^n`` with ``K p^2 = (N A1(p/N))^(n+1)``, so A0^(n+1) - K p^2 cannot rise
   along a law.

For laws other than power laws, these conditions are checked at CONTACTS indentations up to the largest load.
With adhesion a contact has an area at zero load, and no bound is used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.optimize import brentq, linprog

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.law import Contacts
from metafem.inversion.limits import Limits
from metafem.inversion.target_law import TargetLaw
from metafem.inversion.tools import Tools
from metafem.models import Independent

# A value within this relative distance of a bound counts as equal to the bound. Otherwise rounding could
# exclude values that were computed from a surface.
ROUNDING = 1e-9

# Number of logarithmically spaced indentations at which a law is checked, and the ratio of the smallest
# indentation to the largest.
CONTACTS, SHALLOWEST = 400, 1e-12

# Loads at which the areas of several tools are compared: their number, and the smallest one over the largest.
# The tangents there are within 2e-5 of those of the concave function, and the bound is raised by HULL.
LOADS, LEAST, HULL = 600, 1e-8, 1e-4


@dataclass(frozen=True, eq=False)
class Bounds:
    """Proven bounds on the friction of at most `count` independent asperities up to a load `last` [mm^2].

    Without a proof the lower bound is 0 and the upper bound is infinite.
    """

    tools: Tools
    count: int
    last: float

    def region(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and the highest friction of `count` asperities at loads, (k,) each [mm^2]."""
        low, grid = self._areas(load).min(axis=0), np.geomspace(LEAST, 1.0, LOADS) * load.max() / self.count
        areas, each = self._areas(grid), load / self.count
        largest = np.unique(areas.argmax(axis=0))
        if len(largest) == 1:  # one tool has the largest area at all loads
            return low, self.count * self._areas(each)[largest[0]]
        slope = np.gradient(areas.max(axis=0), grid)[:, None]
        intercept = (areas.max(axis=0) - slope * grid).max(axis=1)[:, None]  # of the tangents from above
        high = (intercept + slope * each).min(axis=0)
        return low, np.maximum(low, self.count * high * (1.0 + HULL))

    def friction(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and the highest friction that is proven at loads (k,), each (k,) [mm^2]."""
        if self.convex:
            return self.region(load)
        return np.zeros(len(load)), np.full(len(load), math.inf)

    def _areas(self, load: FloatArray) -> FloatArray:
        """Return the areas of one contact of each tool, (t, k) [mm^2]."""
        return np.array([at_load(law.without_adhesion, load, summit)[1] for law, summit in self.tools.laws])

    @cached_property
    def convex(self) -> bool:
        """Whether the load of one contact is a convex function of its area, for all tools."""
        if self.tools.law.adhesive:
            return False
        if self._power is not None:
            return self._power >= 1.0
        return all(_rises(found.stiffness / growth) for found, growth in self._examined)

    @cached_property
    def _power(self) -> float | None:
        """Exponent n if all caps are power caps of one exponent, otherwise None."""
        powers = {law.power for law, _ in self.tools.laws}
        return powers.pop() if len(powers) == 1 else None

    @cached_property
    def _examined(self) -> list[tuple[Contacts, FloatArray]]:
        """Contacts of each tool up to the last load, and their dA/dd, (CONTACTS,) [mm]."""
        every = []
        for law, summit in self.tools.laws:
            deepest, _ = at_load(law.without_adhesion, np.array([self.last]), summit)
            depth, size = deepest * np.geomspace(SHALLOWEST, 1.0, CONTACTS), np.full(CONTACTS, summit)
            found = law.without_adhesion.contacts(depth, size)
            every.append((found, law.without_adhesion.area_slope(found.contact_radius, size)))
        return every

    @cached_property
    def least_exponent(self) -> float:
        """Lower bound of the local exponent d ln A0/d ln p [-]; 0 if none is proven."""
        if not self.convex:
            return 0.0
        n = self._power
        if n is not None:
            sizes = [summit for _, summit in self.tools.laws]
            k, s = math.sqrt(min(sizes) / max(sizes)), relative_depth(min(sizes) / max(sizes), n)
            return float(2.0 / (n + 1.0) * ((s ** (1.0 - n) + k * s**n) / (1.0 + k * s)) ** 2)
        (found, growth), *others = self._examined
        elastic = self.tools.laws[0][0].largest_order > 1
        if others or not elastic or not _rises(found.load / found.stiffness):
            return 0.0
        return float((found.load * growth / (found.stiffness * found.area)).min())

    def highest_after(self, load: FloatArray, friction: FloatArray) -> FloatArray:
        """Return the highest friction at increasing loads from the friction at smaller loads, (k,) [mm^2]."""
        n = self._power
        if n is None or n > 2.0 or not self.convex:
            return np.full(len(load), math.inf)
        rise = self.region(load)[1] ** (n + 1.0)
        least = np.minimum.accumulate(np.insert(friction ** (n + 1.0) - rise, 0, 0.0))[:-1]
        return np.asarray((least + rise) ** (1.0 / (n + 1.0)))

    def largest_load(self, limits: Limits) -> float:
        """Return the load P/E* [mm^2] of N summits of maximum height with the plane at the base plane."""
        most = 0.0
        for law, summit in self.tools.laws:
            depth = min(limits.top, float(law.without_adhesion.largest_indentation(summit)))
            found = law.without_adhesion.contacts(np.array(depth), np.array(summit))
            most = max(most, float(found.load))
        return self.count * most


def at_load(law: Contact, load: FloatArray, radius: float) -> tuple[FloatArray, FloatArray]:
    """Return the indentation [mm] and friction [mm^2] of one asperity at rescaled loads, (k,) each.

    Above the largest load of the law, both are the values at the largest load.
    """
    n = law.power
    if n is None:
        deepest = np.array(law.largest_indentation(radius))
        if np.isfinite(deepest):
            load = np.minimum(load, law.contacts(deepest, np.array(radius)).load)
        rising, place = np.unique(load, return_inverse=True)
        alone = Independent(contact=law).curve_of(np.zeros(1), np.array([radius]), rising)
        return alone.approach[place], alone.area[place]
    unit = law.contacts(np.ones(1), np.array([radius]))
    relative = load / unit.load
    return relative ** (n / (n + 1.0)), unit.area * relative ** (2.0 / (n + 1.0))


def relative_depth(ratio: float, power: float = 2.0) -> float:
    """Return s [-]: the exponent is smallest if a/R of small power caps is s^2 times a/R of large ones.

    ratio: smallest over largest radius [-].
    """
    if ratio == 1.0:
        return 1.0
    n, k = power, math.sqrt(ratio)

    def slope(s: float) -> float:
        odd = n * k * (s ** (2.0 * n - 1.0) - s)
        return float((n - 1.0) * (k * k * s ** (2.0 * n) - 1.0) + odd)

    # at s = k^(-1/n) the first bracket is zero and the slope is positive
    return float(brentq(slope, 1.0, k ** (-1.0 / n)))


def _rises(values: FloatArray) -> bool:
    """Return whether values do not decrease, up to rounding."""
    return bool((np.diff(values) >= -ROUNDING * np.abs(values[1:])).all())


@lru_cache(maxsize=8)  # a design asks several times for the same law
def nearest_law(law: TargetLaw, bounds: Bounds, margin: float = 0.0) -> tuple[float, FloatArray]:
    """Return the largest relative distance [-] of a target from the nearest law in the bounds, and that law.

    The frictions F_k, the free parameters c and the distances s_k solve the linear program: minimise the sum
    of s where ``lower + free c - s w <= F <= upper + free c + s w``, F lies within the bounds, and F/p^b does
    not fall with the least local exponent b. w is the target, or the middle of the bounds if it has free
    parameters. Few s differ from 0, so that few points move. A law without free parameters must also not rise
    faster than N asperities that all come into contact. All bounds are wider by a relative margin.
    """
    load, target = law.load, law.middle
    if not bounds.convex:
        return 0.0, target
    low, high = bounds.friction(load)
    low, high = low * (1.0 - margin), high * (1.0 + margin)
    w = np.sqrt(low * high) if law.is_open else target
    power = w / load**bounds.least_exponent
    rise = power[1:] / power[:-1]
    distance, friction = 0.0, target
    if law.is_open or not ((low <= w) & (w <= high)).all() or (rise < 1.0 - margin).any():
        k, q = law.free.shape
        one, free, nothing = np.eye(k), law.free / w[:, None], np.zeros((k - 1, k + q))
        rising = (1.0 - margin) * one[:-1] - one[1:] * rise[:, None]
        rows = np.block([[one, -free, -one], [-one, free, -one], [rising, nothing]])
        right = np.concatenate([law.upper / w, -law.lower / w, np.zeros(k - 1)])
        limits = [*zip(low / w, high / w, strict=True), *[(None, None)] * q, *[(0.0, None)] * k]
        found = linprog(np.append(np.zeros(k + q), np.ones(k)), rows, right, bounds=limits, method="highs")
        if found.x is None:  # the bounds exclude each other by rounding
            return 0.0, target
        distance, friction = float(found.x[-k:].max()), found.x[:k] * w
    if not law.is_open:
        jump = bounds.highest_after(load, friction if law.is_band else target) * (1.0 + margin)
        distance = max(distance, float((np.minimum(friction, law.lower) / jump).max()) - 1.0)
        friction = np.minimum(friction, bounds.highest_after(load, friction))
    return distance, friction
