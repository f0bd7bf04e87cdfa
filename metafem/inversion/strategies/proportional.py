"""Lines through the origin, with one slope or two: bounds of their load range, and the achievable range.

One contact of the smallest radius has the smallest friction of any surface, A1(p) at the load p = P/E*. A
line of slope m exceeds A1(p) only above the load at which A1(p) = m p. With Hertz contacts this load is
``(c/m)^3`` with ``c = pi R (3/(4 sqrt R))^(2/3)``. N simultaneous Hertz contacts of the largest radius have
the steepest slope of a law, ``(2/3) K p/A0^2`` with ``K = N c^3``. A line of slope m can therefore not extend
beyond the load ``(2/3) K/m^3``. With other contact laws, a line cannot exceed the friction of N equal
contacts, see `metafem.inversion.bounds`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem.errors import Infeasible, InvalidInput
from metafem.inversion.assessment import REACHED, independent_misfit
from metafem.inversion.bounds import ROUNDING, Bounds
from metafem.inversion.feasibility import INSIDE, margin_words, refuse_load
from metafem.inversion.problem import Problem
from metafem.inversion.strategies import tools as strategy
from metafem.models import Independent
from metafem.models.model import PARABOLOID, checked_contact

# A narrower load range is proposed only if the ratio of its ends is at least this value. A line over a few
# per cent of the load does not characterise a law.
LEAST_RANGE = 1.1

# Number of bisections of a range on a logarithmic scale, to a sixtieth of the range.
BISECTIONS = 6

# A range counts as reached at this fraction of the allowed difference, as a reserve for other models.
RANGE_MISFIT = 0.8

# Ratio of the start of a tried range to the load at which one asperity has the friction of the line. Between
# the loads of the first contacts, a law differs from the line by 1.1 % with the ratio 1, and by .7 % with
# this ratio (measured; by scaling, the differences do not depend on slope and radius).
RANGE_START = 1.4

# Initial guesses for mixtures of tools in each trial of a range.
MIXTURES = 4

if TYPE_CHECKING:
    from metafem.contact import Contact
    from metafem.inversion.limits import Limits
    from metafem.inversion.targets.straight import BilinearLaw, LinearLaw, StraightLaw
    from metafem.inversion.tools.kit import Given
    from metafem.surface import Surface


def refuse_line(target: StraightLaw, problem: Problem, margin: float) -> None:
    """Raise Infeasible if a line over a load range exceeds a bound by more than a relative margin."""
    if target.load_range is None:
        return
    (low, high), wording = target.load_range, target.wording
    slack = margin + ROUNDING
    scope = f"for any surface of {problem.count} asperities of {problem.tools}{margin_words(margin)}"
    _refuse_second(target, problem, slack, scope)
    refuse_load(high, problem, wording)
    start, end = line_range(target, problem.bounds, slack)
    slope, (last, bend) = wording.name(), target.lines[-1]
    if low < start:
        words = (
            f"{wording.slopes(target.lines[0][0])} through the origin cannot begin at {wording.loads(low)}: "
            f"a single asperity has more friction up to {wording.load_bound(start, up=True)}"
        )
        otherwise = f"raise the {slope}, or use a smaller radius"
    elif high > end:
        words = (
            f"{wording.slopes(last)} {f'from {wording.loads(bend)}' if bend else 'through the origin'} "
            f"cannot go on up to {wording.loads(high)}: from {wording.load_bound(end, up=False)} on friction "
            "grows more slowly"
        )
        otherwise = f"lower the {slope}, or use a larger radius or more asperities"
    else:
        return
    raise _refused(f"{words}, {scope}", reached_line(target, problem), otherwise)


def _refuse_second(target: Any, problem: Problem, slack: float, scope: str) -> None:
    """Raise Infeasible if a slope cannot follow the previous slope."""
    wording, bounds = target.wording, problem.bounds
    for (first, _), (second, load) in pairwise(target.lines):
        friction = float(target.line(np.array(load)))
        least = bounds.least_exponent * friction / load * (1.0 - slack)
        most = bounds.steepest(load, friction, slack)
        if least <= second <= most:
            continue
        inside = min(max(second, least * (1.0 + INSIDE)), most * (1.0 - INSIDE))
        nearest = replace(target, slopes=(first, inside)) if least < most else None
        raise Infeasible(
            f"{wording.slopes(second)} cannot follow {wording.slopes(first)} at {wording.loads(load)}: what "
            f"follows can be from {wording.slope_bound(least, up=True)} to "
            f"{wording.slope_bound(most, up=False)}, {scope}",
            nearest and reached_line(nearest, problem),
        )


def _refused(words: str, nearest: StraightLaw | None, otherwise: str) -> Infeasible:
    """Return the error for a range that is not reached; it states a reachable range or a remedy."""
    ends = None if nearest is None else nearest.load_range
    if nearest is None or ends is None or ends[1] < LEAST_RANGE * ends[0]:
        return Infeasible(f"{words}; {otherwise}")
    given = f"the line is reached from {nearest.wording.inside(*ends)}: give that load_range"
    return Infeasible(f"{words}; {given}, or {otherwise}", nearest)


def line_range(target: StraightLaw, bounds: Bounds, slack: float = 0.0) -> tuple[float, float]:
    """Return the loads P/E* [mm^2] between which surfaces can have the friction and the slope of a line."""
    first, (last, load) = target.lines[0][0], target.lines[-1]
    intercept = float(target.line(np.array(load))) - last * load
    return bounds.start_of_line(first / (1.0 - slack)), bounds.end_of_line(last, intercept, slack)


def reached_line(target: Any, problem: Problem) -> StraightLaw | None:
    """Return the line over the widest part of its range that independent asperities reach, or None.

    With a crossover, the range is narrowed towards the crossover load. A single line is narrowed towards its
    start or its end, whichever gives the wider range.
    """
    start, end = line_range(target, problem.bounds)
    most = problem.bounds.largest_load(problem.limits)
    low, high = RANGE_START * start * (1.0 + INSIDE), min(end, most) * (1.0 - INSIDE)
    if target.load_range is not None:
        low, high = max(low, target.load_range[0]), min(high, target.load_range[1])
    crossover = target.lines[-1][1]
    if not low < (crossover or math.sqrt(low * high)) < high:
        return None
    whole = replace(target, load_range=(low, high))
    centres = (crossover,) if crossover else whole.load_range
    fraction, best = max(
        (_narrowed(whole, centre, problem) for centre in centres), key=lambda found: found[0]
    )
    return best if fraction else None


def _narrowed(whole: Any, centre: float, problem: Problem) -> tuple[float, StraightLaw]:
    """Return the largest reached fraction [-] of a range around the load `centre`, and the line over it.

    The fraction is that of the range on a logarithmic scale.
    """
    low, high = whole.load_range
    best, inside, outside = whole, 0.0, 1.0
    for _ in range(BISECTIONS):
        fraction = 0.5 * (inside + outside)
        ends = centre * (low / centre) ** fraction, centre * (high / centre) ** fraction
        trial = replace(whole, load_range=ends)
        tried = replace(problem, target=trial, effort=replace(problem.effort, mixtures=MIXTURES))
        found = strategy.candidate(tried, np.random.default_rng(0), problem.effort.range_restarts)
        if independent_misfit(problem, found) <= RANGE_MISFIT * REACHED:
            best, inside = trial, fraction
        else:
            outside = fraction
    return inside, best


def achievable_load_range(
    target: LinearLaw | BilinearLaw,
    template: Surface,
    limits: Limits,
    tools: Given | None = None,
    contact: Contact = PARABOLOID,
) -> tuple[float, float]:
    """Return the widest range of loads over which a line through the origin is met within 1 %.

    The range is that of independent asperities and is found by trial designs. `design` meets the line over
    this range or a part of it. The lower end of the range is near the load at which a single asperity has the
    friction of the line. Ranges are narrowed towards the crossover load of a bilinear law, and towards the
    start or the end of a linear law.

    Parameters
    ----------
    target : LinearLaw or BilinearLaw
        Line through the origin. If the target has a load range, only ranges within it are tried.
    template : Surface
        Surface of which only the number of sites is used, and the common radius if `tools` is not given.
    limits : Limits
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity, as in `design`; default: the radius and cap of the template.
    contact : Contact
        Law of one contact; default: `Hertz()`. Adhesion is ignored.

    Returns
    -------
    low, high : float
        P/E* [mm^2].

    Raises
    ------
    Infeasible
        If there is no such range; the message states a remedy.
    InvalidInput
        If the target is of another kind, if a radius is not positive, or if the template has several radii
        and `tools` is not given.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.27, radius=0.526, material=mf.Material(1.36))
    >>> line, limits = mf.LinearLaw(7.0), mf.Limits(0.27)
    >>> ends = achievable_load_range(line, template, limits)
    >>> mf.design(mf.LinearLaw(7.0, ends), template, limits=limits).misfit < 0.01
    True
    """
    model = Independent(contact=checked_contact(contact))
    problem = Problem.checked(target, template, model, limits, tools=tools)
    if not target.lines:
        raise InvalidInput(f"target = {target!r:.60} must be a metafem.LinearLaw or BilinearLaw")
    found = reached_line(target, problem)
    if found is None or found.load_range is None:
        raise Infeasible(
            f"{target.wording.slopes(*(slope for slope, _ in target.lines))} through the origin is not "
            f"reached within {100 * REACHED:g} % over any range of loads with {template.count} asperities of "
            f"{problem.tools} within {limits.span:g} mm of height; raise max_height or the "
            f"{target.wording.name()}, or use a smaller radius"
        )
    return found.load_range
