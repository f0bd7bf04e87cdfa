"""Search for independent asperities whose law is nearest to a target, by heights and possibly radii."""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.inversion.search.asperities import OfRadii, beyond
from metafem.inversion.search.initial_guess import initial_heights, slowest_law
from metafem.inversion.search.levenberg_marquardt import search
from metafem.inversion.search.spaces import Heights, LateResidual, Residual
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.tools.radii import Radii
from metafem.models import Independent
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem

# Misfit at which a search ends: height errors of 1 um change A0 by more than this.
GOAL = 6e-4

# If some asperities of an initial guess are lower than allowed, guesses with these fractions of them are
# tried. Raised to the foot, they come into contact earlier, and fewer of them are enough.
LOW_FRACTIONS = (1.0, 0.75, 0.5, 0.25, 0.0)

# Number of restarts with continuous radii, before the radii are rounded to tools.
CONTINUOUS_RESTARTS = 4

# With several tools the number of restarts is multiplied by this factor, because the radii are also unknown.
# (Measured for 40 laws of random surfaces with radii of .1, .4 and 1.6 mm: all laws are recovered to .1 %;
# with a factor of 4 one law is not.)
MIXED_RESTARTS = 10

# Misfit [-] of a law, and the heights and radii (n,) [mm] that have this law.
Found = tuple[float, FloatArray, FloatArray]


def _tallest_first(found: Found) -> tuple[FloatArray, FloatArray]:
    _, height, radius = found
    order = np.argsort(-height, kind="stable")
    return height[order] - height.max(), radius[order]


def residual_of_heights(model: Independent, radius: Any, law: TargetLaw) -> Residual:
    """Return the residual of independent asperities with fixed radii as a function of their heights."""

    def residual(height: FloatArray) -> LateResidual:
        try:
            found = model.sensitivity_of(height, np.broadcast_to(radius, height.shape), law.load)
        except InvalidInput:
            return beyond(law.load, height)
        return law.late_residual(found.curve.area, lambda: found.gradient)

    return residual


def residual_of_surface(model: Independent, surface: Surface, law: TargetLaw) -> Residual:
    """Return the residual of independent asperities of a surface as a function of their heights."""

    def residual(height: FloatArray) -> LateResidual:
        try:
            found = model.sensitivity(surface, law.load, height)
        except InvalidInput:
            return beyond(law.load, height)
        return law.late_residual(found.curve.area, lambda: found.gradient)

    return residual


@dataclass(frozen=True, eq=False)
class LawSearch:
    """Search for the independent asperities of a problem whose law is nearest to the target `law`.

    The laws of the initial guesses are near the frictions `guesses`, (k,) [mm^2] each. The search ends at a
    misfit of `goal`.
    """

    problem: Problem
    law: TargetLaw
    guesses: list[FloatArray]
    restarts: int
    rng: np.random.Generator
    goal: float = GOAL

    def nearest(self, radii: Radii) -> tuple[FloatArray, FloatArray]:
        """Return heights, with the tallest first and equal to 0, and their radii, (n,) each [mm].

        If a single radius reaches the goal, all asperities have this radius. Otherwise several radii are
        used. Their initial guesses have radii that increase or decrease with the depth, and random changes
        follow.
        """
        count, span, options = self.problem.count, self.problem.limits.span, self.problem.options
        singles: list[Found] = []
        for radius in radii.tried.tolist():
            residual, guesses = self._of_one_radius(radius)
            space, restarts = Heights(span, count), self.restarts if radii.single else 0
            single = search(residual, guesses, space, self.goal, restarts, self.rng, options)
            singles.append((single.misfit, single.unknowns, np.full(len(single.unknowns), radius)))
            if radii.single or singles[-1][0] <= self.goal:
                return _tallest_first(singles[-1])
        best = min(singles, key=itemgetter(0))
        model, load = self.problem.independent, self.law.load
        rising, middle = np.geomspace(radii.low, radii.high, len(load)), len(load) // 2
        starts = [
            initial_heights(model.contact, load, law, ramp, count)[:2]
            for law in self.guesses
            for ramp in (rising, rising[::-1])
        ]
        if model.contact.power is not None:
            point = model.contact, load[middle]
            starts += [slowest_law(*point, law[middle], radii, count) for law in self.guesses]
        starts.append(best[1:])
        depth = float(model.curve_of(*best[1:], load[-1:]).approach[0])
        ranged = radii.tools is None
        tools = radii.extremes if ranged else radii
        between, mixing, stepped = (
            OfRadii(span, count, radii=part, depth=depth) for part in (radii.between, tools, radii)
        )
        relaxed = self._within(between, starts, CONTINUOUS_RESTARTS)
        if ranged and relaxed[0] <= self.goal:
            relaxed = self._on_steps(stepped, relaxed)
            if relaxed[0] <= self.goal:
                return _tallest_first(relaxed)
        rounded = (relaxed[1], tools.nearest(relaxed[2]))
        mixed = self._within(mixing, [rounded, *starts], MIXED_RESTARTS * self.restarts)
        found = [mixed, best]
        if ranged:  # extreme radii can have a smaller misfit, and radii near them an even smaller misfit
            free = self._within(between, [mixed[1:]], CONTINUOUS_RESTARTS)
            found += [self._on_steps(stepped, each) for each in (free, relaxed)]
        return _tallest_first(min(found, key=itemgetter(0)))

    def _of_one_radius(self, radius: float) -> tuple[Residual, list[FloatArray]]:
        """Return the residual as a function of heights of one radius, and the initial guesses (n,) [mm]."""
        model, span, starts = self.problem.independent, self.problem.limits.span, []
        for law in self.guesses:
            radii = np.full(len(law), radius)
            height, _, levels = initial_heights(model.contact, self.law.load, law, radii, self.problem.count)
            inside = int((height >= height[0] - span).sum())
            # if heights are deeper than the span, further guesses have fewer of these heights
            numbers = dict.fromkeys(inside + round(part * (len(height) - inside)) for part in LOW_FRACTIONS)
            starts += [height[:number] for number in numbers]
            few = levels.size > 0 and np.ptp(levels) <= span
            if few and self._misfit(levels, radius) < self._misfit(height, radius):
                starts.append(levels)
        return residual_of_heights(model, radius, self.law), starts

    def _misfit(self, height: FloatArray, radius: float) -> float:
        """Return the misfit of heights of one radius; infinite beyond the range of the contact law."""
        try:
            found = self.problem.independent.curve_of(height, np.full(len(height), radius), self.law.load)
        except InvalidInput:
            return math.inf
        return self.law.misfit(found.area)

    def _within(self, space: OfRadii, starts: list[tuple[FloatArray, FloatArray]], restarts: int) -> Found:
        """Return the misfit, heights and radii found by a search from initial heights and radii."""
        unknowns = [space.joined(*start) for start in starts]
        residual = space.residual(self.problem.independent, self.law)
        found = search(residual, unknowns, space, self.goal, restarts, self.rng, self.problem.options)
        return found.misfit, *space.split(found.unknowns)

    def _on_steps(self, stepped: OfRadii, found: Found) -> Found:
        """Return the asperities with their radii on the steps of a range, after a new search for heights."""
        return found if stepped.radii.continuous else self._within(stepped, [found[1:]], 0)
