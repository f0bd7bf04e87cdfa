"""Heights of true proportionality: friction a constant times the load, over the largest range.

The least friction of any surface, that of one contact, is ``c p^(2/3)`` at the load p = P/E*, with
``c = pi R (3/(4 sqrt R))^(2/3)`` of the least radius; the most is ``N^(1/3)`` times that of the largest. A
law m p lies between them from ``(c/m)^3`` to ``N (c/m)^3``.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from metafem.distributions import uniform_slope
from metafem.errors import Infeasible
from metafem.inversion.blueprint import Blueprint, Branch, Parameter
from metafem.inversion.feasibility import largest_load, single_friction
from metafem.inversion.judge import REACHED, independent_misfit
from metafem.inversion.limits import Limits
from metafem.inversion.nearest import Quest, nearest_law
from metafem.inversion.radii import Radii
from metafem.inversion.sampled import POINTS, RESTARTS
from metafem.inversion.target import LinearLaw
from metafem.inversion.wanted import Wanted
from metafem.notes import information

# Halvings of the logarithm of the range: to a sixtieth of it.
HALVINGS = 6

# Random restarts of a range on trial, which most of those that are too wide use up.
TRIAL_RESTARTS = 4

# The first asperity alone is (3 pi/4)^2 R/m^2 deep when the law of slope m begins. With a third of the
# height for that, the range spans a decade; so far above the bound of linear laws is the slope offered.
REACHABLE = math.sqrt(3.0)

# Of the misfit with which a range counts as reached: leaves room for the other models.
TRIAL_SHARE = 0.8


def invert(
    target: LinearLaw, radii: Radii, count: int, limits: Limits, rng: np.random.Generator
) -> Blueprint:
    """Return heights whose law is proportional to the load over the widest range that is found."""
    low, high = proportional_range(target.slope, radii, count)
    end = min(high, largest_load(radii, count, limits))
    nearest = LinearLaw(REACHABLE * uniform_slope(radii.low, limits.span), through_origin=True)
    if not low < end:
        raise Infeasible(
            f"slope {target.slope:g} through the origin is below the friction of a single asperity of "
            f"{radii} up to {low:.6g} mm^2, and the largest load is {end:.6g} mm^2; raise the "
            "slope, or use a smaller radius or more asperities",
            nearest,
        )
    best: Blueprint | None = None
    inside, outside = 0.0, 1.0
    for _ in range(HALVINGS):
        share = 0.5 * (inside + outside)
        ends = (low, low * (end / low) ** share)
        found = _over(target.slope, ends, radii, count, limits, TRIAL_RESTARTS, rng)
        if independent_misfit(found) <= TRIAL_SHARE * REACHED:
            best, inside = found, share
        else:
            outside = share
    last = low * (end / low) ** inside
    if best is None:
        raise Infeasible(
            f"slope {target.slope:g} through the origin is not reached within {100 * REACHED:g} %, in "
            f"law and slope, over any range of loads with {count} asperities within {limits.span:g} mm of "
            f"height; raise max_height, or the slope to {nearest.slope:.4g}",
            nearest,
        )
    best = min(
        best,
        _over(target.slope, (low, last), radii, count, limits, RESTARTS, rng),
        key=independent_misfit,
    )
    note = (
        f"proportional within {100 * REACHED:g} % from {low:.4g} to {last:.4g} mm^2 under the independent "
        f"model; no surface of {count} such asperities can be beyond {high:.4g} mm^2, or below {low:.4g} mm^2"
    )
    return replace(best, notes=(information(note),))


def proportional_range(slope: float, radii: Radii, count: int) -> tuple[float, float]:
    """Return the loads P/E* [mm^2] between which a law of this slope through the origin can lie."""
    low, high = (single_friction(radius) / slope for radius in (radii.low, radii.high))
    return low**3, count * high**3


def _over(
    slope: float, ends: tuple[float, float], radii: Radii, count: int, limits: Limits, restarts: int,
    rng: np.random.Generator,
) -> Blueprint:  # fmt: skip
    load = np.geomspace(*ends, POINTS)
    wanted = Wanted.exactly(load, slope * load)
    quest = Quest(wanted, [wanted.base], count, limits.span, restarts, rng)
    height, radius = nearest_law(quest, radii)
    parameters: dict[str, Parameter] = {"load_range": np.array(ends), "span": float(-height[-1])}
    branch = Branch(slope, ends, 0.0)
    return Blueprint(limits.offset + limits.max_height + height, radius, parameters, wanted, (branch,))
