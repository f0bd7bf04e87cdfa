"""Exponents and heights of power caps, corrected for interaction before the heights alone are refined.

The friction A0(model)/A0(independent) is a smooth function of the load that changes little with the heights
and exponents, if the heights of independent asperities are shifted so that each summit first touches at the
same loads. The target divided by this ratio is therefore a new target for independent asperities.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from metafem.errors import InvalidInput
from metafem.inversion.adjustment.refinement import REFINED_GOAL, shift
from metafem.inversion.candidate import Candidate, below_limit
from metafem.inversion.problem import Problem
from metafem.inversion.search.mixed_tools import ToolSearch
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.tools.kit import Kit
from metafem.progress import doing

# Number of corrections; each reduces the error by about the change of the ratio.
CORRECTIONS = 4


def corrected(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate with the exponents of a range and the heights corrected for interaction.

    Candidates of other tools, of a height density, of other quantities and on height steps do not change.
    """
    kit, model, law = problem.tools, problem.model.gradient_model, candidate.target_law
    ranged = isinstance(kit, Kit) and kit.range is not None
    if (
        not (ranged and problem.model.couples)
        or problem.first_under_model
        or candidate.density is not None
        or candidate.stepped
    ):
        return candidate
    assert isinstance(kit, Kit)
    best, least = candidate, np.inf
    with doing("correcting the exponents for interaction"):
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
            search = ToolSearch(problem, kit, divided, [divided.base], 0, rng)
            found = search.around(candidate.height, surface)
            heights = problem.limits.top + found[0] - found[0].max()
            candidate = replace(candidate, height=heights, cap=found[1], moved=True)
    return best
