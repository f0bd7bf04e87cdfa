"""Design of a surface for a target law: prove, guess, search, refine, put on steps, assess."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.inversion.density import from_density
from metafem.inversion.infeasible import prove, refuse_missed
from metafem.inversion.limits import Limits
from metafem.inversion.notes import design_notes
from metafem.inversion.problem import Branch, Candidate, Parameter, Problem, misfit
from metafem.inversion.refinement import EXACT, MISSED, REACHED, inverted, refined
from metafem.inversion.result import Design, DesignStatus
from metafem.inversion.steps import on_steps
from metafem.inversion.target_law import Target, TargetLaw
from metafem.inversion.tools import Given
from metafem.models import Model
from metafem.notes import when_read
from metafem.prediction import default_loads, fit_branch, law_of_curve
from metafem.progress import doing
from metafem.surface import Surface

# Ratio of the last load of a design's law to that of the target, number of its loads, and number of a draft.
LAW_END, LAW_POINTS, DRAFT_POINTS = 1.1, 100, 25


def design(
    target: Target,
    template: Surface,
    model: Model | None = None,
    limits: Limits | None = None,
    rng: Any = 0,
    *,
    tools: Given | None = None,
) -> Design:
    """Return a design: heights, and tools if several are allowed, whose friction law meets the target.

    Parameters
    ----------
    target : OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw, MultilinearLaw or Band
        With a load range, a linear or bilinear law is a line through the origin over that range. Without one
        the heights follow a density whose law has the target slopes but its own intercept. The design has
        11 digits of each number, so that it does not depend on how these were computed.
    template : Surface
        Surface with the sites, common radius, material, friction and block. Its heights are used only for the
        default of `limits`, and its radii only if `tools` is not given.
    model : Model, optional
        Model under which the law must meet the target; default: ``Independent()``. For a model with
        interaction, the heights of independent asperities are refined under it.
    limits : Limits, optional
        Manufacturing limits; default: heights up to the tallest of the template. Over the loads of the target
        the plane does not reach the base plane.
    rng : int or numpy Generator
        Seed of the random assignment of heights to sites, and of the random changes of the search.
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity: a list of tools or of their radii [mm], or a range on its
        steps. Plain radii have the common cap of the template. The fewest tools that reach the target are
        used; heights that follow a density use one. Default: the common radius and cap of the template.

    Returns
    -------
    Design

    Raises
    ------
    Infeasible
        If no surface within the limits has the law, or no heights that meet the points were found. The
        message states the reason, and the attribute `nearest` holds the nearest reachable target, if known.
    InvalidInput
        For arguments outside their range or of the wrong kind.

    Notes
    -----
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, equations S1 to S8.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> result = mf.design(mf.LinearLaw(6.87), template)
    >>> round(result.parameters["scale"], 4), result.misfit < 0.03
    (0.0401, True)

    A local exponent below 2/3 needs two tools.

    >>> target, limits = mf.PowerLaw(0.64, (0.1, 0.2)), mf.Limits(0.27)
    >>> mf.design(target, template, limits=limits, tools=[0.2, 0.8]).parameters["used_radii"]
    array([0.2, 0.8])

    Site 9 has a summit of 0.1 mm, and site 3 has no asperity.

    >>> limits = mf.Limits(0.12, pinned={9: 0.1, 3: None})
    >>> result = mf.design(mf.PowerLaw(0.9, (0.1, 0.2)), template, limits=limits)
    >>> result.surface.height[result.sites == 9], 3 in result.sites, result.misfit < 0.01
    (array([0.1]), False, True)
    """
    problem, generator = Problem.checked(target, template, model, limits, tools), check.generator(rng)
    with doing("inverting the law"):
        if problem.law is None:
            candidate = from_density(problem, generator)
        else:
            prove(problem)
            candidate = inverted(problem, generator)
    if refinable(problem, candidate):
        candidate = refined(problem, candidate, generator)
    if problem.limits.height_step is not None:
        candidate = on_steps(problem, candidate, generator)
    return assessed(problem, candidate)


def refinable(problem: Problem, candidate: Candidate) -> bool:
    """Return whether heights are refined: under interaction, or if they follow a density and miss its law.

    The law of a density is that of Hertz contacts.
    """
    if problem.model.couples or candidate.density is None:
        return problem.model.couples
    if problem.tools.law.power != 2.0:
        return True
    return not candidate.stepped and misfit(problem, candidate.asperities, candidate.law) > MISSED


@doing("computing the law of the heights")
def assessed(problem: Problem, candidate: Candidate) -> Design:
    """Return the design of a candidate: its law, its misfit, its status and the notes on it.

    The model is solved once, at the loads of the law, the target and the fits together.
    """
    surface, law, model = problem.surface(candidate.asperities), candidate.law, problem.model
    points, last = DRAFT_POINTS if problem.draft else LAW_POINTS, problem.target.last_load
    if last is None:
        grid = default_loads(surface, model)
        grid = grid[:: -max(1, len(grid) // points)][::-1]
    else:
        grid = LAW_END * last * np.arange(1, points + 1) / points
    loads = [grid, law.load, *(branch.load for branch in candidate.branches)]
    load = np.unique(np.concatenate(loads))
    on_grid, at_target, *on_branches = (np.searchsorted(load, part) for part in loads)
    curve = model.curve(surface, load)
    shown = curve.part(on_grid, lambda: model.curve(surface, grid[-1:]).last)
    found = law_of_curve(surface, model, shown, grid)
    area = curve.checked().area
    fits = tuple(
        (branch, fit_branch(load[rows], area[rows], branch.load_range, surface.material, surface.friction))
        for branch, rows in zip(candidate.branches, on_branches, strict=True)
    )
    slopes = np.array([[fit.slope for _, fit in fits]])
    size = float(misfits(law, candidate.branches, law.difference(area[at_target])[None], slopes)[0])
    # the range of a density ends where the plane reaches its foot
    touching = last is not None and (curve.approach[at_target] > surface.height.max()).any()
    if not size <= REACHED + law.noise and candidate.density is None:
        refuse_missed(problem, area[at_target])
    result = Design(
        surface=surface, law=found, misfit=size, status=_status(candidate, size, touching),
        parameters=_parameters(problem, candidate, area[at_target]), sites=candidate.asperities.sites,
        target=problem.target, template=problem.template, limits=problem.limits, fits=fits,
        density=candidate.density, tools=problem.tools.given, pinned=problem.pinned,
    )  # fmt: skip
    notes = when_read(design_notes, problem, candidate, result, size=surface.count + len(grid))
    return replace(result, notes=notes)


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


def _status(candidate: Candidate, misfit: float, touching: bool) -> DesignStatus:
    """Return the status of a design; a misfit of nan counts as missed."""
    density = candidate.density is not None
    if touching or not misfit <= (MISSED if density else REACHED + candidate.law.noise):
        return DesignStatus.MISSED
    if misfit <= EXACT and not density:
        return DesignStatus.EXACT
    if misfit <= REACHED and candidate.refined:
        return DesignStatus.REFINED
    if density:
        return DesignStatus.ADJUSTED if candidate.refined else DesignStatus.APPROXIMATE
    return DesignStatus.REACHED if misfit <= REACHED else DesignStatus.WITHIN_ERRORS


def _parameters(problem: Problem, candidate: Candidate, area: FloatArray) -> dict[str, Parameter]:
    """Return the quantities that the inversion found."""
    found: dict[str, Parameter] = {**candidate.found, **candidate.parameters}
    some = candidate.asperities.sites
    if candidate.density is None and not candidate.parameters:
        found = {"span": float(np.ptp(candidate.asperities.height[some])), **found}
    if candidate.law.is_open:
        free = candidate.law.open_parameters(area)
        found[problem.target.free_name] = float(free[0]) if problem.target.free_name == "prefactor" else free
    if candidate.unrounded is not None:
        found["step_loss"] = candidate.law.misfit(area) - candidate.unrounded
    return found | problem.tools.counts(candidate.asperities.tool[some])
