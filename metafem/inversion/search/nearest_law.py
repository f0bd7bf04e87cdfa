"""Heights, and radii if several are allowed, of independent asperities whose law is nearest to a target."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact.law import contacts
from metafem.errors import InvalidInput
from metafem.inversion.radii import Radii
from metafem.inversion.search.initial_guess import initial_heights, slowest_law
from metafem.inversion.search.levenberg_marquardt import DEFAULTS, SearchOptions, search
from metafem.inversion.search.spaces import Heights, LateResidual, Residual, moved
from metafem.models import Independent, Sensitivity

# Relative step of the finite differences by the radius: the cube root of machine precision.
RELATIVE = 6e-6

# Misfit at which a search ends: height errors of 1 um change A0 by more than this.
GOAL = 6e-4

# If an initial guess is deeper than allowed, guesses with these fractions of the asperities that are too
# low are tried: at the foot all of them come into contact early, and fewer suffice.
LOW_FRACTIONS = (1.0, 0.75, 0.5, 0.25, 0.0)

# Restarts with continuous radii, before the radii are rounded to tools.
CONTINUOUS_RESTARTS = 4

# Restarts with several tools per restart with one, because the radii are also unknown (measured on 40
# laws of random surfaces with radii of .1, .4 and 1.6 mm: all are recovered to .1 %; with 4 restarts one is
# not).
MIXED_RESTARTS = 10

# Probabilities that an asperity gets a new radius; one of them is drawn for each random change.
NEW_RADIUS = (0.0, 0.1, 0.3)

# Relative differences (k,) [-] and their Jacobian of a law A0 (k,) [mm^2] with its gradient (k, n).
LawResidual = Callable[[FloatArray, Callable[[], FloatArray]], LateResidual]


@dataclass(frozen=True, eq=False)
class LawSearch:
    """A search for asperities whose law under `model` has the least differences from a target.

    `law_residual` is evaluated at rescaled loads `load` (k,) [mm^2]. The initial guesses have laws near
    `guesses`, (k,) [mm^2]. At most `count` asperities are used, with heights within `span` [mm]. The search
    ends at a misfit of `goal`.
    """

    model: Independent
    load: FloatArray
    law_residual: LawResidual
    guesses: list[FloatArray]
    count: int
    span: float
    restarts: int
    rng: np.random.Generator
    goal: float
    options: SearchOptions = DEFAULTS


@dataclass(frozen=True, eq=False)
class NearestLaw:
    """Heights and radii (n,) [mm] with the misfit of their law [-]."""

    height: FloatArray
    radius: FloatArray
    misfit: float

    @property
    def sorted(self) -> tuple[FloatArray, FloatArray]:
        """Heights, tallest first at 0, and their radii."""
        order = np.argsort(-self.height, kind="stable")
        return self.height[order] - self.height.max(), self.radius[order]


def beyond(load: FloatArray, height: FloatArray) -> LateResidual:
    """Return the differences for heights beyond the range of the contact law."""
    return np.full(len(load), np.inf), lambda: np.zeros((len(load), len(height)))


def residual_of_heights(
    model: Independent, radius: float | FloatArray, load: FloatArray, law_residual: LawResidual
) -> Residual:
    """Return the differences of independent asperities of given radii as a function of their heights."""

    def residual(height: FloatArray) -> LateResidual:
        try:
            found = model.sensitivity_of(height, np.broadcast_to(radius, height.shape), load)
        except InvalidInput:
            return beyond(load, height)
        return law_residual(found.curve.area, lambda: found.gradient)

    return residual


def _heights_task(task: LawSearch, radius: float) -> tuple[Residual, list[FloatArray], Heights]:
    """Return the residual, the initial guesses and the limits of a search for heights."""
    residual = residual_of_heights(task.model, radius, task.load, task.law_residual)
    starts = []
    for law in task.guesses:
        radii = np.full(len(law), radius)
        height, _ = initial_heights(task.model.contact, task.load, law, radii, task.count)
        inside = int((height >= height[0] - task.span).sum())
        # if heights are deeper than the span, also with fewer of the heights that are too low
        numbers = dict.fromkeys(inside + round(part * (len(height) - inside)) for part in LOW_FRACTIONS)
        starts += [height[:number] for number in numbers]
    return residual, starts, Heights(task.span, task.count)


def nearest_law(task: LawSearch, radii: Radii) -> NearestLaw:
    """Return heights and radii; a single radius is used if it reaches the goal.

    Otherwise the search starts from radii that rise or fall with the depth, and then from random changes.
    """
    load = task.load
    singles = []
    for radius in radii.tried.tolist():
        restarts = task.restarts if radii.single else 0
        residual, guesses, space = _heights_task(task, radius)
        minimum = search(residual, guesses, space, task.goal, restarts, task.rng, task.options)
        height = minimum.unknowns
        singles.append(NearestLaw(height, np.full(len(height), radius), minimum.misfit))
        if radii.single or minimum.misfit <= task.goal:
            return singles[-1]
    best = min(singles, key=lambda found: found.misfit)
    rising, middle = np.geomspace(radii.low, radii.high, len(load)), len(load) // 2
    starts = [
        initial_heights(task.model.contact, load, law, ramp, task.count)
        for law in task.guesses
        for ramp in (rising, rising[::-1])
    ]
    if task.model.contact.power is not None:
        point = task.model.contact, load[middle]
        starts += [slowest_law(*point, law[middle], radii, task.count) for law in task.guesses]
    starts.append((best.height, best.radius))
    depth = float(task.model.curve_of(best.height, best.radius, load[-1:]).approach[0])
    ranged = radii.tools is None
    tools = radii.extremes if ranged else radii
    between = Asperities(task.span, task.count, radii.between, depth)
    mixing = Asperities(task.span, task.count, tools, depth)
    relaxed = between.nearest(task, starts, CONTINUOUS_RESTARTS)
    if ranged and relaxed.misfit <= task.goal:
        relaxed = _on_steps(relaxed, task, replace(between, radii=radii))
        if relaxed.misfit <= task.goal:
            return relaxed
    rounded = (relaxed.height, tools.nearest(relaxed.radius))
    mixed = mixing.nearest(task, [rounded, *starts], MIXED_RESTARTS * task.restarts)
    found = [mixed, best]
    if ranged:  # the extreme radii can have a smaller misfit, and radii near them an even smaller one
        free = between.nearest(task, [(mixed.height, mixed.radius)], CONTINUOUS_RESTARTS)
        found += [_on_steps(each, task, replace(between, radii=radii)) for each in (free, relaxed)]
    return min(found, key=lambda each: each.misfit)


def _on_steps(found: NearestLaw, task: LawSearch, stepped: Asperities) -> NearestLaw:
    """Return the asperities with radii on the steps of a range, after a new search for their heights."""
    if stepped.radii.continuous:
        return found
    return stepped.nearest(task, [(found.height, found.radius)], 0)


@dataclass(frozen=True)
class Asperities:
    """Heights (n,) and radii (n,) as one vector of lengths: heights, and ln R times a `depth` [mm].

    With the largest indentation as the depth, unit changes of both kinds change the law about equally.
    Random changes are the only changes of tool radii. At most `most` asperities are used, with heights within
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
        """Return the indices of the tallest height and of those `span` below it."""
        return Heights(self.span).ends(unknowns[: len(unknowns) // 2])

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, sizes: tuple[float, ...]) -> FloatArray:
        """Return unknowns with some heights moved and some radii drawn anew."""
        height, radius = self.split(unknowns)
        height, source = moved(height, self.most, rng, sizes)
        anew = rng.random(len(height)) < rng.choice(NEW_RADIUS)
        if self.radii.tools is None:
            drawn = np.exp(rng.uniform(math.log(self.radii.low), math.log(self.radii.high), len(height)))
        else:
            drawn = rng.choice(np.array(self.radii.tools), len(height))
        return self.joined(height, np.where(anew, drawn, radius[source]))

    def residual(self, model: Independent, load: FloatArray, law_residual: LawResidual) -> Residual:
        """Return the differences of independent asperities as a function of the unknowns.

        At a fixed load, ``R_i dA0/dR_i = R dA_i/dR - R dP_i/dR sum A' / sum P'`` with the derivatives A' and
        P' by the indentation d. At a fixed d, ``R dA/dR = 2 A - d A'`` if lengths over R are the same for all
        radii, and likewise for P.
        """
        law = model.contact

        def residual(unknowns: FloatArray) -> LateResidual:
            height, radius = self.split(unknowns)
            found = model.sensitivity_of(height, radius, load)
            return law_residual(found.curve.area, lambda: gradient(found, radius))

        def gradient(found: Sensitivity, radius: FloatArray) -> FloatArray:
            depth = np.maximum(found.indentation, 0.0)
            size = np.broadcast_to(radius, depth.shape)
            at = contacts(law, depth, size)
            area_slope = law.area_slope(at.contact_radius, size)
            slope = area_slope.sum(axis=1) / at.stiffness.sum(axis=1)
            if not self.radii.continuous:
                by_radius = np.zeros(depth.shape)
            elif law.similar:
                by_radius = 2.0 * at.area - depth * area_slope
                by_radius -= slope[:, None] * (2.0 * at.load - depth * at.stiffness)
            else:
                low, high = (contacts(law, depth, size * (1.0 + step)) for step in (-RELATIVE, RELATIVE))
                by_radius = (high.area - low.area) / (2.0 * RELATIVE)
                by_radius -= slope[:, None] * (high.load - low.load) / (2.0 * RELATIVE)
            return np.hstack([found.gradient, by_radius / self.depth])

        return residual

    def nearest(
        self, task: LawSearch, starts: list[tuple[FloatArray, FloatArray]], restarts: int
    ) -> NearestLaw:
        """Search from heights and radii."""
        unknowns = [self.joined(height, radius) for height, radius in starts]
        residual = self.residual(task.model, task.load, task.law_residual)
        found = search(residual, unknowns, self, task.goal, restarts, task.rng, task.options)
        return NearestLaw(*self.split(found.unknowns), found.misfit)
