"""Independent asperities whose law is nearest to a target, and their refinement under another model."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

import numpy as np

from metafem.errors import NotConverged
from metafem.inversion.bounds import nearest_law
from metafem.inversion.guesses import frictions, of_one_tool
from metafem.inversion.levels import on_levels
from metafem.inversion.problem import NONE, Asperities, Branch, Candidate, Problem, misfit
from metafem.inversion.search import (
    AGREEING,
    EXACT_STEPS,
    GOAL,
    MET,
    NEAR,
    NEARLY,
    Found,
    Residual,
    changed,
    descend,
    descended,
    misfit_of,
    search,
)
from metafem.notes import information
from metafem.progress import doing

# A design is exact if the relative error of its friction is within this tolerance at each load of the target;
# a search for one ends at a hundredth of it.
EXACT, POINT_GOAL = 1e-9, 1e-11

# A target of any shape counts as reached within this rms misfit, because manufacturing errors change a law
# about as much.
REACHED = 0.01

# The heights of a density miss their target beyond this misfit. Aymard et al. regard an error of 10 % in the
# crossover load, the largest error in their comparisons, as a success.
MISSED = 0.1

# Misfit at which the search for heights of a density under a model ends. It is below half of the misfit up to
# which a law counts as met, because an error of a slope counts half.
DENSITY_GOAL = 0.4 * REACHED

# Above this misfit under the model, heights are first sought for a corrected target; their largest number.
CLOSE, CORRECTIONS = 5.0 * GOAL, 3

# Degree of the polynomial in ln P that is fitted to A0(model)/A0(independent). A low degree smooths out the
# kinks of single contacts, which move with the heights.
RATIO_DEGREE = 3

# Largest number of steps of a descent of interacting adhesive asperities, and of random changes of a start.
ADHESIVE_STEPS, ADHESIVE_TRIES = 6, 4

# Factor of the depths of summits, so that no level first touches exactly at an operating point. Interaction
# lowers open summits by between a hundredth and a tenth of their depth.
STRETCH = 1.03

# Depth of the added summits below the lowest level, relative to the depth of that level.
ADDED_DEPTH = 0.01

# Up to this misfit of descents with one tool, random changes of it come before other tools.
NEARBY = 0.01

# Number of random changes after which a descent to rounding is tried again; near a law under a model.
ATTEMPTS, ATTEMPTS_MODEL = 30, 8

# Largest number of loads at which heights are sought for a draft, and refined under another model.
DRAFT_LOADS, REFINED_LOADS = 15, 1000


def inverted(problem: Problem, rng: np.random.Generator, goal: float = GOAL) -> Candidate:
    """Return the independent asperities whose law is nearest to that of the target, with the fewest tools.

    goal: misfit at which the search ends, unless the target is exact.
    """
    law = problem.law
    levels = None
    if problem.target.exact and not problem.tools.law.adhesive:
        levels = on_levels(problem, rng)
        if levels is not None and not problem.held:
            return levels
    branches = tuple(
        # if the law has no free parameter, each branch has a fixed intercept
        Branch(
            slope,
            ends,
            None if law.is_open else float(np.interp(ends[0], law.load, law.lower)) - slope * ends[0],
        )
        for slope, ends in problem.target.branches
    )
    sought = law.thinned(DRAFT_LOADS).aim if problem.draft and not problem.target.exact else law.aim
    residual, first = Residual(problem, sought, branches), [] if levels is None else [levels.asperities]
    found = _nearest(residual, NEARLY if problem.target.exact else goal, rng, first)
    return Candidate(_raised(problem, found.asperities), law, branches=branches)


def _raised(problem: Problem, at: Asperities) -> Asperities:
    """Return the asperities raised together to the largest height, where the base is farthest from the plane.

    A common shift changes no law, except that of a model that includes the compliance of the caps.
    """
    if problem.held:
        return at
    return at.with_heights(at.height[at.sites] + problem.limits.top - at.height[at.sites].max())


def _nearest(residual: Residual, goal: float, rng: np.random.Generator, first: list[Asperities]) -> Found:
    """Return the best asperities of a search, which begins with the `first` ones."""
    problem, sought, exact = residual.problem, residual.law, residual.problem.target.exact
    guesses = frictions(sought, problem.bounds)
    # one restart is enough for a target outside the bounds, which no surface meets, and for adhesive contacts
    # with interaction, whose searches are slow and whose heights change again
    changes = problem.tools.law.adhesive and problem.model.couples and not exact
    agreeing = 1 if changes or nearest_law(sought, problem.bounds)[0] > goal else AGREEING
    best = list[Found]()
    for tool in problem.tools.tried.tolist():
        guessed = (of_one_tool(problem, sought.load, friction, tool, rng) for friction in guesses)
        best += descended(residual, chain(first, *guessed), goal)
        first = []
        if best[-1].misfit <= goal:
            break
    best.sort(key=misfit_of)
    tool, several = int(best[0].asperities.tool.max()), len(problem.tools) > 1
    if best[0].misfit <= NEARBY or not several:
        alone = replace(residual, problem=problem.alone(tool))
        tried = [
            Asperities(one.asperities.height, np.minimum(one.asperities.tool, 0))
            for one in best
            if not several or int(one.asperities.tool.max()) == tool
        ]
        one = search(alone, tried, goal, rng, 1 if several else agreeing)
        at = one.asperities
        best.insert(0, Found(Asperities(at.height, np.where(at.exists, tool, NONE)), one.misfit))
    if several and best[0].misfit > goal:
        mixed = search(residual, [best[0].asperities], goal, rng, agreeing)
        best.append(_with_fewer_tools(residual, mixed, goal))
    found = min(best, key=misfit_of)
    # under a model with interaction the heights change again
    if not exact or problem.model.couples:
        return found
    return _to_rounding(residual, found, rng, ATTEMPTS if found.misfit <= MET else 1)


def _with_fewer_tools(residual: Residual, best: Found, goal: float) -> Found:
    """Return the asperities after tools whose asperities other tools can make are left out."""
    used, counts = np.unique(best.asperities.tool[best.asperities.exists], return_counts=True)
    for tool in used[np.argsort(counts, kind="stable")].tolist() if best.misfit <= NEAR * goal else ():
        others = used[used != tool]
        for other in others[np.argsort(np.abs(others - tool), kind="stable")].tolist():
            at = best.asperities
            fewer = Asperities(at.height, np.where(at.tool == tool, other, at.tool))
            found = descend(residual, fewer, goal)
            if found.misfit <= NEAR * goal:
                return _with_fewer_tools(residual, found, goal)
    return best


def _to_rounding(residual: Residual, start: Found, rng: np.random.Generator, attempts: int) -> Found:
    """Return asperities whose law is exact, by descents from the start and from random changes."""
    best, at = start, start.asperities
    for _ in range(1 if residual.problem.draft else attempts):
        best = min(best, descend(residual, at, POINT_GOAL, exact=True), key=misfit_of)
        if best.misfit <= EXACT:
            break
        at = changed(best.asperities, residual.problem, rng)
    return best


def refined(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate with heights refined under the model, and a note on the change.

    A model without gradients is replaced by its `gradient_model`, whose gradients the last descent combines
    with the law of the model itself.
    """
    model = problem.model
    before = misfit(problem, candidate.asperities, candidate.law)
    with doing("refining the heights under the model"):
        found = _refined(problem, candidate, before, rng)
        raised = _raised(problem, found)
        lifted = after = misfit(problem, raised, candidate.law)
        if getattr(model, "pedestal", False):  # the compliance of a cap depends on its height
            after = misfit(problem, found, candidate.law)
        found = raised if lifted <= max(after, EXACT) else found
    if min(after, lifted) >= before:
        return candidate
    same = candidate.asperities.exists & found.exists
    change = 1e3 * float(np.abs(found.height - candidate.asperities.height)[same].max())
    words = f"heights were moved by at most {change:.3g} um for the law under the model"
    if model.gradient_model != model:
        words += f"; the gradients were those of {model.gradient_model.name}"
    return replace(
        candidate.with_asperities(found), refined=True, notes=(*candidate.notes, information(words))
    )


def _refined(problem: Problem, candidate: Candidate, before: float, rng: np.random.Generator) -> Asperities:
    model, exact = problem.model, problem.target.exact
    law = candidate.law if exact else candidate.law.thinned(DRAFT_LOADS if problem.draft else REFINED_LOADS)
    goal = POINT_GOAL if exact else 2.0 * GOAL if problem.draft else GOAL
    goal = goal if candidate.density is None else DENSITY_GOAL
    if before <= (EXACT if exact else goal):
        return candidate.asperities
    start, residual = candidate.asperities, Residual.under_model(problem, law.aim, candidate.branches)
    starts = [start]
    if exact:
        starts = [_with_summits(problem, start), start]
    elif model.couples and before > CLOSE and candidate.density is None:
        starts = [_corrected(residual, start, rng), start]
    # a step of interacting adhesive asperities takes a tenth of a second to a second
    slow = problem.tools.law.adhesive and model.couples
    starts += [changed(start, problem, rng) for _ in range(ADHESIVE_TRIES if slow else 0)]
    most, enough = ADHESIVE_STEPS if slow else EXACT_STEPS, GOAL if slow or not exact else EXACT
    found = list[Found]()
    for start in starts:
        found.append(descend(residual, start, goal, exact, most))
        if found[-1].misfit <= enough:
            break
    best = min(found, key=misfit_of)
    if best.misfit > (GOAL if exact else goal) and not slow and candidate.density is None:
        best = min(
            best, search(residual, [best.asperities], NEARLY if exact else goal, rng, 1), key=misfit_of
        )
    if exact and best.misfit > EXACT and not slow:
        best = _to_rounding(residual, best, rng, ATTEMPTS_MODEL if best.misfit <= NEARLY else ATTEMPTS)
    if model.gradient_model != model:
        best = descend(replace(residual, law=law, own=True), best.asperities, goal, exact)
    return best.asperities


def _corrected(residual: Residual, start: Asperities, rng: np.random.Generator) -> Asperities:
    """Return independent asperities whose law is the target divided by A0(model)/A0(independent).

    This ratio is a smooth function of the load and depends little on small changes of the heights.
    """
    problem, law = residual.problem, residual.law
    best, least = start, np.inf
    for _ in range(1 if problem.draft else CORRECTIONS):
        surface = problem.surface(start)
        try:
            area = problem.model.gradient_model.curve(surface, law.load).checked().area
        except NotConverged:
            break
        if law.misfit(area) >= least:
            break
        best, least = start, law.misfit(area)
        if least <= GOAL:
            break
        ratio = area / problem.uncoupled.curve(surface, law.load).area
        powers = np.vander(np.log(law.load / law.load[-1]), RATIO_DEGREE + 1)
        smooth = powers @ np.linalg.lstsq(powers, ratio, rcond=None)[0]
        divided = replace(residual, law=law.divided(smooth), model=None, ratio=smooth)
        start = search(divided, [start], GOAL, rng, 1).asperities
    return best


def _with_summits(problem: Problem, at: Asperities) -> Asperities:
    """Return the asperities a little lower than the tallest by more, with others just below on all sites.

    Interaction lowers the friction at every operating point. Without added summits, the friction could rise
    only if levels came into contact earlier. Added summits that are not needed can mislead the descent.
    """
    top, foot, free = at.height[at.exists].max(), problem.foot, np.setdiff1d(at.sites, list(problem.held))
    every, tool, vacant = at.height.copy(), at.tool.copy(), np.setdiff1d(problem.open, at.sites)
    every[free] = np.clip(top - STRETCH * (top - every[free]), foot, problem.limits.top)
    lowest = at.sites[every[at.sites].argmin()]
    every[vacant] = max(every[lowest] - ADDED_DEPTH * (top - every[lowest]), foot)
    tool[vacant] = tool[lowest]
    return Asperities(every, tool)
