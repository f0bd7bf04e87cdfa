"""Design of a surface for a target law: prove, guess, search, refine, put on steps, assess."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import percent
from metafem.caps import Power
from metafem.contact import Contact
from metafem.errors import Infeasible, refuse_if
from metafem.inversion.bounds import ROUNDING
from metafem.inversion.from_density import from_density
from metafem.inversion.infeasible import achievable_friction_coefficients, nearest_law, prove, remedies
from metafem.inversion.laws import Target
from metafem.inversion.limits import Limits
from metafem.inversion.problem import Branch, Candidate, Parameter, Problem, misfit
from metafem.inversion.refinement import EXACT, MISSED, REACHED, inverted, refined, unmet
from metafem.inversion.result import DOUBT, Design, DesignStatus, misfit_text
from metafem.inversion.search import GOAL, PEAK
from metafem.inversion.steps import on_steps
from metafem.inversion.target_law import TargetLaw
from metafem.inversion.tools import Given, PowerRange
from metafem.models import Curve, Independent, Interacting, Model
from metafem.models.model import PARABOLOID, checked_contact, contact_of
from metafem.notes import Level, Note, information, when_read
from metafem.prediction import default_loads, fit_branch, law_of_curve
from metafem.progress import doing
from metafem.substrate import BondedLayer, HalfSpace
from metafem.surface import Surface

# Ratio of the last load of a design's law to that of the target, number of its loads, and number of a draft.
LAW_END, LAW_POINTS, DRAFT_POINTS = 1.1, 100, 25

# If a design uses more radii of a range than this, only the smallest and the largest are stated.
MOST_LISTED = 8

# Each height should be at least this many standard deviations of the height errors.
HEIGHT_TO_ERROR = 10.0

# Name of the number of summits below that.
LOW = "summits lower than the errors of their heights allow"

# The heights use the whole allowed range if they leave less than this fraction unused.
ALL_OF_IT = 1e-6

# A range of loads is sought between these loads over the largest one, of this number, by this number of
# bisections on a logarithmic scale. Between the loads of the first contacts, a law differs from the line by
# 1.1 % if the range begins where one asperity has the friction of the line, and by .7 % from RANGE_START
# times that load on (measured; by scaling, the differences do not depend on slope and radius).
LEAST_LOAD, TRIED_LOADS, BISECTIONS, RANGE_START = 1e-8, 2000, 6, 1.4

# A design is judged by order 3 as well up to this number of asperities, which takes about a second.
JUDGED = 1000


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
        the heights follow a density whose law has the target slopes but its own intercept.
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
    try:
        prove(problem, REACHED)
    except Infeasible as reason:
        raise _with_hints(problem, reason) from None
    with doing("inverting the law"):
        find = from_density if problem.law is None else inverted
        candidate = find(problem, generator)
    candidate = refined(problem, candidate, generator)
    candidate = on_steps(problem, candidate, generator)
    return assessed(problem, candidate)


def _with_hints(problem: Problem, reason: Infeasible) -> Infeasible:
    """Return the refusal of a target with remedies, and with a nearest target that a design meets."""
    problem = replace(problem, draft=False)  # so that a draft and its design are told the same
    line: Any = problem.target
    nearest: Any = reason.nearest
    words = f"{reason}{remedies(problem, _meets)}"
    if line.lines:
        given = problem.template, problem.limits, problem.tools.argument, problem.uncoupled.contact
        try:
            ends = achievable_load_range(line, *given)
        except Infeasible:
            return Infeasible(words)
        inside = line.wording.inside(*ends)
        return Infeasible(f"{words}; the line is reached from {inside}", replace(line, load_range=ends))
    if nearest is None or not _meets(replace(problem, target=nearest)):
        law, found = problem.law, inverted(problem, np.random.default_rng(0))
        nearest = line.near(
            law.load, problem.uncoupled.curve(problem.surface(found.asperities), law.load).area
        )
        if line.free_name and nearest is not None and not _meets(replace(problem, target=nearest)):
            nearest = None
    return Infeasible(words, nearest)


def _meets(problem: Problem) -> bool:
    """Return whether independent asperities of a problem that was changed by a hint meet its target."""
    if nearest_law(problem.law, problem.bounds)[0] > ROUNDING:
        return False
    found = inverted(problem, np.random.default_rng(0), PEAK * REACHED)
    size = misfit(problem, found.asperities, problem.law, problem.uncoupled)
    return size <= (EXACT if problem.target.exact else REACHED)


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
    load, (on_grid, at_target, *on_branches) = _united(
        [grid, law.load, *(b.load for b in candidate.branches)]
    )
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
    parameters = _parameters(problem, candidate, surface, area[at_target], size)
    status = _status(problem, candidate, size, _touching(surface, curve, at_target, last))
    _refuse_missed(problem, law, area[at_target], size)
    result = Design(
        surface=surface, law=found, misfit=size, status=status, parameters=parameters,
        sites=candidate.asperities.sites, target=problem.target, template=problem.template,
        limits=problem.limits, fits=fits, density=candidate.density, tools=problem.tools.argument,
        pinned=problem.pinned,
    )  # fmt: skip
    return replace(
        result, notes=when_read(design_notes, problem, candidate, result, size=surface.count + len(grid))
    )


def _united(loads: list[FloatArray]) -> tuple[FloatArray, list[IntArray]]:
    """Return the sorted union of lists of loads, and for each list the indices of its loads in the union."""
    united = np.unique(np.concatenate(loads))
    return united, [np.searchsorted(united, part) for part in loads]


def _touching(surface: Surface, curve: Curve, rows: IntArray, last: float | None) -> bool:
    """Return whether the plane would reach the base plane at loads of the target."""
    if last is None:  # the range of a density ends where the plane reaches its foot
        return False
    return bool((curve.approach[rows] > float(surface.height.max())).any())


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


def _status(problem: Problem, candidate: Candidate, misfit: float, touching: bool) -> DesignStatus:
    """Return the status of a design; a misfit of nan counts as missed."""
    density = candidate.density is not None
    if touching or not misfit <= (MISSED if density else REACHED + candidate.law.noise):
        return DesignStatus.MISSED
    if misfit <= EXACT and not density:
        return DesignStatus.EXACT
    if misfit <= REACHED and candidate.refined:
        return DesignStatus.REFINED
    if density:
        return DesignStatus.APPROXIMATE
    return DesignStatus.REACHED if misfit <= REACHED else DesignStatus.WITHIN_ERRORS


def _refuse_missed(problem: Problem, law: TargetLaw, area: FloatArray, misfit: float) -> None:
    """Raise Infeasible for points, samples outside the bounds, or a band, that the law misses.

    Heights on steps, and other heights beside given ones, are only missed.
    """
    target = problem.target
    free = problem.limits.height_step is None and not problem.held
    if misfit <= REACHED + law.noise or not target.refused or not free:
        return
    if target.exact:
        raise unmet(problem, area)
    distance, friction = nearest_law(law, problem.bounds)
    if law.is_band:
        i = int(np.abs(law.difference(area)).argmax())
        raise Infeasible(
            f"no law within the band was found: at load {target.wording.loads(law.load[i])} the nearest law "
            f"found is outside by {percent(misfit, '.3g')}",
            target.near(law.load, area), by_search=True,
        )  # fmt: skip
    if distance > problem.margin + GOAL:
        most = percent(REACHED + law.noise, ".3g")
        raise Infeasible(
            f"the samples lie outside the bounds of {problem.count} asperities of {problem.tools} by up to "
            f"{percent(distance, '.3g')}; the nearest law found misses them by {percent(misfit, '.3g')} rms, "
            f"and at most {most} is allowed",
            target.near(law.load, area), by_search=law.misfit(friction) <= REACHED + law.noise,
        )  # fmt: skip


def _parameters(
    problem: Problem, candidate: Candidate, surface: Surface, area: FloatArray, misfit: float
) -> dict[str, Parameter]:
    """Return the quantities that the inversion found."""
    found: dict[str, Parameter] = {**candidate.found, **candidate.parameters}
    if candidate.density is None and not candidate.parameters:
        found = {"span": float(np.ptp(surface.height)), **found}
    if candidate.law.is_open:
        free = candidate.law.open_parameters(area)
        found[problem.target.free_name] = float(free[0]) if problem.target.free_name == "prefactor" else free
    if candidate.unrounded is not None:
        found["step_loss"] = misfit - candidate.unrounded
    return found | (_tools_in_use(problem, surface) if problem.tools.given is not None else {})


def _tools_in_use(problem: Problem, surface: Surface) -> dict[str, Parameter]:
    """Return the parameters that state the tools of a surface, and the friction coefficients they allow."""
    tools = problem.tools
    if isinstance(tools.given, PowerRange):
        made = Counter(
            cap.exponent for i in range(surface.count) if isinstance(cap := surface.cap.one(i), Power)
        )
        used = sorted(made)
        return {"used_exponents": np.array(used), "exponent_counts": np.array([made[n] for n in used])}
    if not tools.same_shape:
        pairs = Counter((surface.radius[i], surface.cap.one(i)) for i in range(surface.count))
        return {"tool_counts": np.array([pairs[tool.radius, tool.cap] for tool in tools.all])}
    used_radii, counts = np.unique(surface.radius, return_counts=True)
    parameters: dict[str, Parameter] = {"used_radii": used_radii, "radius_counts": counts.astype(np.int64)}
    if tools.ordered and len(used_radii) > MOST_LISTED:
        parameters = {"lowest_radius": float(used_radii[0]), "highest_radius": float(used_radii[-1])}
    if problem.template.friction is not None and tools.law.without_adhesion.power == 2.0:
        given = problem.limits, tools.argument, contact_of(problem.model)
        reach = np.array(achievable_friction_coefficients(problem.template, *given))
        if np.isfinite(reach).all():
            parameters["reachable_coefficients"] = reach
    return parameters


def design_notes(problem: Problem, candidate: Candidate, found: Design) -> tuple[Note, ...]:
    """Return all notes on a design: the doubt of the next better model, then others."""
    limits, surface, before = problem.limits, found.surface, candidate.unrounded
    notes = [*_doubt(problem, candidate, found), *candidate.notes]
    if before is not None:
        aside = f"; a smaller height_step brings it below {percent(REACHED, 'g')}"
        notes.append(
            information(
                f"heights are on steps of {1e3 * (limits.height_step or 0.0):.4g} um: the misfit is "
                f"{misfit_text(found.misfit, 3)}; before rounding to them it was {misfit_text(before, 3)}"
                f"{aside if found.misfit > REACHED >= before else ''}"
            )
        )
    allowed = limits.span if limits.height_step is None else float(np.ptp(limits.levels))
    full = float(np.ptp(surface.height)) >= allowed * (1.0 - ALL_OF_IT)
    if full and found.status is DesignStatus.MISSED and not (before is not None and before <= REACHED):
        words = f"the heights use the whole allowed range of {allowed:g} mm: raise max_height"
        notes.append(Note(words, remedies=("max_height",)))
    low = 0 if limits.height_sd is None else int((surface.height < HEIGHT_TO_ERROR * limits.height_sd).sum())
    if low:
        words = f"{low} of {surface.count} summits are lower than {HEIGHT_TO_ERROR:g} times height_sd"
        text = f"{words} = {limits.height_sd:g} mm: raise the offset"
        notes.append(Note(text, quantity=LOW, value=low, bound=0.0, remedies=("offset",)))
    if found.misfit > REACHED:
        notes += _missed(problem, candidate, found)
    if found.misfit > REACHED and problem.held:
        many = (
            "the height of 1 site is"
            if len(problem.held) == 1
            else f"the heights of {len(problem.held)} sites are"
        )
        words = f"{many} given, and the misfit is {misfit_text(found.misfit)}: give others, or fewer"
        notes.append(Note(words, quantity="misfit", value=found.misfit, bound=REACHED, remedies=("pinned",)))
    if problem.target.refused and not problem.target.exact and not candidate.law.is_band:
        notes += _outside(problem, candidate.law)
    return tuple(dict.fromkeys((*notes, *found.law.notes)))


def _doubt(problem: Problem, candidate: Candidate, found: Design) -> list[Note]:
    """Return a note if a design that meets its target misses it under the next better model."""
    model, surface, law = problem.model, found.surface, candidate.law
    met = found.status is not DesignStatus.MISSED
    on_block = problem.template.block is not None
    better = (
        model.reference
        if not on_block
        else Interacting(model.reference.order, BondedLayer(), contact_of(model))
    )
    same = model.couples and (not on_block or model.reference.substrate != HalfSpace())
    if not met or same or surface.count > JUDGED or surface.count == 1 or problem.target.last_load is None:
        return []
    curve = better.curve(surface, law.load)
    if not curve.converged:
        return []
    difference = law.difference(curve.area)
    size, i = law.misfit(curve.area), int(np.abs(difference).argmax())
    if size <= found.largest_misfit:
        return []
    load = problem.target.wording.of_part(surface.material).loads(law.load[i])
    where = "on the block" if on_block else "with interaction"
    text = f"met under {model.name} asperities; {where} {percent(abs(difference[i]), '.2g')} off at {load}"
    return [Note(text, quantity=DOUBT, value=size, bound=found.largest_misfit, remedies=("model",))]


def _outside(problem: Problem, law: TargetLaw) -> list[Note]:
    """Return a note on samples that no surface meets."""
    distance, friction = nearest_law(law, problem.bounds, problem.margin)
    if distance <= ROUNDING:
        return []
    difference = np.abs(friction / law.lower - 1.0)
    most = int(difference.argmax())
    many = f"{int((difference > ROUNDING).sum())} of {len(difference)}"
    return [
        information(
            f"no surface meets all samples: {many} differ from the nearest law within the bounds, by up to "
            f"{percent(float(difference[most]))} (sample {most + 1}); the design has the least rms "
            "difference that was found"
        )
    ]


def _missed(problem: Problem, candidate: Candidate, found: Design) -> list[Note]:
    """Return notes on a missed law: that of a density, or the loads over which a line is met."""
    wording, law = problem.target.wording, candidate.law
    if candidate.density is not None:
        return [
            Note(
                f"the {found.misfit_meaning} is {misfit_text(found.misfit)}: the heights follow a density, "
                f"whose law has the {wording.name(len(found.fits))} at large loads and an intercept. "
                f"Give load_range: heights are then found with a friction within {percent(REACHED, 'g')} of "
                "the line through the origin over those loads",
                Level.INFORMATION if found.misfit <= MISSED else Level.WARNING,
                "misfit", found.misfit, MISSED, ("load_range",),
            )
        ]  # fmt: skip
    if not (candidate.branches and law.pointwise):
        return []
    within = np.abs(law.difference(found.target_area)) <= REACHED
    edges = np.flatnonzero(np.diff(np.concatenate([[False], within, [False]]).astype(np.int64)))
    runs = [(law.load[a], law.load[b - 1]) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > 1]
    widest = max(runs, key=lambda ends: ends[1] / ends[0], default=None)
    words = "nor over any part of it" if widest is None else f"from {wording.inside(*widest)} it is"
    ends = wording.loads(law.load[0], law.load[-1])
    text = f"the line is not met within {percent(REACHED, 'g')} from {ends}; {words}"
    return [Note(text, quantity="misfit", value=found.misfit, bound=REACHED, remedies=("load_range",))]


def achievable_load_range(
    target: Target,
    template: Surface,
    limits: Limits,
    tools: Given | None = None,
    contact: Contact = PARABOLOID,
) -> tuple[float, float]:
    """Return the widest range of loads over which a line through the origin is met within 1 %.

    The range is that of independent asperities and is found by trial designs. Its lower end is near the load
    at which a single asperity has the friction of the line. Ranges are narrowed towards the crossover load of
    a bilinear law, and towards the start or the end of a linear law.

    Parameters
    ----------
    target : LinearLaw or BilinearLaw
        Line through the origin. If the target has a load range, only ranges within it are tried.
    template : Surface
        Surface of which only the number of sites is used, and the common radius if `tools` is not given.
    limits : Limits
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity; default: the radius and cap of the template.
    contact : Contact
        Law of one contact; default: `Hertz()`.

    Returns
    -------
    low, high : float
        P/E* [mm^2].

    Raises
    ------
    Infeasible
        If there is no such range.
    InvalidInput
        If the target is of another kind, or an argument of `design` would be refused.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.27, radius=0.526, material=mf.Material(1.36))
    >>> line, limits = mf.LinearLaw(7.0), mf.Limits(0.27)
    >>> ends = achievable_load_range(line, template, limits)
    >>> mf.design(mf.LinearLaw(7.0, ends), template, limits=limits).misfit < 0.01
    True
    """
    problem = Problem.checked(target, template, Independent(contact=checked_contact(contact)), limits, tools)
    problem = replace(problem, draft=False)  # so that a draft and its design are told the same
    line: Any = problem.target
    refuse_if(not target.lines, f"target = {target!r:.60} must be a metafem.LinearLaw or BilinearLaw")
    most = replace(problem.bounds, last=0.0).largest_load(limits)
    load = most * np.geomspace(LEAST_LOAD, 1.0, TRIED_LOADS)
    low, high = problem.bounds.friction(load)
    friction, crossover = line.line(load), target.lines[-1][1]
    within = (friction >= low) & (friction <= high)
    if line.load_range is not None:
        within &= (load >= line.load_range[0]) & (load <= line.load_range[1])
    best, widest = None, 1.0
    if within.any():
        first, last = load[within][0] * RANGE_START, load[within][-1]
        for centre in (crossover,) if crossover else (first, last):
            inside, outside = 0.0, 1.0
            for _ in range(BISECTIONS if first < last and first <= centre <= last else 0):
                part = 0.5 * (inside + outside)
                ends = centre * (first / centre) ** part, centre * (last / centre) ** part
                trial = replace(problem, target=replace(line, load_range=ends))
                reached = nearest_law(trial.law, trial.bounds)[0] <= ROUNDING and _meets(trial)
                inside, outside = (part, outside) if reached else (inside, part)
                if reached and ends[1] / ends[0] > widest:
                    best, widest = ends, ends[1] / ends[0]
    if best is None:
        raise Infeasible(
            f"{target.title}: the line through the origin is not reached within {percent(REACHED, 'g')} over "
            f"any range of loads with {problem.count} asperities of {problem.tools} within {limits.span:g} "
            f"mm of height; raise max_height or the {target.wording.name()}, or use a smaller radius"
        )
    return best
