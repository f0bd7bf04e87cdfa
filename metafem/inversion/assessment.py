"""Difference of a law from the target, and the status that follows from it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem._values import percent
from metafem.inversion.candidate import Branch, Candidate, Parameter
from metafem.inversion.problem import Problem
from metafem.inversion.targets.target_law import TargetLaw
from metafem.models import Independent, Model
from metafem.prediction import BranchFit, FrictionLaw, default_loads, fit_branch, law_of_curve
from metafem.progress import doing
from metafem.surface import Surface

# Tolerance of an exact design: relative error of the friction at each load of the target.
EXACT = 1e-9

# A law of any shape counts as reached within this rms: manufacturing errors change the law by as much.
REACHED = 0.01

# A straight branch with few asperities misses its target beyond this misfit. Aymard et al. count 10 % on the
# crossover load, the largest difference in their comparisons, as a success.
MISSED = 0.1

# The law of a design ends at this multiple of the last load of the target, and has this many loads.
LAW_END, LAW_POINTS = 1.1, 100

Fits = tuple[tuple[Branch, BranchFit], ...]


class DesignStatus(Enum):
    """How a design ended; the value is the message."""

    EXACT = "exact: the law meets the target to 1e-9"
    REACHED = "reached: the law meets the target within 1 %"
    REFINED = "refined: the heights were adjusted until the law met the target within 1 %"
    APPROXIMATE = "approximate: the heights follow a density whose law has the target's slopes at large loads"
    ROBUST = "robust: the made surface has the least expected misfit; the exact heights miss by more than 1 %"
    # in results of earlier versions alone
    UNCORRECTED = "uncorrected: designed for independent asperities; this model's law has the misfit"
    MISSED = "missed: the misfit is above 1 %, or above 10 % for the heights of a density"


@dataclass(frozen=True, eq=False)
class Assessment:
    """The law of a candidate under the model of its problem, and what follows from it."""

    law: FrictionLaw
    fits: Fits
    misfit: float
    status: DesignStatus
    parameters: dict[str, Parameter]


@doing("computing the law of the heights")
def assess(problem: Problem, candidate: Candidate, surface: Surface) -> Assessment:
    """Return the assessment of a candidate; one curve holds the loads of the law, the target and the fits."""
    target_law, branches, last = candidate.target_law, candidate.branches, problem.target.last_load
    if last is None:
        grid = default_loads(surface, problem.model)
    else:
        grid = LAW_END * last * np.arange(1, LAW_POINTS + 1) / LAW_POINTS
    lists = [grid, target_law.load, *(branch.load for branch in branches)]
    load, (on_grid, at_target, *on_branches) = _united(lists)
    curve = problem.model.curve(surface, load)
    shown = curve.part(on_grid, lambda: problem.model.curve(surface, grid[-1:]).last)
    law = law_of_curve(surface, problem.model, shown, grid)
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
    return Assessment(law, fits, misfit, status_of(candidate, misfit), parameters)


def misfit_of(candidate: Candidate, area: Callable[[FloatArray], FloatArray]) -> float:
    """Return the misfit of a candidate from its law A0 as a function of rescaled loads (k,) [mm^2]."""
    lists = [candidate.target_law.load, *(branch.load for branch in candidate.branches)]
    load, (at_target, *on_branches) = _united(lists)
    found = area(load)
    slopes = [float(np.polyfit(load[rows], found[rows], 1)[0]) for rows in on_branches]
    return _misfit(candidate, found[at_target], slopes)


def independent_misfit(candidate: Candidate, model: Independent) -> float:
    """Return the misfit of independent asperities; it does not depend on the sites."""
    height, radius = candidate.height, candidate.radius
    return misfit_of(candidate, lambda load: model.curve_of(height, radius, load).area)


def model_misfit(candidate: Candidate, surface: Surface, model: Model) -> float:
    """Return the misfit of a candidate's surface under a model."""
    return misfit_of(candidate, lambda load: model.curve(surface, load).checked().area)


def _united(loads: list[FloatArray]) -> tuple[FloatArray, list[IntArray]]:
    """Return all loads once, increasing, and the rows of each list in them."""
    united = np.unique(np.concatenate(loads))
    return united, [np.searchsorted(united, part) for part in loads]


def misfits(
    law: TargetLaw, branches: Sequence[Branch], difference: FloatArray, slopes: FloatArray
) -> FloatArray:
    """Return the largest relative difference (m, k) of each law from the target or of a fitted slope, (m,).

    Where laws are compared pointwise, the deviation of a law is its largest at any load, which bounds the
    slopes. Otherwise it is the root mean square. slopes: (m, b), fitted to each branch.
    """
    if law.pointwise:
        return np.asarray(np.abs(difference).max(axis=1))
    rms = np.sqrt((law.weight * difference**2).mean(axis=1))
    deviations = np.abs(slopes / np.array([branch.slope for branch in branches]) - 1.0)
    return np.asarray(np.column_stack([rms, deviations]).max(axis=1))


def _misfit(candidate: Candidate, area: FloatArray, slopes: list[float]) -> float:
    """Return the misfit of a candidate whose law is A0 (k,), with the slopes of its branches."""
    law, branches = candidate.target_law, candidate.branches
    return float(misfits(law, branches, law.difference(area)[None], np.array([slopes]))[0])


def misfit_text(misfit: float) -> str:
    """Return a misfit in percent, or that it is within the tolerance of exact designs."""
    return "below 1e-9" if misfit <= EXACT else percent(misfit)


def misfit_meaning(pointwise: bool, density: bool, fits: Fits, misfit: float) -> str:
    """Return in words which of these deviations the misfit is."""
    if pointwise:
        return "largest difference from the target"
    if fits and misfit <= max(abs(fit.slope / branch.slope - 1.0) for branch, fit in fits):
        return "difference of a fitted slope from the target's"
    return f"rms difference from {'the law of the height density' if density else 'the target'}"


def status_of(candidate: Candidate, misfit: float) -> DesignStatus:
    """Return how a design ended; a misfit of nan counts as missed."""
    density = candidate.density is not None
    if not misfit <= (MISSED if density else REACHED):
        return DesignStatus.ROBUST if candidate.robust else DesignStatus.MISSED
    if misfit <= EXACT and not density:
        return DesignStatus.EXACT
    if misfit <= REACHED and candidate.moved:
        return DesignStatus.REFINED
    return DesignStatus.APPROXIMATE if density else DesignStatus.REACHED
