"""Bounds on the friction of all surfaces with N independent asperities made by tools of several shapes.

Let A_t(P) be the area of one contact of tool t at the load P, a concave function that begins
at 0.

1. *Friction.* A contact with a part of the load p has at least the same part of A_t(p), so that A0 is at
   least the least A_t(p) of all tools. By Jensen's inequality A0 is at most N H(p/N), where H is the least
   concave function above all A_t.
2. *Local exponent.* For elastic caps dP/dd = 2 a and A = pi a^2, and with e = d ln A/d ln P of each contact,
   ``d ln A0/d ln p = <x>_a <e/x>_(a^2)`` with x = P/(dP/dd) and the means weighted by a and a^2. By the
   inequality of Cauchy and Schwarz it is at least ``(sum a^(3/2) e^(1/2))^2/(sum a sum a^2)``, and so at
   least the smallest e times the smallest ``(sum a^(3/2))^2/(sum a sum a^2)`` of N contacts. Where this ratio
   is stationary, sqrt(a) is a root of a quadratic equation, so that the contacts have at most two sizes. It
   is smallest for one large contact among N - 1 small ones. New contacts raise the exponent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import minimize_scalar

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.inversion.bounds import Bounds, at_load
from metafem.inversion.limits import Limits
from metafem.inversion.tools.radii import Radii

# Loads at which the areas of all tools are compared: their number, and the smallest one over the largest.
# Straight lines between them are within 2e-5 of the concave functions, and the bound is raised by HULL.
LOADS, LEAST, HULL = 600, 1e-8, 1e-4


@dataclass(frozen=True)
class KitBounds(Bounds):
    """Bounds for tools of several shapes; `parts` are those of surfaces made by each of the tools alone."""

    parts: tuple[Bounds, ...] = ()

    @classmethod
    def of(cls, parts: tuple[Bounds, ...], law: Contact) -> KitBounds:
        """Return the bounds of tools with the bounds of each tool; `law` is that of all tools."""
        radii = [part.radii.low for part in parts]
        last = max(part.last for part in parts)
        return cls(law, Radii(min(radii), max(radii), None), parts[0].count, last, parts)

    def region(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return bounds of the friction at rescaled loads (k,), each (k,) [mm^2]."""
        low = self._areas(load).min(axis=0)
        grid = float(load.max()) * np.geomspace(LEAST, 1.0, LOADS)
        high = np.interp(load / self.count, *_concave(grid, self._areas(grid).max(axis=0)))
        return low, np.maximum(low, self.count * high * (1.0 + HULL))

    def _areas(self, load: FloatArray) -> FloatArray:
        """Return the areas of one contact of each tool, (t, k) [mm^2]."""
        return np.array([at_load(part.law.without_adhesion, load, part.radii.low)[1] for part in self.parts])

    @cached_property
    def convex(self) -> bool:
        """Whether the load of one contact of each tool is a convex function of its area."""
        return all(part.convex for part in self.parts)

    @cached_property
    def least_exponent(self) -> float:
        """Lower bound of the local exponent d ln A0/d ln p [-]; 0 if none is proven."""
        elastic = all(part.law.largest_order > 1 or part.law.adhesive for part in self.parts)
        if not (self.convex and elastic):
            return 0.0
        return min(part.least_exponent for part in self.parts) * least_ratio(self.count)

    def steepest(self, load: float, friction: float, margin: float = 0.0) -> float:
        """Return infinity: flat caps begin with an infinite slope."""
        return math.inf

    def highest_after(self, load: FloatArray, friction: FloatArray) -> FloatArray:
        """Return infinity, as no bound is proven, (k,)."""
        return np.full(len(load), math.inf)

    def largest_load(self, limits: Limits) -> float:
        """Return the load P/E* [mm^2] of N summits of maximum height with the plane at the base plane."""
        return max(part.largest_load(limits) for part in self.parts)

    def start_of_line(self, slope: float) -> float:
        """Return the load [mm^2] below which one asperity has more friction than ``slope p``."""
        return min(part.start_of_line(slope) for part in self.parts)

    def end_of_line(self, slope: float, intercept: float, margin: float = 0.0) -> float:
        """Return the load [mm^2] beyond which no law follows the line ``slope p + intercept``."""
        if not self.convex:
            return math.inf
        ends = [part.end_of_line(slope, intercept, margin) for part in self.parts]
        return self._crossing(max(ends), slope, intercept, margin)

    def tangent_load(self, slope: float) -> float:
        """Return the smallest load [mm^2] at which the friction of one asperity has this slope."""
        return min(part.tangent_load(slope) for part in self.parts)


def least_ratio(count: int) -> float:
    """Return the smallest ``(sum a^(3/2))^2/(sum a sum a^2)`` of at most `count` numbers a > 0.

    Examples
    --------
    >>> least_ratio(1), round(least_ratio(64), 3)
    (1.0, 0.577)
    """
    if count == 1:
        return 1.0
    q = count - 1.0

    def ratio(logarithm: float) -> float:
        a = math.exp(logarithm)
        return float((1.0 + q * a**1.5) ** 2 / ((1.0 + q * a) * (1.0 + q * a * a)))

    return float(minimize_scalar(ratio, bounds=(-2.0 * math.log(q + 1.0) - 2.0, 0.0), method="bounded").fun)


def _concave(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the corners of the least concave function above points (k,) and above the origin."""
    corners: list[tuple[float, float]] = [(0.0, 0.0)]
    for point in zip(x.tolist(), y.tolist(), strict=True):
        while len(corners) > 1 and _turns_up(corners[-2], corners[-1], point):
            corners.pop()
        corners.append(point)
    found = np.array(corners)
    return found[:, 0], found[:, 1]


def _turns_up(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    return (b[1] - a[1]) * (c[0] - b[0]) <= (c[1] - b[1]) * (b[0] - a[0])
