"""Misfit between the law of a design and its target, and the resulting status."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from typing import Any

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem._values import percent
from metafem.inversion.candidate import Branch, Candidate
from metafem.inversion.problem import Problem
from metafem.inversion.search.target_law import TargetLaw
from metafem.prediction import BranchFit, default_loads, fit_branch, law_of_curve
from metafem.progress import doing
from metafem.surface import Surface

# A design is exact if the relative error of its friction is within this tolerance at each load of the target.
EXACT = 1e-9

# A search for an exact design ends at this misfit, a hundredth of `EXACT`.
POINT_GOAL = 1e-11

# A target of any shape counts as reached within this rms misfit, because manufacturing errors change a law
# about as much.
REACHED = 0.01

# The heights of a density miss their target beyond this misfit. Aymard et al. regard an error of 10 % in the
# crossover load, the largest error in their comparisons, as a success.
MISSED = 0.1

# Ratio of the last load of a design's law to the last load of the target.
LAW_END = 1.1

# Number of digits that identify any double-precision number.
MOST_DIGITS = 17

Fits = tuple[tuple[Branch, BranchFit], ...]


class DesignStatus(Enum):
    """Status of a design; the value is the message."""

    EXACT = "exact: the law meets the target to 1e-9"
    REACHED = "reached: the law meets the target within 1 %"
    WITHIN_ERRORS = "reached: the law meets the samples within 1 % and their stated errors"
    REFINED = "refined: the heights were adjusted until the law met the target within 1 %"
    APPROXIMATE = "approximate: the heights follow a density whose law has the target's slopes at large loads"
    MISSED = (
        "missed: the misfit is above 1 % (and the errors of the samples), or above 10 % for the heights of a "
        "density"
    )


@doing("computing the law of the heights")
def assess(problem: Problem, candidate: Candidate, surface: Surface) -> dict[str, Any]:
    """Return the law, fits, misfit, status and parameters of a design with the heights of a candidate.

    The model is solved once, at the loads of the law, the target and the fits together.
    """
    target_law, branches, last = candidate.target_law, candidate.branches, problem.target.last_load
    effort = problem.effort
    if last is None:
        grid = default_loads(surface, problem.model)
        grid = grid[:: -max(1, len(grid) // effort.law_points)][::-1]
    else:
        grid = LAW_END * last * np.arange(1, effort.law_points + 1) / effort.law_points
    lists = [grid, target_law.load, *(branch.load[:: effort.branch_step] for branch in branches)]
    load, (on_grid, at_target, *on_branches) = _united(lists)
    model = problem.model
    curve = model.curve(surface, load)
    shown = curve.part(on_grid, lambda: model.curve(surface, grid[-1:]).last)
    law = law_of_curve(surface, model, shown, grid)
    area = curve.checked().area
    fits = tuple(
        (branch, fit_branch(load[rows], area[rows], branch.load_range, surface.material, surface.friction))
        for branch, rows in zip(branches, on_branches, strict=True)
    )
    misfit = _misfit(candidate, area[at_target], [fit.slope for _, fit in fits])
    parameters = dict(candidate.parameters)
    if target_law.is_open:
        parameters |= problem.target.open_parameters(target_law, area[at_target])
    if candidate.unrounded is not None:
        parameters["step_loss"] = misfit - candidate.unrounded
    status = status_of(candidate, misfit)
    return {"law": law, "fits": fits, "misfit": misfit, "status": status, "parameters": parameters}


def misfit_of(candidate: Candidate, area: Callable[[FloatArray], FloatArray]) -> float:
    """Return the misfit [-] of a candidate; `area` maps rescaled loads (k,) [mm^2] to A0 (k,) [mm^2]."""
    lists = [candidate.target_law.load, *(branch.load for branch in candidate.branches)]
    load, (at_target, *on_branches) = _united(lists)
    found = area(load)
    slopes = [float(np.polyfit(load[rows], found[rows], 1)[0]) for rows in on_branches]
    return _misfit(candidate, found[at_target], slopes)


def independent_misfit(problem: Problem, candidate: Candidate) -> float:
    """Return the misfit [-] of a candidate for independent asperities; the sites do not affect it."""
    surface = candidate.surface(problem.template)
    return misfit_of(candidate, lambda load: problem.uncoupled.curve(surface, load).area)


def model_misfit(problem: Problem, candidate: Candidate) -> float:
    """Return the misfit [-] of a candidate under the model of the problem."""
    surface = candidate.surface(problem.template)
    return misfit_of(candidate, lambda load: problem.model.curve(surface, load).checked().area)


def _united(loads: list[FloatArray]) -> tuple[FloatArray, list[IntArray]]:
    """Return the sorted union of lists of loads, and for each list the indices of its loads in the union."""
    united = np.unique(np.concatenate(loads))
    return united, [np.searchsorted(united, part) for part in loads]


def misfits(
    law: TargetLaw, branches: Sequence[Branch], difference: FloatArray, slopes: FloatArray
) -> FloatArray:
    """Return the misfit [-] of each of m laws, (m,).

    The relative differences of the laws from the target are `difference` (m, k). If laws are compared
    pointwise, the misfit is the largest difference at any load, which also bounds the error of a slope.
    Otherwise it is the root mean square of the differences, or the largest relative error of a fitted slope
    if that is larger. `slopes` (m, b) are fitted to the b branches.
    """
    if law.pointwise:
        return np.asarray(np.abs(difference).max(axis=1))
    rms = np.sqrt((law.weight * difference**2).mean(axis=1))
    deviations = np.abs(slopes / np.array([branch.slope for branch in branches]) - 1.0)
    return np.asarray(np.column_stack([rms, deviations]).max(axis=1))


def _misfit(candidate: Candidate, area: FloatArray, slopes: list[float]) -> float:
    """Return the misfit [-] of a candidate from its A0 (k,) [mm^2] and the fitted slopes of its branches."""
    law, branches = candidate.target_law, candidate.branches
    return float(misfits(law, branches, law.difference(area)[None], np.array([slopes]))[0])


def misfit_text(misfit: float, digits: int = 2) -> str:
    """Return a misfit in percent, or a statement that it is within the tolerance of exact designs.

    The text has enough digits to show on which side of a limit the misfit lies: 1.003 % is not "1 %".
    """
    if misfit <= EXACT:
        return "below 1e-9"
    enough = (n for n in range(digits, MOST_DIGITS) if _above(float(f"{misfit:.{n}g}")) == _above(misfit))
    return percent(misfit, f".{next(enough, digits)}g")


def _above(misfit: float) -> list[bool]:
    """Return whether a misfit exceeds `REACHED`, and whether it exceeds `MISSED`."""
    return [misfit > limit for limit in (REACHED, MISSED)]


def status_of(candidate: Candidate, misfit: float) -> DesignStatus:
    """Return the status of a design; a misfit of nan counts as missed."""
    density = candidate.density is not None
    if not misfit <= largest_misfit(candidate.target_law, density):
        return DesignStatus.MISSED
    if misfit <= EXACT and not density:
        return DesignStatus.EXACT
    if misfit <= REACHED and candidate.moved:
        return DesignStatus.REFINED
    if density:
        return DesignStatus.APPROXIMATE
    return DesignStatus.REACHED if misfit <= REACHED else DesignStatus.WITHIN_ERRORS


def largest_misfit(law: TargetLaw, density: bool = False) -> float:
    """Return the largest misfit [-] that counts as reached, including the errors of the target."""
    return MISSED if density else REACHED + law.noise
