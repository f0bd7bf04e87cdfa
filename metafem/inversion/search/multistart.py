"""Heights, and radii where there is a choice, whose independent law is nearest to the target law."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.radii import Radii
from metafem.inversion.search.initial_guess import initial_heights, slowest_law
from metafem.inversion.search.levenberg_marquardt import Evaluate, Heights, ends, moved, search
from metafem.inversion.targets.wanted import Wanted
from metafem.models import Independent
from metafem.models.model import Sensitivity

# Misfit at which a search ends: height errors of 1 um change A0 by more than this.
GOAL = 6e-4

# Where an initial guess is deeper than allowed, guesses with these shares of the asperities that are too low
# are tried: at the foot they all enter the contact early, and fewer of them suffice.
SHARES_KEPT = (1.0, 0.75, 0.5, 0.25, 0.0)

# Random restarts with continuous radii, before the radii are rounded to tools.
LOOSE_RESTARTS = 4

# Random restarts with several tools for each restart with one, because the radii are unknown too (measured
# on 40 laws of random surfaces with radii of .1, .4 and 1.6 mm: all are recovered to .1 %; with 4 restarts
# one is not).
MIXED_RESTARTS = 10

# Probabilities, one of which is drawn for each random change, that an asperity gets a new radius.
REDRAWN = (0.0, 0.1, 0.3)


@dataclass(frozen=True, eq=False)
class LawSearch:
    """A target law, laws (k,) [mm^2] for the initial guesses, and the effort of the search.

    At most `count` asperities are used, with heights within `span` [mm]. The search ends at a misfit of
    `goal`.
    """

    wanted: Wanted
    laws: list[FloatArray]
    count: int
    span: float
    restarts: int
    rng: np.random.Generator
    goal: float = GOAL


def nearest_law(task: LawSearch, radii: Radii) -> tuple[FloatArray, FloatArray]:
    """Return heights, tallest first at 0, and their radii (n,) [mm] whose law is nearest.

    A single radius is used where it reaches the goal. Otherwise the search starts from radii that rise or
    fall with the depth, and then from random changes.
    """
    found = _with_one(task, radii.low, task.restarts) if radii.single else _with_several(task, radii)
    order = np.argsort(-found.height, kind="stable")
    return found.height[order] - found.height.max(), found.radius[order]


def independent_law(height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
    """Return the law of independent asperities and its gradient with respect to the heights."""
    return Independent().sensitivity_of(height, radius, load)


def law_of_heights(radius: float | FloatArray, load: FloatArray) -> Evaluate:
    """Return the law of independent asperities of given radii as a function of their heights."""

    def evaluate(height: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = independent_law(height, np.broadcast_to(radius, height.shape), load)
        return found.curve.area, found.gradient

    return evaluate


@dataclass(frozen=True, eq=False)
class _Found:
    height: FloatArray
    radius: FloatArray
    misfit: float


def _with_one(task: LawSearch, radius: float, restarts: int) -> _Found:
    load = task.wanted.load
    guesses = (initial_heights(load, law, np.full(len(law), radius), task.count)[0] for law in task.laws)
    starts = [start for guess in guesses for start in _with_fewer(guess, task.span)]
    space = Heights(task.span, task.count)
    found = search(law_of_heights(radius, load), starts, task.wanted, space, task.goal, restarts, task.rng)
    return _Found(found.unknowns, np.full(len(found.unknowns), radius), found.misfit)


def _with_fewer(height: FloatArray, span: float) -> list[FloatArray]:
    """Return heights, tallest first; where they are deeper than a span, also with fewer of those too low."""
    inside = int((height >= height[0] - span).sum())
    low = len(height) - inside
    numbers = dict.fromkeys(inside + round(share * low) for share in SHARES_KEPT)
    return [height[:number] for number in numbers]


def _with_several(task: LawSearch, radii: Radii) -> _Found:
    singles = []
    for radius in radii.tried.tolist():
        singles.append(_with_one(task, radius, 0))
        if singles[-1].misfit <= task.goal:
            return singles[-1]
    best = min(singles, key=lambda found: found.misfit)
    load = task.wanted.load
    rising, middle = np.geomspace(radii.low, radii.high, len(load)), len(load) // 2
    starts = [
        initial_heights(load, law, ramp, task.count) for law in task.laws for ramp in (rising, rising[::-1])
    ]
    starts += [slowest_law(load[middle], law[middle], radii, task.count) for law in task.laws]
    starts.append((best.height, best.radius))
    depth = float(Independent().curves(best.height, best.radius, load[-1:])[0].max())
    ranged = radii.tools is None
    tools = radii.extremes if ranged else radii
    between = Asperities(task.span, task.count, radii.between, depth)
    mixing = Asperities(task.span, task.count, tools, depth)
    relaxed = between.nearest(task, starts, LOOSE_RESTARTS)
    if ranged and relaxed.misfit <= task.goal:
        return relaxed
    rounded = (relaxed.height, tools.nearest(relaxed.radius))
    mixed = mixing.nearest(task, [rounded, *starts], MIXED_RESTARTS * task.restarts)
    found = [mixed, best]
    if ranged:  # the extreme radii can have a smaller misfit, and radii near them a smaller one still
        found.append(between.nearest(task, [(mixed.height, mixed.radius)], LOOSE_RESTARTS))
    return min(found, key=lambda each: each.misfit)


@dataclass(frozen=True)
class Asperities:
    """Heights (n,) and radii (n,) as one vector of lengths: heights, and ln R times a `depth` [mm].

    With the largest indentation as the depth, unit changes of both kinds change the law about equally.
    Tool radii change only in random changes. At most `most` asperities are used, with heights within
    `span`.
    """

    span: float
    most: int
    radii: Radii
    depth: float

    def joined(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the unknowns (2n,)."""
        return np.concatenate([height, self.depth * np.log(radius)])

    def split(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return heights and radii."""
        height, logarithm = np.split(unknowns, 2)
        return height, self.radii.nearest(np.exp(logarithm / self.depth))

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the nearest unknowns within the limits."""
        height, radius = self.split(unknowns)
        return self.joined(np.maximum(height, height.max() - self.span), radius)

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return the places of the tallest height and of those `span` below it."""
        return ends(unknowns[: len(unknowns) // 2], self.span)

    def changed(self, unknowns: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Return unknowns with some heights moved and some radii drawn anew."""
        height, radius = self.split(unknowns)
        height, source = moved(height, self.most, rng)
        anew = rng.random(len(height)) < rng.choice(REDRAWN)
        if self.radii.tools is None:
            drawn = np.exp(rng.uniform(math.log(self.radii.low), math.log(self.radii.high), len(height)))
        else:
            drawn = rng.choice(np.array(self.radii.tools), len(height))
        return self.joined(height, np.where(anew, drawn, radius[source]))

    def law(self, load: FloatArray) -> Evaluate:
        """Return the law of independent asperities and its gradient as a function of the unknowns.

        At a fixed load, ``R_i dA0/dR_i = pi R_i d_i - (2/3) sqrt(R_i) d_i^(3/2) sum pi R / sum 2 sqrt(R d)``.
        """

        def evaluate(unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
            height, radius = self.split(unknowns)
            found = independent_law(height, radius, load)
            depth = np.maximum(found.indentation, 0.0)
            root = np.sqrt(radius * depth)
            slope = math.pi * np.where(depth > 0.0, radius, 0.0).sum(axis=1) / (2.0 * root.sum(axis=1))
            by_radius = (math.pi * radius * depth - slope[:, None] * 2.0 / 3.0 * root * depth) / self.depth
            if self.radii.tools is not None:
                by_radius[:] = 0.0
            return found.curve.area, np.hstack([found.gradient, by_radius])

        return evaluate

    def nearest(self, task: LawSearch, starts: list[tuple[FloatArray, FloatArray]], restarts: int) -> _Found:
        """Search from heights and radii."""
        unknowns = [self.joined(height, radius) for height, radius in starts]
        law = self.law(task.wanted.load)
        found = search(law, unknowns, task.wanted, self, task.goal, restarts, task.rng)
        return _Found(*self.split(found.unknowns), found.misfit)
