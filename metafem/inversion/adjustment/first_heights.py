"""First heights for the stiffness or another quantity of interacting asperities.

Interaction lowers the stiffness and the conductance by up to a half. Heights of independent asperities with
the target as their law are therefore far from it. The compliance 1/Q of a quantity is nearly the sum of
that of independent asperities, 1/q, and that of the block, c(P) = 1/Q - 1/q. The latter changes little with
the heights. Independent asperities are therefore inverted for the law
1/(1/Q - c) of a target Q, with c of the last heights. A search under the model follows.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.adjustment.on_sites import OnSites
from metafem.inversion.adjustment.refinement import CLOSE, REFINED_GOAL
from metafem.inversion.candidate import Candidate
from metafem.inversion.problem import Problem
from metafem.inversion.search.levenberg_marquardt import DEFAULTS, NEAR, search
from metafem.inversion.strategies import tools
from metafem.inversion.targets.laws import SampledLaw
from metafem.models import Independent
from metafem.models.model import contact_of
from metafem.notes import information
from metafem.progress import each

# Number of inversions for independent asperities on the same sites, about 0.1 s each, and their restarts.
ROUNDS, RESTARTS = 3, 2

# Number of random changes on the same sites, about 0.05 s each.
CHANGES = 10

# Number of choices of sites for each restart of a refinement, in addition to the first. With several tools
# there is only the first.
PLACEMENTS = 3

# Lowest compliance of independent asperities, relative to that of the target.
STIFFEST = 0.1

# Misfit [-] of a candidate.
Found = tuple[float, Candidate]


def first_heights(problem: Problem, rng: np.random.Generator) -> Candidate:
    """Return heights on sites of the template whose quantity is near the target under the gradient model.

    The quantity depends on the sites. Further random sites are tried if the heights on the first ones miss
    the target.
    """
    template, limits, best = problem.template, problem.limits, None
    spread = rng.permutation(np.linspace(limits.foot, limits.top, problem.count))
    start = Candidate(spread, template.radius, {}, problem.target.curve(), sites=np.arange(problem.count))
    more = PLACEMENTS * problem.effort.refined_restarts if problem.tools.single else 0
    for _ in each("choice of sites", range(1 + more), at_most=True):
        sites = problem.pins.placed(rng.permutation(problem.pins.template.count))
        found = _searched(problem, _nearest(problem, start, sites, rng), rng)
        best = found if best is None or found[0] < best[0] else best
        if best[0] <= NEAR * REFINED_GOAL:
            break
        start = best[1]
    assert best is not None
    candidate, near = best[1], problem.model.gradient_model
    if near != problem.model:
        note = information(f"the first heights were found under the model {near.name}, which has gradients")
        candidate = replace(candidate, notes=(*candidate.notes, note))
    if not problem.target.exact:
        return candidate
    return replace(candidate, lowest_level=float(candidate.height.min()))


def _nearest(problem: Problem, start: Candidate, sites: IntArray, rng: np.random.Generator) -> Found:
    """Return heights of independent asperities on the first of some sites, and their misfit.

    start: heights that have about the compliance of the block.
    """
    law, found, candidate = start.target_law, [], start
    alone = replace(problem, model=Independent(contact_of(problem.model)))
    area = _area(problem, start)
    for _ in range(ROUNDS):
        wanted = law.law(area)
        block = 1.0 / area - 1.0 / alone.model.curve(candidate.surface(problem.template), law.load).area
        compliance = np.maximum(1.0 / wanted - block, STIFFEST / wanted)
        target = SampledLaw(law.load, 1.0 / compliance, law.weight, of=problem.target.of)
        near = tools.candidate(replace(alone, target=target), rng, RESTARTS)
        candidate = problem.target.of_heights(problem, law, near.height, near.radius, near.cap)
        candidate = candidate.placed(sites[: len(near.height)], problem.limits.foot)
        area = _area(problem, candidate)
        found.append((law.misfit(area), candidate))
        if found[-1][0] <= CLOSE:
            break
    return min(found, key=lambda one: one[0])


def _area(problem: Problem, candidate: Candidate) -> FloatArray:
    """Return the quantity [mm] of a candidate under the gradient model at the loads of the target."""
    every, load = OnSites.of(problem, candidate), candidate.target_law.load
    found, _ = every.sensitivity(problem.model.gradient_model, load, every.whole.height)
    return found.curve.area


def _searched(problem: Problem, start: Found, rng: np.random.Generator) -> Found:
    """Return the heights found by a search under the gradient model, whose random changes add asperities."""
    misfit, candidate = start
    if misfit <= REFINED_GOAL:
        return start
    every = OnSites.of(problem, candidate)
    residual = every.residual(problem.model.gradient_model, candidate.target_law)
    found = search(residual, [every.whole.height], every.space, REFINED_GOAL, CHANGES, rng, DEFAULTS)
    return found.misfit, every.candidate(found.unknowns)
