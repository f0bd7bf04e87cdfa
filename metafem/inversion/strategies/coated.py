"""Heights of asperities that differ in friction, found by a search with the friction of each site.

The law of the target is one of friction, ``sum w_i A_i``. The friction belongs to the site: every site has an
asperity, and its height is an unknown. The initial guesses are the heights of asperities of one friction
whose A0 is the target divided by the mean weight, in several orders: the strongest tallest, the weakest
tallest, and at random. The search uses the sensitivities of the friction, first of independent asperities
and then of the model.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if
from metafem.inversion.adjustment.refinement import residuals
from metafem.inversion.assessment import POINT_GOAL
from metafem.inversion.candidate import Candidate, below_limit
from metafem.inversion.search.levenberg_marquardt import Minimum, descend, search
from metafem.inversion.search.nearest_law import GOAL, LawSearch
from metafem.inversion.search.spaces import Heights
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.targets.target import LEVEL_FRACTIONS

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem

# Number of random orders of the heights among the initial guesses.
RANDOM_ORDERS = 2

# Number of restarts of the search for the first heights, whose law need not be exact.
FIRST_RESTARTS = 3

# Probability that a random change exchanges heights, and the largest number of heights exchanged.
EXCHANGING, MOST_EXCHANGED = 0.5, 4

# Factor of the number of restarts. Of 12 laws of random surfaces with 4 to 36 asperities, all are recovered
# to .14 %; without the factor two are missed by 1 and 1.5 %.
MORE_RESTARTS = 5


@dataclass(frozen=True)
class OnSites(Heights):
    """Heights on sites of different friction; a random change may also exchange some of them."""

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, sizes: tuple[float, ...]) -> FloatArray:
        """Return heights moved at random, or with some of them exchanged at random."""
        if rng.random() < EXCHANGING:
            some = rng.choice(
                len(unknowns), min(len(unknowns), int(rng.integers(2, MOST_EXCHANGED + 1))), False
            )
            unknowns = unknowns.copy()
            unknowns[some] = unknowns[rng.permutation(some)]
            return unknowns
        return super().changed(unknowns, rng, sizes)


def coated_candidate(problem: Problem, rng: np.random.Generator) -> Candidate:
    """Return heights on all sites whose friction under the model of the problem is nearest to the target."""
    _refuse_unsupported(problem)
    target, law, space = problem.target, problem.target.curve(), OnSites(problem.limits.span)
    starts = _starts(problem, law, rng)
    exact = law.pointwise and law.ends is None
    goal = POINT_GOAL if exact else GOAL

    def placed(height: FloatArray) -> FloatArray:
        return below_limit(height, problem.limits)

    first = target.of_heights(problem, law, placed(starts[0]), np.full(problem.count, problem.radii.low))
    first = replace(first, sites=np.arange(problem.count))
    alone = replace(problem, model=problem.independent)
    _, residual, _ = residuals(alone, first, placed)
    options, restarts = problem.options, MORE_RESTARTS * problem.restarts
    found = search(residual, starts, space, max(goal, GOAL), restarts, rng, options, to_rounding=True)
    found = descend(residual, found.unknowns, space, goal, exact, options)
    if problem.model != problem.independent:
        found = _under_model(problem, first, found, goal, rng)
    candidate = first.with_heights(placed(found.unknowns))
    # the bounds of other targets are those of one friction
    return candidate if law.ends is None else target.judged(problem, candidate)


def _under_model(
    problem: Problem, first: Candidate, found: Minimum, goal: float, rng: np.random.Generator
) -> Minimum:
    """Return the heights after a search under the model's gradient model and a descent under the model."""
    space, options, model = OnSites(problem.limits.span), problem.options, problem.model
    restarts = problem.effort.refined_restarts
    _, residual, residual_of_model = residuals(
        problem, first, lambda height: below_limit(height, problem.limits)
    )
    found = search(residual, [found.unknowns], space, goal, restarts, rng, options, to_rounding=True)
    if model.gradient_model != model:
        found = descend(residual_of_model, found.unknowns, space, goal, True, options)
    return found


def _starts(problem: Problem, law: TargetLaw, rng: np.random.Generator) -> list[FloatArray]:
    """Return heights on all sites (n,) [mm], relative to the tallest, as initial guesses."""
    weights = np.broadcast_to(problem.template.friction_weights, problem.count)
    found = []
    for guess in problem.target.guesses(law, problem.bounds, LEVEL_FRACTIONS):
        area = guess / float(weights.mean())
        scaled = TargetLaw.fixed(law.load, area, law.weight, law.pointwise)
        start = LawSearch(problem, scaled, [area], FIRST_RESTARTS, rng)
        few, _ = start.nearest(problem.radii)
        height = np.full(problem.count, -problem.limits.span)
        height[: len(few)] = few
        strongest = np.argsort(-weights, kind="stable")
        orders = [strongest, strongest[::-1]]
        orders += [rng.permutation(problem.count) for _ in range(RANDOM_ORDERS)]
        for order in orders:
            on_sites = np.empty(problem.count)
            on_sites[order] = np.sort(height)[::-1]
            found.append(on_sites)
    return found


def _refuse_unsupported(problem: Problem) -> None:
    """Refuse what a design with friction that differs from site to site does not support."""
    for name, given in (
        ("layout", problem.layout),
        ("robust", problem.robust),
        ("tools", None if problem.tools.single else problem.tools),
        ("pinned heights", problem.pins.rows.size or None),
    ):
        words = "cannot be used if the asperities differ in friction; use one friction for all"
        refuse_if(given is not None, words, key=name)
    try:
        problem.target.curve()
    except InvalidInput:
        raise InvalidInput(
            "must be a law over a load range if the asperities differ in friction; add load_range",
            key="target",
        ) from None
