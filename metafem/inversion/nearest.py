"""Heights, and radii where there is a choice, whose independent law is nearest to a wanted one."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion.march import march, slowest
from metafem.inversion.radii import Radii
from metafem.inversion.refine import Evaluate, Heights, moved, search
from metafem.inversion.wanted import Wanted
from metafem.models import Independent
from metafem.models.model import Sensitivity
from metafem.surface import Material, Surface

# Misfit at which a search ends: heights of 1 um of error change A0 by more.
GOAL = 6e-4

# Random restarts over any radii before they are rounded to tools.
LOOSE_RESTARTS = 4

# A random change deals a new radius to each asperity with one of these probabilities.
REDEALT = (0.0, 0.1, 0.3)


def nearest_law(
    wanted: Wanted,
    laws: list[FloatArray],
    radii: Radii,
    count: int,
    span: float,
    restarts: int,
    rng: np.random.Generator,
    goal: float = GOAL,
) -> tuple[FloatArray, FloatArray]:
    """Return heights, tallest first at 0 and within the span, and their radii (n,) [mm].

    The search starts from given laws, (k,) each [mm^2] at the wanted loads. One radius that reaches the
    goal is preferred; else radii that rise and fall with the depth are tried, then random ones.
    """
    if radii.single:
        found = _with_one(wanted, laws, radii.low, count, span, restarts, rng, goal)
    else:
        found = _with_several(wanted, laws, radii, count, span, restarts, rng, goal)
    order = np.argsort(-found.height, kind="stable")
    return found.height[order] - found.height.max(), found.radius[order]


def independent_law(height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
    """Return the law of independent asperities and its gradient by the heights."""
    surface = Surface.square_lattice(height, (1, len(height)), radius=radius, material=Material(1.0))
    return Independent().sensitivity(surface, load)


@dataclass(frozen=True, eq=False)
class _Found:
    height: FloatArray
    radius: FloatArray
    misfit: float


def _with_one(
    wanted: Wanted, laws: list[FloatArray], radius: float, count: int, span: float, restarts: int,
    rng: np.random.Generator, goal: float,
) -> _Found:  # fmt: skip
    def evaluate(height: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = independent_law(height, np.full(len(height), radius), wanted.load)
        return found.curve.area, found.gradient

    starts = [march(wanted.load, law, np.full(len(law), radius), count)[0] for law in laws]
    found = search(evaluate, starts, wanted, Heights(span, count), goal, restarts, rng)
    return _Found(found.unknowns, np.full(len(found.unknowns), radius), found.misfit)


def _with_several(
    wanted: Wanted, laws: list[FloatArray], radii: Radii, count: int, span: float, restarts: int,
    rng: np.random.Generator, goal: float,
) -> _Found:  # fmt: skip
    singles = []
    for radius in radii.tried.tolist():
        singles.append(_with_one(wanted, laws, radius, count, span, 0, rng, goal))
        if singles[-1].misfit <= goal:
            return singles[-1]
    best = min(singles, key=lambda found: found.misfit)
    rising = np.geomspace(radii.low, radii.high, len(wanted.load))
    starts = [march(wanted.load, law, ramp, count) for law in laws for ramp in (rising, rising[::-1])]
    middle = len(wanted.load) // 2
    starts += [slowest(wanted.load[middle], law[middle], radii, count) for law in laws]
    starts.append((best.height, best.radius))
    depth = float(Independent().curves(best.height, best.radius, wanted.load[-1:])[0].max())
    loose = Asperities(span, count, Radii(radii.low, radii.high, None), depth)
    tools = radii.extremes if radii.tools is None else radii
    space = Asperities(span, count, tools, depth)
    found = loose.nearest(starts, wanted, LOOSE_RESTARTS, rng, goal)
    if radii.tools is None and found.misfit <= goal:
        return found
    rounded = (found.height, tools.nearest(found.radius))
    mixed = space.nearest([rounded, *starts], wanted, restarts, rng, goal)
    if radii.tools is None:  # where the extremes do better than what lies between, from there
        found = loose.nearest([(mixed.height, mixed.radius)], wanted, LOOSE_RESTARTS, rng, goal)
    return min(mixed, found if radii.tools is None else best, best, key=lambda each: each.misfit)


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

    def nearest(
        self, starts: list[tuple[FloatArray, FloatArray]], wanted: Wanted, restarts: int,
        rng: np.random.Generator, goal: float,
    ) -> _Found:  # fmt: skip
        """Search from heights and radii."""
        unknowns = [self.joined(height, radius) for height, radius in starts]
        found = search(self.law(wanted.load), unknowns, wanted, self, goal, restarts, rng)
        return _Found(*self.split(found.unknowns), found.misfit)
