"""Heights for a target law if the heights of some sites are prescribed.

The heights h_i of some sites are prescribed above the base plane. The other heights are determined so
that the law of the surface meets the target. The method uses three properties of a law:

1. A law depends only on the differences of the heights (and under the true block also on the compliance of
   the caps). Without prescribed heights, all heights may therefore be shifted together, as far as the foot
   allows. With prescribed heights the shift is an unknown. Each height then has its own bounds,
   ``foot <= h_j <= top``, instead of a bound on its distance from the tallest height.
2. An additional summit below the plane at the last load does not change the law. Prescribed heights are
   therefore added to the existing heights if there are enough free sites.
3. Otherwise a prescribed height h_i replaces an existing height h_j. To first order, this changes the law by
   ``dA0/dh_j (h_i - h_j)``. The gradients are bounded, so the sum of the distances |h_i - h_j| bounds the
   change. An assignment problem determines the replaced heights for which this sum is smallest. For equal
   distances, the height of the site itself is replaced, which leaves the other sites unchanged.

From these initial guesses, the Levenberg–Marquardt method with exact sensitivities minimises the squares of
the relative differences r(h) from the target law. The columns of the Jacobian for prescribed heights are set
to zero. The same is done for a height at a limit if a step down the gradient ``J' r`` would move it beyond
the limit (a projected gradient).

Operating points must be met to rounding. Their searches start from heights that are shifted off the kinks of
the law. If these searches fail, asperities are added on all sites. If the misfit remains large, the search
continues from random changes of the best heights, which include added and removed asperities.

If all prescribed heights equal the heights of their sites, the design remains unchanged. If they raise the
misfit by less than about a tenth, the other heights remain unchanged, except for operating points. The search
ends when it reaches the misfit without prescribed heights.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from metafem._validate import FloatArray, IntArray
from metafem.inversion.adjustment.height_steps import rounded_to_steps
from metafem.inversion.adjustment.on_sites import OnSites
from metafem.inversion.adjustment.refinement import (
    CLOSE,
    REFINED_GOAL,
    filled,
    residuals,
    stretched,
)
from metafem.inversion.assessment import EXACT, POINT_GOAL, model_misfit
from metafem.inversion.candidate import Candidate
from metafem.inversion.problem import Problem
from metafem.inversion.search.levenberg_marquardt import Minimum, descend, search
from metafem.inversion.search.nearest_law import GOAL
from metafem.inversion.search.spaces import Bounded
from metafem.progress import doing, each

# A prescribed height replaces the height of its own site unless another height is closer by more than this
# fraction of the span. The tolerance excludes effects of rounding.
SAME = 1e-9

# Damping of the first step. It is larger than the default, so that the other heights change less (measured:
# half or a third as much, with the same misfits).
SMALL_STEPS = 1.0

# The result of another initial guess or of a random change is accepted if its misfit is below this fraction
# of the best misfit. If the prescribed heights raise the misfit by no more than the inverse of this factor,
# no search is made and the other heights remain unchanged.
BETTER = 0.9


def space_of(problem: Problem, candidate: Candidate) -> Bounded:
    """Return the search space of a candidate: the limits of its heights, and its prescribed heights."""
    limits, rows = problem.limits, candidate.held_rows
    return Bounded(limits.foot, limits.top, rows, candidate.height[rows])


def with_pinned(
    problem: Problem, plain: Candidate, unrounded: Candidate, rng: np.random.Generator
) -> Candidate:
    """Return the candidate on height steps with the prescribed heights at their sites.

    The other heights are adjusted. `plain` and `unrounded` are the candidates without the prescribed heights,
    on height steps and not rounded. The result states the misfit of `plain` as `unpinned`.
    """
    pins, span = problem.pins, problem.limits.span
    unpinned = model_misfit(problem, plain)
    same = _in_place(plain, pins.rows, pins.heights, span)
    if np.array_equal(same.sites, plain.sites) and np.array_equal(same.height, plain.height):
        return replace(same, unpinned=unpinned)
    problem = replace(problem, options=replace(problem.options, start_damping=SMALL_STEPS))
    with doing("adjusting the heights to the given ones"):
        result = replace(_best(problem, unrounded, unpinned, rng), unpinned=unpinned, stepped=False)
    return rounded_to_steps(problem, result)


def _best(problem: Problem, candidate: Candidate, unpinned: float, rng: np.random.Generator) -> Candidate:
    """Return the candidate with the prescribed heights; the others are adjusted if it misses the target."""
    exact = candidate.lowest_level is not None
    least = REFINED_GOAL if problem.model.couples else GOAL
    goal = POINT_GOAL if exact else max(least, _rms(problem, candidate))
    enough = EXACT if exact else max(goal / BETTER, CLOSE)
    first = _in_place(candidate, problem.pins.rows, problem.pins.heights, problem.limits.span)
    first = first.with_heights(first.height)
    before = np.inf if exact else model_misfit(problem, first)
    if before <= unpinned / BETTER:
        return first
    best, chosen = np.inf, first
    for start in _starts(problem, candidate, first):
        found = _adjusted(problem, start, goal, rng)
        if found.misfit < BETTER * best or best == np.inf:
            best, chosen = found.misfit, start.with_heights(found.unknowns)
        if best <= enough:
            break
    else:
        if problem.model.gradient_model == problem.model:
            chosen = _changed(problem, chosen, goal, rng)
    if exact or not (candidate.branches or candidate.target_law.pointwise):
        return chosen
    # the search minimises a mean square, but the misfit here is the largest difference or a slope error
    after = model_misfit(problem, chosen)
    return chosen if after < before else first


def _changed(problem: Problem, start: Candidate, goal: float, rng: np.random.Generator) -> Candidate:
    """Return the candidate with the best heights found from random changes, on more or fewer sites."""
    every = OnSites.of(problem, start)
    space, height = every.space, every.whole.height
    residual = every.residual(problem.model.gradient_model, start.target_law)
    exact = start.lowest_level is not None
    r, _ = residual(height)
    best = Minimum(height, float(np.sqrt(r @ r / len(r))))
    options, effort = problem.options, problem.effort
    changes = effort.refined_restarts if problem.model.couples else effort.pinned_changes
    for _ in each("random change", range(changes), at_most=True):
        trial = space.changed(best.unknowns, rng, options.change_sizes)
        found = descend(residual, trial, space, goal, exact, options)
        best = found if found.misfit < BETTER * best.misfit else best
        if best.misfit <= (EXACT if exact else goal / BETTER):
            break
    return every.candidate(best.unknowns)


def _in_place(candidate: Candidate, sites: IntArray, heights: FloatArray, span: float) -> Candidate:
    """Return the candidate after prescribed heights on their sites have replaced the nearest heights.

    If a prescribed site held another height, this height moves to the site of the replaced height. If there
    are more prescribed heights than asperities, the remaining prescribed heights are added. Each of them has
    the radius of the nearest height.
    """
    distance = np.abs(candidate.height[None, :] - heights[:, None])
    own = candidate.sites[None, :] == sites[:, None]
    given, rows = linear_sum_assignment(distance + np.where(own, 0.0, SAME * span))
    where = candidate.sites.copy()
    height = candidate.height.copy()
    for i, j in zip(given.tolist(), rows.tolist(), strict=True):
        where[where == sites[i]] = where[j]
        where[j] = sites[i]
        height[j] = heights[i]
    left = np.setdiff1d(np.arange(len(sites)), given)
    nearest = distance[left].argmin(axis=1)
    found = candidate.taken(np.append(np.arange(len(height)), nearest))
    found = replace(found, held=sites, height=np.append(height, heights[left]))
    return found.placed(np.append(where, sites[left]))


def _added(problem: Problem, candidate: Candidate) -> Candidate | None:
    """Return the candidate with the prescribed heights in addition to its own; None without free sites."""
    pins = problem.pins
    free = np.setdiff1d(np.arange(problem.count), np.union1d(candidate.sites, pins.rows))
    on = np.flatnonzero(np.isin(candidate.sites, pins.rows))
    if len(on) > len(free):
        return None
    where = candidate.sites.copy()
    where[on] = free[: len(on)]
    nearest = np.abs(candidate.height[None, :] - pins.heights[:, None]).argmin(axis=1)
    found = candidate.taken(np.append(np.arange(len(candidate.height)), nearest))
    found = replace(found, held=pins.rows, height=np.append(candidate.height, pins.heights))
    return found.placed(np.append(where, pins.rows))


def _starts(problem: Problem, candidate: Candidate, first: Candidate) -> Iterator[Candidate]:
    """Yield initial guesses in order of increasing misfit; the last has asperities on all sites.

    The last guess is only for operating points.
    """
    pins, limits = problem.pins, problem.limits
    bases, drop = [candidate], float(candidate.height.max() - pins.heights.max())
    if drop > 0.0:  # lowered until the tallest height equals the tallest prescribed height
        bases.append(replace(candidate, height=np.maximum(candidate.height - drop, limits.foot)))
    put = [first, *(_in_place(base, pins.rows, pins.heights, limits.span) for base in bases[1:])]
    added = [start for base in bases if (start := _added(problem, base)) is not None]
    yield from sorted([*put, *added], key=lambda start: _rms(problem, start))
    if candidate.lowest_level is not None and len(first.height) < problem.count:
        yield filled(first, problem)


def _adjusted(problem: Problem, start: Candidate, goal: float, rng: np.random.Generator) -> Minimum:
    """Return heights adjusted to the prescribed heights, with their misfit under the model."""
    model, options, space = problem.model, problem.options, space_of(problem, start)
    _, residual, residual_of_model = residuals(problem, start, np.asarray)
    exact = start.lowest_level is not None
    guesses = stretched(start.height) if exact else [start.height]
    found = search(residual, guesses, space, goal, 0, rng, options, exact)
    if model.gradient_model == model:
        return found
    return descend(residual_of_model, found.unknowns, space, goal, options=options)


def _rms(problem: Problem, candidate: Candidate) -> float:
    """Return the root mean square of the weighted differences [-] under the gradient model."""
    solver, law = problem.model.gradient_model, candidate.target_law
    area = solver.areas(candidate.surface(problem.template), law.load, candidate.height[None])[0]
    if not np.isfinite(area).all():
        return np.inf
    r, _ = law.residual(area, np.empty((len(area), 0)))
    return float(np.sqrt(r @ r / len(r)))
