"""Heights for laws of any shape: samples, powers, lines, and straight branches with free intercepts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem.inversion.candidate import Branch, Candidate, Parameter
from metafem.inversion.search.nearest_law import GOAL, LawSearch, nearest_law

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem
    from metafem.inversion.targets.target import Target


# If the level of the target is free, levels at these fractions of the feasible range (of its logarithm) are
# tried.
LEVEL_FRACTIONS = (0.5, 0.25, 0.75, 0.1, 0.9)


def candidate(
    target: Target, problem: Problem, rng: np.random.Generator, restarts: int | None = None
) -> Candidate:
    """Return heights and radii whose independent law is nearest to the target."""
    law, limits = target.curve(), problem.limits
    guesses = target.guesses(law, problem.bounds, LEVEL_FRACTIONS)
    most = problem.effort.restarts if restarts is None else restarts
    task = LawSearch(
        problem.independent, law.load, law.late_residual, guesses, problem.count, limits.span, most, rng,
        GOAL, problem.options,
    )  # fmt: skip
    height, radius = nearest_law(task, problem.radii).sorted
    parameters: dict[str, Parameter] = {"span": float(-height[-1])}
    if law.is_open:
        area = problem.independent.curve_of(height, radius, law.load).area
        parameters |= target.open_parameters(law, area)
    branches = tuple(
        # a line is fixed, and its friction at zero load is the intercept
        Branch(
            slope,
            ends,
            None if law.is_open else float(np.interp(ends[0], law.load, law.base)) - slope * ends[0],
        )
        for slope, ends in target.branches
    )
    return Candidate(limits.offset + limits.max_height + height, radius, parameters, law, branches)
