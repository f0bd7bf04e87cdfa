"""Refusals of targets that no surface reaches, with remedies and the nearest target, and what is reached."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.contact import Contact
from metafem.errors import Infeasible, MetafemWarning, refuse_if
from metafem.inversion.bounds import ROUNDING, Bounds, nearest_law
from metafem.inversion.laws import SampledLaw
from metafem.inversion.levels import levels_through, missing_height
from metafem.inversion.limits import Limits
from metafem.inversion.problem import Problem, misfit
from metafem.inversion.refinement import EXACT, REACHED, inverted
from metafem.inversion.search import GOAL, PEAK
from metafem.inversion.target_law import Target
from metafem.inversion.tools import Given, Tool, Tools
from metafem.models import Independent
from metafem.models.model import PARABOLOID, checked_contact
from metafem.surface import Surface

# Plasticity index below which contacts are mostly elastic, according to Greenwood and Williamson.
ELASTIC_LIMIT = 0.6

# Its name in notes and figures.
INDEX = "plasticity index"

# A nearest law is inside its bounds by this part of its distance from the target.
INSIDE = 1e-3

# Factors of the number of sites, and of the radius and its inverse, among which a hint is looked for; and
# largest number of those within the bounds of which the first is stated with which a design meets the target.
FACTORS, TRIED = np.geomspace(1.02, 30.0, 30).tolist(), 4

# A range of loads is sought between these loads over the largest one, of this number, by this number of
# bisections on a logarithmic scale. Between the loads of the first contacts, a law differs from the line by
# 1.1 % if the range begins where one asperity has the friction of the line, and by .7 % from RANGE_START
# times that load on (measured; by scaling, the differences do not depend on slope and radius).
LEAST_LOAD, TRIED_LOADS, RANGE_BISECTIONS, RANGE_START = 1e-8, 2000, 6, 1.4

# An end of a range that is stated with six digits is inside it by this relative distance.
STATED = 1e-5


def prove(problem: Problem) -> None:
    """Raise Infeasible if the target exceeds a proven bound by more than the interaction can change.

    Samples whose rms difference may be within the tolerance of a design are not excluded.
    """
    law, target, margin, count = problem.law, problem.target, problem.margin, problem.count
    last, most = float(law.load[-1]), problem.bounds.largest_load(problem.limits)
    if last > most * (1.0 + margin):
        loads = target.wording.loads(last), target.wording.loads(most)
        raise _refused(
            problem,
            f"load {loads[0]} is beyond {loads[1]}, at which the glass reaches the base plane with {count} "
            "summits of the largest height; raise max_height or offset, or use more asperities",
        )
    samples = target.refused and not target.exact and not law.is_band
    allowed = ROUNDING + (REACHED * math.sqrt(len(law.load) / law.weight.min()) if samples else 0.0)
    if law.noise or nearest_law(law, problem.bounds)[0] <= allowed:
        return
    distance, friction = nearest_law(law, problem.bounds, margin)
    if distance <= allowed:
        return
    extra = f" (the model's interaction leaves a margin of {percent(margin)})" if margin else ""
    inside = friction if law.is_open else friction + INSIDE * (friction - law.law(friction))
    raise _refused(problem, f"{_broken(problem, friction)}, for {_scope(problem)}{extra}", inside)


def _scope(problem: Problem) -> str:
    return f"any surface of at most {problem.count} asperities of {problem.tools}"


def _broken(problem: Problem, friction: FloatArray) -> str:
    """Return which bound a target breaks, at the load of the largest difference from the nearest law."""
    law, wording, bounds = problem.law, problem.target.wording, problem.bounds
    difference = np.abs(law.difference(friction))
    i = int(difference.argmax())
    load, far = wording.loads(law.load[i]), percent(float(difference[i]), ".3g")
    if law.is_open:
        return (
            f"no free parameter brings the law within the bounds: the nearest law differs by {far} at {load}"
        )
    low, high = bounds.friction(law.load[i : i + 1])
    end = law.lower[i] if law.lower[i] > friction[i] else law.upper[i]
    words = f"{'below' if end < friction[i] else 'above'} what the law at the other loads allows"
    if end < low[0]:
        words = "below that of a single asperity"
    elif end > high[0]:
        words = f"above that of {bounds.count} equal asperities"
    return (
        f"at load {load} the friction {wording.frictions(end)} is {words}, {wording.frictions(friction[i])}"
    )


def refuse_missed(problem: Problem, area: FloatArray) -> None:
    """Raise Infeasible if the nearest law found misses a target, (k,) [mm^2].

    Samples within the bounds are only missed, and a power law for whose exponent a bound is proven. So are
    heights on steps, and other heights beside given ones.
    """
    target, law, limits = problem.target, problem.law, problem.limits
    distance, friction = nearest_law(law, problem.bounds)
    samples = target.refused and not target.exact and not law.is_band
    within = distance <= problem.margin + GOAL if samples else not target.refused
    if target.free_name == "prefactor" and not problem.bounds.least_exponent:
        within = False
    if within or limits.height_step is not None or problem.held:
        return
    difference = np.abs(law.difference(area))
    i = int(difference.argmax())
    load, far = target.wording.loads(law.load[i]), percent(float(difference[i]), ".3g")
    words = (
        f"no heights that meet the target were found: at load {load} the nearest law found differs by {far}"
    )
    if samples:
        words += (
            f"; the samples lie outside the bounds of {_scope(problem)} by up to {percent(distance, '.3g')}"
        )
    path = levels_through(problem.alone(0), law.load, law.lower) if target.exact else None
    if path is not None and (short := missing_height(problem, path)) > 0.0:
        heights = f"max_height = {limits.max_height:g}, min_height = {limits.min_height:g} mm and the offset"
        words += f"; {heights} leave {short:.3g} mm too little: raise max_height"
    known = law.is_open or law.misfit(friction) <= REACHED + law.noise
    near = _near(problem, area) if target.refused else SampledLaw(law.load, area, wording=target.wording)
    raise Infeasible(words, near, by_search=known)


def _refused(problem: Problem, words: str, friction: FloatArray | None = None) -> Infeasible:
    """Return the refusal of a target with remedies, and with a nearest target that a design meets.

    friction: that of the nearest law within the bounds; None if no law up to the last load is.
    """
    # a draft is told the same as its design; a search for several tools is short
    problem, target = replace(problem, draft=len(problem.tools) > 1), problem.target
    words += _remedies(problem)
    if target.lines:
        given: Any = problem.template, problem.limits, problem.tools.given, problem.uncoupled.contact
        try:
            ends = achievable_load_range(target, *given)
        except Infeasible:
            return Infeasible(words)
        stated = target.wording.loads(ends[0] * (1.0 + STATED), ends[1] * (1.0 - STATED))
        line: Any = target
        return Infeasible(f"{words}; the line is reached from {stated}", replace(line, load_range=ends))
    return Infeasible(words, None if friction is None else _nearest(problem, friction))


def _near(problem: Problem, friction: FloatArray) -> Target:
    """Return the target of the same kind, or the samples, with a friction at the loads, (k,) [mm^2]."""
    load, target = problem.law.load, problem.target
    return target.near(load, friction) or SampledLaw(load, friction, wording=target.wording)


def _nearest(problem: Problem, friction: FloatArray) -> Target:
    """Return a target near a friction (k,) [mm^2] that a design meets, or the samples of the law found."""
    near = _near(problem, friction)
    if _meets(replace(problem, target=near)):
        return near
    surface = problem.surface(inverted(problem, np.random.default_rng(0)).asperities)
    area = problem.uncoupled.curve(surface, problem.law.load).area
    near = _near(problem, area)
    samples = SampledLaw(problem.law.load, area, wording=problem.target.wording)
    return near if _meets(replace(problem, target=near)) else samples


def _meets(problem: Problem) -> bool:
    """Return whether independent asperities meet the target of a problem that was changed by a hint."""
    if not _possible(problem):
        return False
    found = inverted(problem, np.random.default_rng(0), PEAK * REACHED)
    size = misfit(problem, found.asperities, problem.law, problem.uncoupled)
    return size <= (EXACT if problem.target.exact else REACHED)


def _possible(problem: Problem) -> bool:
    """Return whether no bound excludes the target of a problem."""
    within = float(problem.law.load[-1]) <= problem.bounds.largest_load(problem.limits)
    return within and nearest_law(problem.law, problem.bounds)[0] <= ROUNDING


def _remedies(problem: Problem) -> str:
    """Return how many sites, and which radius, reach a target that a bound excludes; "" if none was found."""
    words = list[str]()
    ways: list[Callable[[Problem, float], Problem]]
    ways = [_with_count, partial(_with_radius, 1.0), partial(_with_radius, -1.0)]
    for way in ways if len(problem.tools) == 1 else ways[:1]:
        possible = (each for factor in FACTORS if _possible(each := way(problem, factor)))
        met = next((each for each in islice(possible, TRIED) if _meets(each)), None)
        if met is not None:
            radius = f"a radius of {met.tools.all[0].radius:.4g} mm"
            words.append(radius if met.count == problem.count else f"{met.count} sites in all")
    return f"; use {' or '.join(words)}" if words else ""


def _with_count(problem: Problem, factor: float) -> Problem:
    """Return the problem of independent asperities on more sites."""
    count, given = math.ceil(problem.count * factor), problem.template
    position = np.column_stack([float(given.radius.max()) * np.arange(count), np.zeros(count)])
    template = Surface(position, np.zeros(count), given.radius[0], given.material, cap=given.cap.one(0))
    return replace(problem, template=template, model=problem.uncoupled, pinned={})


def _with_radius(power: float, problem: Problem, factor: float) -> Problem:
    """Return the problem of independent asperities with another radius, rounded to four digits."""
    tool = problem.tools.all[0]
    changed = Tool(float(f"{tool.radius * factor**power:.4g}"), tool.cap)
    tools = Tools.of([changed], problem.template, problem.uncoupled.contact)
    return replace(problem, tools=tools, model=problem.uncoupled)


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
    line: Any = problem.target
    refuse_if(not target.lines, f"target = {target!r:.60} must be a metafem.LinearLaw or BilinearLaw")
    most = replace(problem.bounds, last=0.0).largest_load(limits)
    load = most * np.geomspace(LEAST_LOAD, 1.0, TRIED_LOADS)
    low, high = problem.bounds.friction(load)
    least, greatest = line.load_range or (0.0, math.inf)
    within = (low <= line.line(load)) & (line.line(load) <= high) & (load >= least) & (load <= greatest)
    best, crossover = (1.0, 1.0), target.lines[-1][1]
    if within.any():
        first, last = load[within][0] * RANGE_START, load[within][-1]
        for centre in (crossover,) if crossover else (first, last):
            inside, outside = 0.0, 1.0
            for _ in range(RANGE_BISECTIONS if first < last and first <= centre <= last else 0):
                part = 0.5 * (inside + outside)
                ends = float(centre * (first / centre) ** part), float(centre * (last / centre) ** part)
                reached = _meets(replace(problem, target=replace(line, load_range=ends)))
                inside, outside = (part, outside) if reached else (inside, part)
                best = ends if reached and ends[1] / ends[0] > best[1] / best[0] else best
    if best[0] < best[1]:
        return best
    raise Infeasible(
        f"{target.title}: the line through the origin is not reached within {percent(REACHED, 'g')} over any "
        f"range of loads with {problem.count} asperities of {problem.tools} within {limits.span:g} mm of "
        f"height; raise max_height or the {target.wording.name()}, or use a smaller radius"
    )


def feasible_region(
    template: Surface,
    rescaled_load: ArrayLike,
    limits: Limits,
    tools: Given | None = None,
    contact: Contact = PARABOLOID,
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest friction of any surface of independent asperities at each load.

    One asperity of the smallest radius has the lowest friction; with a Hertz contact it is
    ``pi R (3p/(4 sqrt R))^(2/3)``. N equal asperities of the largest radius have the highest friction. Both
    values are nan above the load at which the plane reaches the base plane with N summits of the largest
    height. They hold for every contact law whose load is a convex function of the area, see
    `metafem.inversion.bounds`; they are 0 and infinite for other laws and with adhesion.

    Parameters
    ----------
    template : Surface
        Surface of which only the number N of sites is used, and the common radius if `tools` is not given.
    rescaled_load : array_like, (k,)
        P/E* [mm^2], positive.
    limits : Limits
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity, as in `design`; default: the radius and cap of the template.
    contact : Contact
        Law of one contact; default: `Hertz()`.

    Returns
    -------
    low, high : ndarray, (k,)
        F/(sigma B) [mm^2].

    Raises
    ------
    InvalidInput
        If a load or a radius is not positive, or if the template has several radii and `tools` is not given.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> low, high = feasible_region(template, [0.1, 0.4], Limits(0.12))
    >>> (high / low).round(12)
    array([4., 4.])
    >>> flat = template.replaced(cap=mf.Power(4))
    >>> low, high = feasible_region(flat, [0.1, 0.4], Limits(0.12), contact=mf.Elastic())
    >>> (high / low).round(4)
    array([12.1257, 12.1257])
    """
    check.instance("template", template, Surface, "a metafem.Surface")
    check.instance("limits", limits, Limits, "metafem.Limits")
    load = check.array("rescaled_load", rescaled_load, shape=(None,), positive=True)
    choice = Tools.of(tools, template, checked_contact(contact))
    bounds = Bounds(choice, template.count, float(load.max()))
    within = load <= bounds.largest_load(limits)
    low, high = np.full((2, len(load)), np.nan)
    if within.any():
        bounds = replace(bounds, last=float(load[within].max()))
        low[within], high[within] = bounds.friction(load[within])
    return low, high


def plasticity_index(surface: Surface, hardness: float) -> float:
    """Return the plasticity index of a surface, ``psi = E*/H sqrt(s/R)``.

    Here s is the standard deviation of the heights and R the mean radius. An elastic model is suitable
    below 0.6; above it, a MetafemWarning is issued.

    Parameters
    ----------
    surface : Surface
    hardness : float
        H of the softer material [MPa], positive.

    Returns
    -------
    float
        psi [-].

    Notes
    -----
    Greenwood and Williamson, Proc. R. Soc. A 295, 300 (1966), doi:10.1098/rspa.1966.0242.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice([0.1, 0.2], (1, 2), radius=0.5, material=mf.Material(1.36))
    >>> round(plasticity_index(surface, hardness=10.0), 4)
    0.043
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    h = check.number("hardness", hardness, above=0.0)
    radius = float(surface.cap.summit_radius(surface.radius).mean())
    psi = surface.material.composite_modulus / h * math.sqrt(float(surface.height.std()) / radius)
    if psi >= ELASTIC_LIMIT:
        warnings.warn(
            f"plasticity index {psi:.3g} is not below {ELASTIC_LIMIT}: the contacts will deform "
            "plastically; choose a material with a smaller E*/H, larger radii or closer heights",
            MetafemWarning,
            stacklevel=2,
        )
    return psi
