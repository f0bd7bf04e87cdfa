"""Heights without levels for operating points, found by a search."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion.assessment import POINT_GOAL
from metafem.inversion.candidate import Candidate
from metafem.inversion.search.levenberg_marquardt import descend, search
from metafem.inversion.search.nearest_law import MIXED_RESTARTS, LawSearch, residual_of_heights
from metafem.inversion.search.spaces import Heights
from metafem.inversion.search.target_law import TargetLaw
from metafem.notes import information

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem
    from metafem.inversion.tools.radii import Radii

# Heights without levels are accepted up to this misfit, which is far below the effect of height errors.
ACCEPTED = 1e-3

# Under a model with interaction, further searches follow above this multiple of the interaction margin. For
# points of 67 random surfaces the ratio was up to 1.8.
MARGINS = 4.0

# The random changes end at this misfit; a descent to rounding follows.
ENOUGH = 1e-4

# A descent to rounding takes about three times as long as one that ends at small gains.
LONGER = 3

# Under a model with interaction they end at this fraction of the interaction margin if it is larger. The
# refinement then changes the law by more than the misfit.
PART_OF_MARGIN = 0.25


def without_levels(
    law: TargetLaw, problem: Problem, rng: np.random.Generator, margin: float
) -> Candidate | None:
    """Return the best heights and radii found without levels, or None if their misfit is not accepted.

    `margin` is the interaction margin of the model [-].
    """
    limits, accepted, best = problem.limits, max(ACCEPTED, MARGINS * margin), None
    # under a model with interaction, the misfit under that model decides
    misfit = np.inf if problem.model.couples else accepted
    enough = max(PART_OF_MARGIN * margin, ACCEPTED / 2.0 if problem.model.couples else ENOUGH)
    for searches in _searches(problem, law, rng, enough):
        for height, radius in searches:
            height = height - height.max()
            curve = problem.independent.curve_of(height, radius, law.load)
            found = law.misfit(curve.area)
            if found < misfit and curve.approach[-1] <= limits.top:
                misfit, order = found, np.argsort(-height, kind="stable")
                note = "no levels of equal heights meet the points: the heights were found by a search"
                best = Candidate(
                    limits.top + height[order], radius[order], {"span": float(np.ptp(height))}, law,
                    notes=(information(note),), lowest_level=limits.top + float(height.min()),
                )  # fmt: skip
            # the refinement needs more exact heights if they have several radii
            if best is not None and misfit <= (accepted if problem.radii.single else POINT_GOAL):
                break
        if best is not None and misfit <= accepted:
            break
    return best


def _searches(
    problem: Problem, law: TargetLaw, rng: np.random.Generator, enough: float
) -> Iterator[Iterator[tuple[FloatArray, FloatArray]]]:
    """Yield searches for independent asperities whose law is near the points.

    Each search yields heights and radii, (n,) each [mm]. With several radii, a search with only the extreme
    radii comes first: they leave the refinement more freedom.
    """
    if problem.radii.single:
        yield _of_one_radius(problem, law, rng, enough)
        return
    for radii in dict.fromkeys((problem.radii.extremes, problem.radii)):
        yield _of_several_radii(problem, law, radii, rng)


def _of_several_radii(
    problem: Problem, law: TargetLaw, radii: Radii, rng: np.random.Generator
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield heights and radii, found with smaller and smaller goals."""
    for goal in problem.effort.free_goals:
        restarts = problem.restarts // MIXED_RESTARTS
        start = LawSearch(problem, law, [law.base], restarts, rng, goal).nearest(radii)
        yield _exact(problem, law, *start)


def _of_one_radius(
    problem: Problem, law: TargetLaw, rng: np.random.Generator, enough: float
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield heights of one radius: by random changes with short descents, then with descents to rounding."""
    radii, options, effort = problem.radii, problem.options, problem.effort
    space = Heights(problem.limits.span, problem.count)
    residual = residual_of_heights(problem.independent, radii.low, law)
    first = LawSearch(problem, law, [law.base], problem.restarts, rng, effort.free_goals[0])
    height, _ = first.nearest(radii)
    for restarts, to_rounding in ((problem.restarts, False), (problem.restarts // LONGER, True)):
        given = enough, restarts, rng, options, to_rounding
        height = search(residual, [height], space, *given).unknowns
        yield _exact(problem, law, height, np.full(len(height), radii.low))


def _exact(
    problem: Problem, law: TargetLaw, height: FloatArray, radius: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the heights after a descent to rounding, and their radii, (n,) each [mm]."""
    residual, space = residual_of_heights(problem.independent, radius, law), Heights(problem.limits.span)
    return descend(residual, height, space, POINT_GOAL, True, problem.options).unknowns, radius
