"""Densities with two slopes and a crossover load (eq. S8), and the range of possible crossover loads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from metafem.errors import Infeasible
from metafem.inversion.bounds import at_load
from metafem.inversion.feasibility import INSIDE
from metafem.inversion.height_density import TIGHTEST, ExponentialDensity
from metafem.inversion.strategies.mixture import Mixture

if TYPE_CHECKING:
    from metafem.inversion.targets.straight import BilinearLaw

# Number of evenly spaced crossover loads in the search for the possible range, and number of bisections of
# each end of the range, to a ten-thousandth of the last load with the first slope.
TRIED, BISECTIONS = 15, 10


@dataclass(frozen=True)
class Crossing:
    """Densities with the first slope of `plain` up to a crossover load [mm^2].

    The densities differ in the depth of the crossover height below the top [mm]. P_c is proportional to the
    weight u, so the crossover load determines u for each depth. The second slope then determines the depth.
    """

    plain: ExponentialDensity
    mixture: Mixture
    load: float

    @cached_property
    def full_load(self) -> float:
        """Load [mm^2] at which the plane reaches the foot of the density `plain`."""
        return self._load_of(self.plain.max_height)

    @cached_property
    def least_depth(self) -> float:
        """Smallest depth [mm] of a crossover height at which the asperities can carry the crossover load.

        At this depth each asperity carries an equal part of the load if all of them have the maximum height.
        """
        each = np.array([self.load / self.mixture.carrying])
        return float(at_load(self.mixture.law, each, self.mixture.radius)[0][0])

    @property
    def possible(self) -> bool:
        """Whether `plain` reaches the crossover load, and double precision resolves its load there."""
        return self.load < self.full_load and self._load_of(self.least_depth) > 0.0

    @cached_property
    def depths(self) -> tuple[float, float]:
        """Smallest and largest depth [mm] for which each branch has at least half an asperity."""
        shallow, deep = self.least_depth, self.plain.max_height * (1.0 - INSIDE)
        ends = []
        for share in (1.0 - 0.5 / self.mixture.count, 0.5 / self.mixture.count):
            if self._upper_mass(deep) >= share:
                ends.append(deep)
            elif self._upper_mass(shallow) <= share:
                ends.append(shallow)
            else:  # the upper mass decreases from the smallest depth on
                ends.append(self._root(self._upper_mass, share, shallow, deep))
        return ends[0], ends[1]

    @cached_property
    def second_slopes(self) -> tuple[float, float]:
        """Smallest and largest slope [-] of the second branch; none is possible if they do not increase."""
        low, high = (self._second_slope(depth) for depth in self.depths)
        return low, high

    def has(self, second: float) -> bool:
        """Return whether a second slope is possible."""
        return self.possible and self.second_slopes[0] <= second <= self.second_slopes[1]

    def density(self, depth: float) -> ExponentialDensity:
        """Return the density with the crossover height at a depth [mm] below the top."""
        plain = self.plain
        middle = plain.max_height - depth
        return ExponentialDensity(plain.scale, plain.max_height, middle, self._weight(depth))

    def density_of(self, second: float) -> ExponentialDensity:
        """Return the density with a second slope, by solving eq. S8 for h_c."""
        return self.density(self._root(self._second_slope, second, *self.depths))

    def range_of(self, second: float) -> tuple[float, float] | None:
        """Return the smallest and largest crossover load [mm^2] that allow a second slope, or None."""
        loads = self.full_load * np.arange(TRIED + 2) / (TRIED + 1)
        found = [i for i in range(1, TRIED + 1) if replace(self, load=float(loads[i])).has(second)]
        if not found:
            return None
        ends = []
        for inside, outside in (loads[found[0] - 1 : found[0] + 1][::-1], loads[found[-1] : found[-1] + 2]):
            for _ in range(BISECTIONS):
                middle = 0.5 * (inside + outside)
                good = replace(self, load=float(middle)).has(second)
                inside, outside = (middle, outside) if good else (inside, middle)
            ends.append(float(inside))
        return ends[0], ends[1]

    def _root(self, function: Callable[[float], float], value: float, low: float, high: float) -> float:
        """Return the depth [mm] between `low` and `high` at which a function of the depth has a value."""
        xtol = TIGHTEST * self.plain.max_height
        return float(brentq(lambda depth: function(depth) - value, low, high, xtol=xtol, rtol=TIGHTEST))

    def _load_of(self, depth: float) -> float:
        return float(self.plain.rescaled_load(self.plain.max_height - depth, *self.mixture.asperities))

    def _weight(self, depth: float) -> float:
        return self.load / self._load_of(depth)  # eq. S8, P_c/E*

    def _upper_mass(self, depth: float) -> float:
        top = self.plain.max_height
        return self._weight(depth) * float(self.plain.mass(top - depth, top))

    def _second_slope(self, depth: float) -> float:
        return self.density(depth).asymptotic_slopes(self.mixture.radius, self.mixture.law)[1]  # eq. S8, m_2


def two_branches(target: BilinearLaw, plain: ExponentialDensity, mixture: Mixture) -> ExponentialDensity:
    """Return the density with the slopes and crossover load of a target, or raise Infeasible.

    `plain` is the truncated exponential density with the first slope.
    """
    crossing = Crossing(plain, mixture, target.crossover_load)
    if crossing.has(target.slopes[1]):
        return crossing.density_of(target.slopes[1])
    wording, first = target.wording, target.wording.slopes(target.slopes[0])
    if crossing.load < crossing.full_load and not crossing.possible:
        raise Infeasible(
            f"{first} puts so few asperities near the top that double precision resolves no load at the "
            f"crossover; lower the {wording.name()}"
        )
    if crossing.possible and crossing.second_slopes[0] < crossing.second_slopes[1]:
        raise _other_slope(target, crossing)
    given, end = wording.loads(crossing.load), wording.loads(crossing.full_load)
    reason = (
        f"with crossover_load = {given} one of the branches has fewer than 1 of {mixture.count} asperities; "
        f"the law of {first} ends at {end}"
        if crossing.possible
        else f"crossover_load = {given} is outside the law of {first}, which ends at {end} where the plane "
        "reaches the lowest asperity"
    )
    raise _other_crossover(target, crossing, reason)


def _other_slope(target: BilinearLaw, crossing: Crossing) -> Infeasible:
    """Return the error for an impossible second slope; it states possible slopes and crossover loads."""
    (first, second), wording, (low, high) = target.slopes, target.wording, crossing.second_slopes
    ends = crossing.range_of(second)
    loads = f"; or, with these slopes, crossover_load from {wording.inside(*ends)}" if ends else ""
    inside = min(max(second, low * (1.0 + INSIDE)), high * (1.0 - INSIDE))
    return Infeasible(
        f"{wording.keys[1]}[1] = {wording.coefficient(second):g} cannot follow a branch of "
        f"{wording.slopes(first)} up to {wording.loads(crossing.load)} with {crossing.mixture.count} "
        f"asperities: the second {wording.name()} can be from {_slopes(target, low, high)}{loads}",
        replace(target, slopes=(first, inside)),
    )


def _other_crossover(target: BilinearLaw, crossing: Crossing, reason: str) -> Infeasible:
    """Return the error for a crossover load that allows no second slope; it states possible loads."""
    (first, second), wording = target.slopes, target.wording
    ends, half = crossing.range_of(second), replace(crossing, load=0.5 * crossing.full_load)
    if ends:
        load = min(max(crossing.load, ends[0]), ends[1])
        words = f"with these slopes it can be from {wording.inside(*ends)}"
        return Infeasible(f"{reason}; {words}", replace(target, crossover_load=load))
    nearest = replace(target, slopes=(first, first / 0.75), crossover_load=half.load)
    if not (half.possible and half.second_slopes[0] < half.second_slopes[1]):
        return Infeasible(f"{reason}; use more asperities")
    words = f"it can be {wording.loads(half.load)}, and the second {wording.name()} there from"
    return Infeasible(f"{reason}; {words} {_slopes(target, *half.second_slopes)}", nearest)


def _slopes(target: BilinearLaw, low: float, high: float) -> str:
    """Return a range of slopes in words, with its ends rounded inwards."""
    wording = target.wording
    return f"{wording.slope_bound(low, up=True)} to {wording.slope_bound(high, up=False)}"
