"""Asperities made by tools of several shapes, by one tool if one reaches the target."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from metafem.errors import Infeasible, InvalidInput
from metafem.inversion.assessment import EXACT, POINT_GOAL, independent_misfit
from metafem.inversion.search.mixed_tools import ToolSearch
from metafem.inversion.search.nearest_law import GOAL
from metafem.inversion.targets.target import LEVEL_FRACTIONS
from metafem.inversion.targets.wording import Message
from metafem.inversion.tools.kit import Kit

# Misfit of heights without levels at which the search with one tool ends; mixtures follow.
FIRST = (1e-2,)

# Misfit at which the search for tools ends if the law must be exact; a descent of the heights follows.
ENOUGH = 1e-4

if TYPE_CHECKING:
    from metafem.inversion.candidate import Candidate
    from metafem.inversion.problem import Problem
    from metafem.inversion.tools.tool import Tool


def candidate(problem: Problem, rng: np.random.Generator, restarts: int | None = None) -> Candidate:
    """Return the heights of independent asperities whose law is nearest to the target, with their caps."""
    kit = problem.tools
    if not isinstance(kit, Kit):
        return problem.target.candidate(problem, rng, restarts)
    singles, refused = _singles(problem, kit, rng)
    try:
        law = problem.target.curve()
    except InvalidInput:  # the law is that of a height density
        law = None
    target = problem.target
    goal = EXACT if target.exact else GOAL
    best = min(singles, key=lambda found: found[0], default=None)
    if best is not None and (law is None or best[0] <= goal):
        return best[1]
    if law is None:
        raise unreachable(refused)
    most = problem.restarts if restarts is None else restarts
    guesses = target.guesses(law, problem.bounds, LEVEL_FRACTIONS)
    ends = (ENOUGH, POINT_GOAL) if target.exact else (GOAL,)
    search = ToolSearch(problem, kit, law, guesses, most, rng, *ends)
    misfit, height, radius, cap = search.nearest()
    if best is not None and best[0] <= misfit:
        return best[1]
    mixed = target.of_heights(problem, law, problem.limits.top + height, radius, cap)
    if not target.exact:
        return mixed
    return replace(mixed, refusal=_not_met, lowest_level=float(mixed.height.min()))


def _not_met() -> Infeasible:
    return Infeasible(
        "no tools and heights that meet the points within 1 % were found; use more tools or a wider range, "
        "or raise max_height",
        by_search=True,
    )


def _singles(
    problem: Problem, kit: Kit, rng: np.random.Generator
) -> tuple[list[tuple[float, Candidate]], dict[Tool, Infeasible]]:
    """Return misfits and candidates of each tool alone, and the reasons of the tools without a candidate.

    The list ends with the first tool that reaches the target.
    """
    found: list[tuple[float, Candidate]] = []
    refused: dict[Tool, Infeasible] = {}
    for tool in kit.tools:
        alone = problem.alone(tool)
        alone = replace(
            alone, effort=replace(alone.effort, restarts=0, free_goals=FIRST, adhesive_restarts=0)
        )
        try:
            problem.target.refuse(alone, 0.0)
            one = problem.target.candidate(alone, rng, 0)
        except Infeasible as reason:
            refused[tool] = reason
            continue
        misfit = independent_misfit(alone, one)
        found.append((misfit, replace(one, cap=tool.cap)))
        if misfit <= (EXACT if problem.target.exact else GOAL):
            break
    return found, refused


def unreachable(refused: dict[Tool, Infeasible]) -> Infeasible:
    """Return the error that no tool reaches a target, with the reasons of the first and the last."""
    parts: list[object] = ["no tool reaches the target"]
    ends = list(dict.fromkeys((next(iter(refused)), list(refused)[-1])))
    for sign, tool in zip(":;", ends, strict=False):
        parts += [f"{sign} with {tool!r}, ", refused[tool].message]
    by_search = any(reason.by_search for reason in refused.values())
    return Infeasible(Message(parts), refused[ends[0]].nearest, by_search)
