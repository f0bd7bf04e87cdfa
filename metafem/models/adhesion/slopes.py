"""Adhesive contacts of caps other than paraboloids on the slope of the field; loads are P/E* [mm^2].

The head of `_kernels.contact.tabulated` states the energy of a circular contact of any radius a on a slope g.
Let p_cap be the load of the cap at the radius a, a0 the radius at which the cap has this load without extra
curvature, and ``r = 2 a0/D'(a0)``. As a function of the load p the complementary energy is

    (p + 2 int_0^a D ds)^2/(4 a) - int_0^a D^2 ds + pi w a^2 - Q g^2/2,    Q = 4/3 a0^3 + r (p - p_cap),

where the extra curvature k is part of D, and ``dQ/dp_cap = (p - p_cap) dr/dp_cap``. The edge is stationary
if ``p = p_cap - 2 a e``, where e = s + t, with s as in `JKR` and ``t = a^2 D' g^2 dr/dp_cap`` to second order
in g. The slope thus changes the decrease e of the indentation. For paraboloids r = R, and t = 0. The other
equations are the derivatives of the energy: the indentation ``D - e - r g^2/2``, the moment Q g on the slope,
and the second moment of the pressure. Terms in g^4 are omitted. Without adhesion these are the equations of
order 3 in `_kernels.coupling`, with the areas of second order in g.

On steep slopes ``t/(1 + |t| a/(2 p_cap))`` replaces t. Otherwise the load of a flat summit, which increases
with g^2, would have a minimum at a small radius, and light contacts would have no equilibrium.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import JKR

# Maximum number of Newton steps, sufficient to reach rounding from a relative error of a few hundredths.
MOST_STEPS = 20

# Relative step of finite differences over five points. Their errors, about the fourth power of the step and
# the rounding error divided by the square of the step, are multiplied by g^2.
STEP = 1e-3
POINTS = 1.0 + STEP * np.arange(-2.0, 3.0)
FIRST = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * STEP)
SECOND = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / (12.0 * STEP**2)


class OnSlope(NamedTuple):
    """Values of the law of contacts on a slope, or their derivatives; arrays (m,)."""

    load: FloatArray  # p [mm^2]
    moment: FloatArray  # M [mm^4]
    tilt: FloatArray  # Q [mm^3]
    turn: FloatArray  # r [mm]
    indentation: FloatArray  # d without -r g^2/2 [mm]


class Slopes:
    """Contacts of radii a [mm] with extra curvatures k [1/mm] on slopes whose squares are `steepness`."""

    def __init__(
        self, law: JKR, radius: FloatArray, a: FloatArray, k: FloatArray, steepness: FloatArray
    ) -> None:
        self.law, self.radius, self.a, self.k, self.steepness = law, radius, a, k, steepness
        self.carried = law.cap.load(a, radius, k)
        self.slope = law.profile_slope(a, radius, k)  # D'
        own = self._radius_at(self.carried)
        self.own = own
        turns = np.array([law.cap.area_slope(own * point, radius) / np.pi for point in POINTS])
        self.turn = turns[2]
        # dr/dp_cap and its derivative, with dp_cap/da0 = 4 a0^2/r
        bend, curl = (weight @ turns for weight in (FIRST, SECOND))  # a0 dr/da0, a0^2 d2r/da0^2
        self.turning = bend * self.turn / (4.0 * own**3)
        self.twisting = (curl + bend * (bend / self.turn - 2.0)) * self.turn**2 / (16.0 * own**6)
        self.steep = a**2 * self.slope * self.turning * steepness
        self.limit = 1.0 + 0.5 * a * np.abs(self.steep) / self.carried
        self.raised = self.steep / self.limit  # t
        self.deficit = law.deficit(a) + self.raised  # e

    def _radius_at(self, load: FloatArray) -> FloatArray:
        """Return the radii [mm] at which the caps have loads [mm^2] without extra curvature."""
        law, own = self.law, self.a
        for _ in range(MOST_STEPS):
            rate = 2.0 * own * law.profile_slope(own, self.radius)
            step = (law.cap.load(own, self.radius) - load) / rate
            own = own - step
            if (np.abs(step) <= 4.0 * np.finfo(np.float64).eps * own).all():
                break
        return own

    @property
    def within(self) -> bool:
        """Whether each contact moves down the slope by at most its radius.

        For larger shifts the expansion about the summit fails. The shift is that of a contact whose radius
        does not depend on the slope.
        """
        flat = self._radius_at(self.carried - 2.0 * self.a * self.raised)
        slope = self.law.profile_slope(flat, self.radius)
        return bool((4.0 * self.steepness <= slope**2).all())

    @property
    def values(self) -> OnSlope:
        """Values at these radii."""
        a, lost = self.a, 2.0 * self.a * self.deficit  # p_cap - p
        moment = self.law.cap.second_moment(a, self.radius, self.k)
        moment -= 2.0 / 3.0 * a**2 * lost * (1.0 - 2.0 * self.raised / (a * self.slope))
        depth = self.law.cap.indentation(a, self.radius, self.k)
        tilt = 4.0 / 3.0 * self.own**3 - self.turn * lost
        return OnSlope(self.carried - lost, moment, tilt, self.turn, depth - self.deficit)

    def derivatives(self) -> tuple[OnSlope, OnSlope, OnSlope]:
        """Return the derivatives of the values with respect to a, k and g^2."""
        a, slope, s = self.a, self.slope, self.law.deficit(self.a)
        steps = zip(FIRST, POINTS, strict=True)
        bend = sum(w * self.law.profile_slope(a * t, self.radius, self.k) for w, t in steps)  # a D''
        # derivatives of p_cap, D and M of the cap, D' and s by each variable; lastly that of g^2
        by_radius = self._chain(
            (2.0 * a * slope, slope, 4.0 / 3.0 * a**3 * slope, bend / a, 0.5 * s / a, 1.0, 0.0)
        )
        by_curvature = self._chain((4.0 / 3.0 * a**3, a**2, 8.0 / 15.0 * a**5, 2.0 * a, 0.0, 0.0, 0.0))
        return by_radius, by_curvature, self._chain((0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))

    def _chain(self, rates: tuple[FloatArray | float, ...]) -> OnSlope:
        """Return derivatives from those of p_cap, D and M of the cap, D', s, a and g^2."""
        carried, depth, moment, slope, s, da, steepness = rates
        a, e, limit = self.a, self.deficit, self.limit
        wide, flat = da / a, slope / self.slope
        # t before its limit, and t
        steep = self.steep * (2.0 * wide + flat) + a**2 * self.slope * (
            self.twisting * carried * self.steepness + self.turning * steepness
        )
        raised = (steep - self.steep * (limit - 1.0) * (wide - carried / self.carried)) / limit**2
        deficit = s + raised
        lost = 2.0 * (da * e + a * deficit)
        part = 2.0 / (a * self.slope)
        share, less = 1.0 - part * self.raised, part * (self.raised * (wide + flat) - raised)
        by_moment = moment - 4.0 / 3.0 * a**2 * (3.0 * da * e * share + a * (deficit * share + e * less))
        turn = self.turning * carried
        tilt = self.turn * carried - 2.0 * a * e * turn - self.turn * lost
        return OnSlope(carried - lost, by_moment, tilt, turn, depth - deficit)
