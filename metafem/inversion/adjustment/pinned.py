"""Heights for a target law if some of the heights are given.

The heights of some sites, h_i for i in G, are given above the base plane. The other heights are determined so
that the law of the surface meets the target. Three facts follow from the law of a surface:

1. A law depends only on the differences of the heights (and under the true block on the compliance of the
   caps). Heights found without given ones may therefore be shifted together, as far as the foot. With given
   heights the shift is an unknown, and each height has its own bounds, ``foot <= h_j <= top``, instead of a
   bound on its distance from the tallest.
2. A given height below the plane at the last load changes nothing, as long as the heights found without it
   keep their sites. It is therefore added if there are free sites.
3. Otherwise it replaces one of the heights found. If it replaces h_j, the law changes to first order by
   ``dA0/dh_i (h_i - h_j)``. The gradients ``dA0/dh`` at a load differ by no more than
   their range over the contacts, so the sum of the distances |h_i - h_j| bounds the change. The replaced
   heights are those with the least sum, an assignment problem; if distances are equal, the height of the
   site itself is replaced, which leaves the other sites unchanged.

From these initial guesses, the squares of the relative differences r(h) from the target law are minimised by
the Levenberg–Marquardt method with exact sensitivities. The columns of the Jacobian for given heights are
zero, and so are those of heights at a limit that a step down the gradient ``J' r`` would push beyond it
(a projected gradient). Points are met to rounding from heights that are stretched off the kinks of the law;
if that fails, asperities are added on all sites. If the misfit remains large, the search continues from
random changes of the best heights, in which asperities are added on free sites or removed.
Given heights that equal those of their sites leave the whole design unchanged. Given heights that raise the
misfit by less than a tenth leave the other heights unchanged. The search ends at the misfit of the heights
without the given ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from metafem._validate import FloatArray, IntArray
from metafem.inversion.adjustment.height_steps import rounded_to_steps
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

# A site keeps its own height unless another one is closer by more than this fraction of the span: rounding.
SAME = 1e-9

# Damping of the first step: the other heights change less (measured: by half or a third) than with the
# damping of other searches, and the misfits are the same.
SMALL_STEPS = 1.0

# Another initial guess or a random change is accepted if the misfit is smaller by this factor. None is tried,
# and the other heights are unchanged, if the given heights raise the misfit by no more than its inverse.
BETTER = 0.9


def space_of(problem: Problem, candidate: Candidate) -> Bounded:
    """Return the limits of the heights of a candidate, with the fixed heights."""
    limits, rows = problem.limits, candidate.held_rows
    return Bounded(limits.foot, limits.top, rows, candidate.height[rows])


def with_pinned(
    problem: Problem, plain: Candidate, unrounded: Candidate, rng: np.random.Generator
) -> tuple[Candidate, Candidate]:
    """Return candidates with the given heights, on steps and before rounding, from those without them.

    The given heights of the problem are at their sites, and the others are adjusted.
    """
    pins, span = problem.pins, problem.limits.span
    unpinned = model_misfit(problem, plain)
    same = _in_place(plain, pins.rows, pins.heights, span)
    if np.array_equal(same.sites, plain.sites) and np.array_equal(same.height, plain.height):
        same = replace(same, unpinned=unpinned)
        return same, same
    problem = replace(problem, options=replace(problem.options, start_damping=SMALL_STEPS))
    with doing("adjusting the heights to the given ones"):
        result = replace(_best(problem, unrounded, unpinned, rng), unpinned=unpinned, stepped=False)
    return rounded_to_steps(problem, result), result


def _best(problem: Problem, candidate: Candidate, unpinned: float, rng: np.random.Generator) -> Candidate:
    """Return the candidate with the given heights, and the others adjusted if it misses the target."""
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
    # the misfit is not the mean square that is minimised, but the largest difference or that of a slope
    after = model_misfit(problem, chosen)
    return chosen if after < before else first


def _changed(problem: Problem, start: Candidate, goal: float, rng: np.random.Generator) -> Candidate:
    """Return the best of the heights and of random changes of them, on more or fewer sites."""
    count, lowest, limits = problem.count, int(start.height.argmin()), problem.limits
    space = Bounded(limits.foot, limits.top, problem.pins.rows, problem.pins.heights)
    height, radius = np.full(count, space.absent), np.full(count, start.radius[lowest])
    height[start.sites], radius[start.sites] = start.height, start.radius
    whole = replace(start, sites=np.arange(count), height=height, radius=radius)
    _, residual, _ = residuals(problem, whole, np.asarray)
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
    some = space.exists(best.unknowns)
    result = replace(whole, sites=np.flatnonzero(some), radius=radius[some])
    return result.with_heights(best.unknowns[some])


def _in_place(candidate: Candidate, sites: IntArray, heights: FloatArray, span: float) -> Candidate:
    """Return the candidate with given heights on their sites, in place of the nearest heights.

    A height that was on such a site moves to the site of the replaced one. Given heights in excess of the
    asperities are added, with the radius of the nearest height.
    """
    distance = np.abs(candidate.height[None, :] - heights[:, None])
    own = candidate.sites[None, :] == sites[:, None]
    given, rows = linear_sum_assignment(distance + np.where(own, 0.0, SAME * span))
    where = candidate.sites.copy()
    height, radius = candidate.height.copy(), candidate.radius.copy()
    for i, j in zip(given.tolist(), rows.tolist(), strict=True):
        where[where == sites[i]] = where[j]
        where[j] = sites[i]
        height[j] = heights[i]
    left = np.setdiff1d(np.arange(len(sites)), given)
    nearest = distance[left].argmin(axis=1)
    height, radius = np.append(height, heights[left]), np.append(radius, radius[nearest])
    return replace(candidate, held=sites, height=height, radius=radius).placed(np.append(where, sites[left]))


def _added(problem: Problem, candidate: Candidate) -> Candidate | None:
    """Return the candidate with the given heights added to all its own; None without sites for them."""
    pins = problem.pins
    free = np.setdiff1d(np.arange(problem.count), np.union1d(candidate.sites, pins.rows))
    on = np.flatnonzero(np.isin(candidate.sites, pins.rows))
    if len(on) > len(free):
        return None
    where = candidate.sites.copy()
    where[on] = free[: len(on)]
    nearest = np.abs(candidate.height[None, :] - pins.heights[:, None]).argmin(axis=1)
    height = np.append(candidate.height, pins.heights)
    radius = np.append(candidate.radius, candidate.radius[nearest])
    return replace(candidate, held=pins.rows, height=height, radius=radius).placed(
        np.append(where, pins.rows)
    )


def _starts(problem: Problem, candidate: Candidate, first: Candidate) -> Iterator[Candidate]:
    """Yield initial guesses: those of least misfit first, finally one with asperities on all sites."""
    pins, limits = problem.pins, problem.limits
    bases, drop = [candidate], float(candidate.height.max() - pins.heights.max())
    if drop > 0.0:  # lowered until the tallest is as high as the tallest given one
        bases.append(replace(candidate, height=np.maximum(candidate.height - drop, limits.foot)))
    put = [first, *(_in_place(base, pins.rows, pins.heights, limits.span) for base in bases[1:])]
    added = [start for base in bases if (start := _added(problem, base)) is not None]
    yield from sorted([*put, *added], key=lambda start: _rms(problem, start))
    if candidate.lowest_level is not None and len(first.height) < problem.count:
        yield filled(first, problem)


def _adjusted(problem: Problem, start: Candidate, goal: float, rng: np.random.Generator) -> Minimum:
    """Return the heights adjusted to the fixed ones, with their misfit under the model."""
    model, options, space = problem.model, problem.options, space_of(problem, start)
    _, residual, residual_of_model = residuals(problem, start, np.asarray)
    exact = start.lowest_level is not None
    guesses = stretched(start.height) if exact else [start.height]
    found = search(residual, guesses, space, goal, 0, rng, options, exact)
    if model.gradient_model == model:
        return found
    return descend(residual_of_model, found.unknowns, space, goal, options=options)


def _rms(problem: Problem, candidate: Candidate) -> float:
    """Return the root mean square of the differences under the gradient model."""
    solver, law = problem.model.gradient_model, candidate.target_law
    area = solver.areas(candidate.surface(problem.template), law.load, candidate.height[None])[0]
    if not np.isfinite(area).all():
        return np.inf
    r, _ = law.residual(area, np.empty((len(area), 0)))
    return float(np.sqrt(r @ r / len(r)))
