"""Heights, and radii where there is a choice, whose independent law is nearest to a wanted one."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion.radii import Radii
from metafem.inversion.search.initial_guess import march, slowest
from metafem.inversion.search.levenberg_marquardt import Evaluate, Heights, moved, search
from metafem.inversion.targets.wanted import Wanted
from metafem.models import Independent
from metafem.models.model import Sensitivity
from metafem.surface import Material, Surface

# Misfit at which a search ends: heights of 1 um of error change A0 by more.
GOAL = 6e-4

# Random restarts over any radii before they are rounded to tools.
LOOSE_RESTARTS = 4

# Random restarts with several tools, to each with one: they have to find the tools as well (measured: of
# 40 laws of random surfaces with radii of .1, .4 and 1.6 mm all are recovered to .1 %, with 4 all but one).
MIXED_RESTARTS = 10

# A random change deals a new radius to each asperity with one of these probabilities.
REDEALT = (0.0, 0.1, 0.3)


@dataclass(frozen=True, eq=False)
class Quest:
    """A law that is wanted, laws (k,) each [mm^2] to start from, and how long to seek the nearest one.

    There may be `count` asperities, of heights within `span` [mm]; a misfit of `goal` is enough.
    """

    wanted: Wanted
    laws: list[FloatArray]
    count: int
    span: float
    restarts: int
    rng: np.random.Generator
    goal: float = GOAL


def nearest_law(quest: Quest, radii: Radii) -> tuple[FloatArray, FloatArray]:
    """Return heights, tallest first at 0, and their radii (n,) [mm] whose law is nearest.

    One radius that reaches the goal is preferred; else radii that rise and fall with the depth are tried,
    then random ones.
    """
    found = _with_one(quest, radii.low, quest.restarts) if radii.single else _with_several(quest, radii)
    order = np.argsort(-found.height, kind="stable")
    return found.height[order] - found.height.max(), found.radius[order]


def independent_law(height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
    """Return the law of independent asperities and its gradient by the heights."""
    surface = Surface.square_lattice(height, (1, len(height)), radius=radius, material=Material(1.0))
    return Independent().sensitivity(surface, load)


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


def _with_one(quest: Quest, radius: float, restarts: int) -> _Found:
    load = quest.wanted.load
    starts = [march(load, law, np.full(len(law), radius), quest.count)[0] for law in quest.laws]
    space = Heights(quest.span, quest.count)
    found = search(law_of_heights(radius, load), starts, quest.wanted, space, quest.goal, restarts, quest.rng)
    return _Found(found.unknowns, np.full(len(found.unknowns), radius), found.misfit)


def _with_several(quest: Quest, radii: Radii) -> _Found:
    singles = []
    for radius in radii.tried.tolist():
        singles.append(_with_one(quest, radius, 0))
        if singles[-1].misfit <= quest.goal:
            return singles[-1]
    best = min(singles, key=lambda found: found.misfit)
    load = quest.wanted.load
    rising, middle = np.geomspace(radii.low, radii.high, len(load)), len(load) // 2
    starts = [march(load, law, ramp, quest.count) for law in quest.laws for ramp in (rising, rising[::-1])]
    starts += [slowest(load[middle], law[middle], radii, quest.count) for law in quest.laws]
    starts.append((best.height, best.radius))
    depth = float(Independent().curves(best.height, best.radius, load[-1:])[0].max())
    ranged = radii.tools is None
    tools = radii.extremes if ranged else radii
    between = Asperities(quest.span, quest.count, radii.between, depth)
    mixing = Asperities(quest.span, quest.count, tools, depth)
    relaxed = between.nearest(quest, starts, LOOSE_RESTARTS)
    if ranged and relaxed.misfit <= quest.goal:
        return relaxed
    rounded = (relaxed.height, tools.nearest(relaxed.radius))
    mixed = mixing.nearest(quest, [rounded, *starts], MIXED_RESTARTS * quest.restarts)
    found = [mixed, best]
    if ranged:  # the extremes can do better than what lies between, and what lies near them better still
        found.append(between.nearest(quest, [(mixed.height, mixed.radius)], LOOSE_RESTARTS))
    return min(found, key=lambda each: each.misfit)


@dataclass(frozen=True)
class Asperities:
    """Heights (n,) and radii (n,) as one list of lengths: heights, and ln R times a `depth` [mm].

    With the largest indentation as the depth, a change of a radius weighs about as much as one of a
    height. Tools are changed at random alone. There may be `most` asperities, of heights within `span`.
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

    def changed(self, unknowns: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Return some heights moved and some radii dealt anew."""
        height, radius = self.split(unknowns)
        height, source = moved(height, self.most, rng)
        anew = rng.random(len(height)) < rng.choice(REDEALT)
        if self.radii.tools is None:
            dealt = np.exp(rng.uniform(math.log(self.radii.low), math.log(self.radii.high), len(height)))
        else:
            dealt = rng.choice(np.array(self.radii.tools), len(height))
        return self.joined(height, np.where(anew, dealt, radius[source]))

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

    def nearest(self, quest: Quest, starts: list[tuple[FloatArray, FloatArray]], restarts: int) -> _Found:
        """Search from heights and radii."""
        unknowns = [self.joined(height, radius) for height, radius in starts]
        law = self.law(quest.wanted.load)
        found = search(law, unknowns, quest.wanted, self, quest.goal, restarts, quest.rng)
        return _Found(*self.split(found.unknowns), found.misfit)
