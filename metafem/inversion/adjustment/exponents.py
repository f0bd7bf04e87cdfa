"""Refinement under a model: of the heights, and of the exponents of power caps if these are of a range.

Exponents and heights of power caps are corrected for interaction before the heights alone are refined.

The friction A0(model)/A0(independent) is a smooth function of the load that changes little with the heights
and exponents, if the heights of independent asperities are shifted so that each summit first touches at the
same loads. The target divided by this ratio is therefore a new target for independent asperities.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.inversion.adjustment.refinement import REFINED_GOAL, refined, shift
from metafem.inversion.assessment import model_misfit
from metafem.inversion.candidate import Candidate, below_limit
from metafem.inversion.problem import Problem
from metafem.inversion.search.asperities import beyond
from metafem.inversion.search.levenberg_marquardt import search
from metafem.inversion.search.mixed_tools import ToolSearch
from metafem.inversion.search.spaces import LateResidual
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.tools.kit import Kit
from metafem.progress import doing

# Number of corrections; each reduces the error by about the change of the ratio.
CORRECTIONS = 4


def free_exponents(problem: Problem, candidate: Candidate) -> bool:
    """Return whether exponents of a range are adjusted with the heights under a model with interaction.

    Those of a height density, on height steps and of targets other than friction do not change.
    """
    ranged = isinstance(problem.tools, Kit) and problem.tools.range is not None
    fixed = candidate.density is not None or candidate.stepped
    return ranged and problem.model.couples and not fixed


def adjusted(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate refined under the model together with its exponents, which are of a range.

    If corrected exponents and refined heights do not meet the target, a search for both under the model
    follows, unless the exponents have steps or the contacts adhere.
    """
    kit = problem.tools
    assert isinstance(kit, Kit)
    assert kit.range is not None
    with doing("correcting the exponents for interaction"):
        start = _corrected(problem, kit, candidate, rng)
    found = refined(problem, start, rng)
    goal = max(REFINED_GOAL, problem.effort.refined_goal)
    if kit.range.step is not None or problem.contact.adhesive or model_misfit(problem, found) <= goal:
        return found
    with doing("searching exponents and heights under the model"):
        other = _searched(problem, kit, start, goal, rng)
    return min(found, refined(problem, other, rng), key=lambda each: model_misfit(problem, each))


def _corrected(problem: Problem, kit: Kit, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate with its exponents and heights corrected for interaction."""
    model, law = problem.model.gradient_model, candidate.target_law
    best, least = candidate, np.inf
    for _ in range(CORRECTIONS):
        surface = candidate.surface(problem.template)
        height = below_limit(shift(problem, candidate)(candidate.height), problem.limits)
        try:
            area = model.curve(surface.replaced(height=height), law.load).area
        except InvalidInput:  # beyond the range of the contact law
            break
        misfit = law.misfit(area)
        best, least = (candidate, misfit) if misfit < least else (best, least)
        if misfit <= REFINED_GOAL:
            break
        ratio = area / problem.uncoupled.curve(surface, law.load).area
        divided = TargetLaw.fixed(law.load, law.law(area) / ratio, law.weight)
        tools = ToolSearch(problem, kit, divided, [divided.base], 0, rng)
        found = tools.around(candidate.height, surface)
        heights = problem.limits.top + found[0] - found[0].max()
        candidate = replace(candidate, height=heights, cap=found[1], moved=True)
    return best


def _searched(
    problem: Problem, kit: Kit, start: Candidate, goal: float, rng: np.random.Generator
) -> Candidate:
    """Return a candidate after a search for its exponents and heights under the model.

    As in `with_same_entries`, the unknowns are those of independent asperities and so are the gradients, but
    the law is that of the shifted heights under the model.
    """
    model, law = problem.model.gradient_model, start.target_law
    tools = ToolSearch(problem, kit, law, [law.base], 0, rng)

    def made(unknowns: FloatArray) -> Candidate:
        height, cap = tools.made(unknowns)
        return replace(start, height=problem.limits.top + height - height.max(), cap=cap, moved=True)

    def residual(unknowns: FloatArray) -> LateResidual:
        trial = made(unknowns)
        height = below_limit(shift(problem, trial)(trial.height), problem.limits)
        try:
            area = model.areas(trial.surface(problem.template), law.load, height[None])[0]
        except InvalidInput:
            return beyond(law.load, unknowns)
        if not np.isfinite(area).all():
            return beyond(law.load, unknowns)
        return law.late_residual(area, lambda: np.empty(0))[0], tools.residual(unknowns)[1]

    space = replace(tools.space, most=None)
    first = tools.unknowns(start.height, start.surface(problem.template))
    restarts = problem.effort.refined_restarts
    found = search(residual, [first], space, goal, restarts, rng, problem.options)
    return made(found.unknowns)
