"""Lines through the origin, with one slope or two: bounds of their load range, and the range that is reached.

The least friction of any surface is that of one contact, ``c p^(2/3)`` at the load p = P/E*, with
``c = pi R (3/(4 sqrt R))^(2/3)`` for the least radius. A line of slope m lies above it for loads above
``(c/m)^3``. The steepest slope of a law, that of N contacts of the largest radius which enter at once, is
``(2/3) K p/A0^2`` with ``K = N c^3``. A line of slope m can therefore not go beyond ``(2/3) K/m^3``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem.errors import Infeasible, InvalidInput
from metafem.inversion.assessment import REACHED, independent_misfit
from metafem.inversion.feasibility import (
    ROUNDING,
    largest_load,
    least_exponent,
    margin_words,
    refuse_load,
    single_friction,
)
from metafem.inversion.limits import Limits
from metafem.inversion.radii import Radii, RadiusRange
from metafem.inversion.strategies import sampled
from metafem.inversion.targets.straight import BilinearLaw, LinearLaw
from metafem.surface import Surface

Line = LinearLaw | BilinearLaw

# Bisections of the logarithm of the range: to a sixtieth of it.
HALVINGS = 6

# Random restarts for each range that is tried; most ranges that are too wide use all of them.
TRIAL_RESTARTS = 4

# Fraction of the allowed difference at which a range counts as reached, which leaves room for other models.
TRIAL_SHARE = 0.8

# A range that is tried starts this factor above the load at which one asperity has the friction of the line.
# Between the entries of the first asperities a law differs from the line by 1.1 % if it starts at that load,
# and by .7 % if it starts here (measured; independent of slope and radius by scaling).
FIRST_LOAD = 1.4

# The nearest reachable line is inside its bound by this relative distance.
INSIDE = 1e-6


def refuse_line(target: Line, radii: Radii, count: int, limits: Limits, margin: float) -> None:
    """Raise Infeasible for a line over a range that breaks a bound by more than a margin (relative)."""
    if target.load_range is None:
        return
    (low, high), wording = target.load_range, target.wording
    slack = margin + ROUNDING
    about = f"for any surface of {count} asperities of {radii}{margin_words(margin)}"
    _refuse_second(target, radii, count, limits, slack, about)
    refuse_load(high, radii, count, limits, wording)
    start, end = line_range(target, radii, count, slack)
    slope = wording.name()
    if low < start:
        raise _refused(
            f"{wording.slopes(target.lines[0][0])} through the origin cannot begin at {wording.loads(low)}: "
            f"a single asperity has more friction up to {wording.load_bound(start, up=True)}, {about}",
            reached_line(target, radii, count, limits),
            f"raise the {slope}, or use a smaller radius",
        )
    if high > end:
        raise _refused(
            f"{wording.slopes(target.lines[-1][0])} through the origin cannot go on up to "
            f"{wording.loads(high)}: from {wording.load_bound(end, up=False)} on friction grows more slowly, "
            f"{about}",
            reached_line(target, radii, count, limits),
            f"lower the {slope}, or use a larger radius or more asperities",
        )


def _refuse_second(target: Any, radii: Radii, count: int, limits: Limits, slack: float, about: str) -> None:
    """Raise Infeasible for a slope that cannot follow the one before it."""
    wording = target.wording
    for (first, _), (second, load) in pairwise(target.lines):
        friction = float(target.line(np.array(load)))
        least = least_exponent(radii) * friction / load * (1.0 - slack)
        most = _steepest(radii, count, slack) * load / friction**2
        if least <= second <= most:
            continue
        inside = min(max(second, least * (1.0 + INSIDE)), most * (1.0 - INSIDE))
        nearest = replace(target, slopes=(first, inside)) if least < most else None
        raise Infeasible(
            f"{wording.slopes(second)} cannot follow {wording.slopes(first)} at {wording.loads(load)}: what "
            f"follows can be from {wording.slope_bound(least, up=True)} to "
            f"{wording.slope_bound(most, up=False)}, {about}",
            nearest and reached_line(nearest, radii, count, limits),
        )


def _refused(words: str, nearest: Line | None, otherwise: str) -> Infeasible:
    """Return the error for a range that is not reached, with a range that is, or with what to change."""
    if nearest is None or nearest.load_range is None:
        return Infeasible(f"{words}; {otherwise}")
    ends = nearest.wording.inside(*nearest.load_range)
    return Infeasible(
        f"{words}; the line is reached from {ends}: give that load_range, or {otherwise}", nearest
    )


def line_range(target: Line, radii: Radii, count: int, slack: float = 0.0) -> tuple[float, float]:
    """Return the loads P/E* [mm^2] between which surfaces can have the friction and slope of a line."""
    first, (last, load) = target.lines[0][0], target.lines[-1]
    start = (single_friction(radii.low) * (1.0 - slack) / first) ** 3
    # m (m p + b)^2 = (2/3) K p: the slope is possible between the two roots
    intercept = (float(target.line(np.array(load))) - last * load) / last
    half = 0.5 * _steepest(radii, count, slack) / last**3 - intercept
    return start, half + math.sqrt(max(half**2 - intercept**2, 0.0))


def _steepest(radii: Radii, count: int, slack: float) -> float:
    """Return the factor (2/3) K [mm^2] of the steepest slope."""
    return 2.0 / 3.0 * count * (single_friction(radii.high) * (1.0 + slack)) ** 3


def _over(target: Line, low: float, high: float) -> Line | None:
    """Return the target over the overlap of its range, if any, and another one; None without overlap."""
    inside = low * (1.0 + INSIDE), high * (1.0 - INSIDE)
    asked = target.load_range or inside
    ends = max(inside[0], asked[0]), min(inside[1], asked[1])
    crossover = target.lines[-1][1] or math.sqrt(ends[0] * ends[1])
    return replace(target, load_range=ends) if ends[0] < crossover < ends[1] else None


def reached_line(target: Line, radii: Radii, count: int, limits: Limits) -> Line | None:
    """Return the line over the widest part of its range that independent asperities reach.

    The range is narrowed towards the crossover load; for one line, towards its start or its end, whichever
    leaves the wider range. None if no range is reached.
    """
    start, end = line_range(target, radii, count)
    whole = _over(target, FIRST_LOAD * start, min(end, largest_load(radii, count, limits)))
    if whole is None or whole.load_range is None:
        return None
    crossover = target.lines[-1][1]
    found = [
        _narrowed(whole, centre, radii, count, limits)
        for centre in ((crossover,) if crossover else whole.load_range)
    ]
    share, best = max(found, key=lambda each: each[0])
    return best if share else None


def _narrowed(whole: Line, centre: float, radii: Radii, count: int, limits: Limits) -> tuple[float, Line]:
    """Return the line over the largest logarithmic fraction of its range about a load, and the fraction."""
    low, high = whole.load_range or (centre, centre)
    best, inside, outside = whole, 0.0, 1.0
    for _ in range(HALVINGS):
        share = 0.5 * (inside + outside)
        trial = replace(
            whole, load_range=(centre * (low / centre) ** share, centre * (high / centre) ** share)
        )
        found = sampled.invert(trial, radii, count, limits, np.random.default_rng(0), TRIAL_RESTARTS)
        if independent_misfit(found) <= TRIAL_SHARE * REACHED:
            best, inside = trial, share
        else:
            outside = share
    return inside, best


def achievable_load_range(
    target: Line, template: Surface, limits: Limits, radii: RadiusRange | Sequence[float] | None = None
) -> tuple[float, float]:
    """Return the widest range of loads over which a line through the origin is met within 1 %.

    The range is that of independent asperities and is found by trial: `design` meets the line over it or a
    part of it. Its lower end is near the load at which a single asperity has the friction of the line. It
    is narrowed towards the crossover load of a bilinear law, and towards the start or the end of a linear
    one.

    Parameters
    ----------
    target : LinearLaw or BilinearLaw
        With a load range, the range is sought within it.
    template : Surface
        Only its number of sites is used, and its radius, one for all, where `radii` is not given.
    limits : Limits
    radii : RadiusRange or sequence of float, optional
        Radii that each asperity may have [mm]; default: the radius of the template.

    Returns
    -------
    low, high : float
        P/E* [mm^2].

    Raises
    ------
    Infeasible
        If there is no such range; says what to change.
    InvalidInput
        For another kind of target, radii that are not positive, or a template of several radii.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.27, radius=0.526, material=mf.Material(1.36))
    >>> line, limits = mf.LinearLaw(7.0), mf.Limits(0.27)
    >>> ends = mf.achievable_load_range(line, template, limits)
    >>> mf.design(mf.LinearLaw(7.0, ends), template, limits=limits).misfit < 0.01
    True
    """
    if not isinstance(target, Line):
        raise InvalidInput(f"target = {target!r:.60} must be a metafem.LinearLaw or BilinearLaw")
    check.instance("template", template, Surface, "a metafem.Surface")
    check.instance("limits", limits, Limits, "metafem.Limits")
    choice = Radii.common(template) if radii is None else Radii.given(radii)
    found = reached_line(target, choice, template.count, limits)
    if found is None or found.load_range is None:
        raise Infeasible(
            f"{target.wording.slopes(*(slope for slope, _ in target.lines))} through the origin is not "
            f"reached within {100 * REACHED:g} % over any range of loads with {template.count} asperities of "
            f"{choice} within {limits.span:g} mm of height; raise max_height or the "
            f"{target.wording.name()}, or use a smaller radius"
        )
    return found.load_range
