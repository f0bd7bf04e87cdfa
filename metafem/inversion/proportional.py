"""Heights of true proportionality: friction a constant times the load, over the largest range.

The least friction of any surface, that of one contact, is ``c p^(2/3)`` at the load p = P/E*, with
``c = pi R (3/(4 sqrt R))^(2/3)``; the most is ``N^(1/3)`` times that. A law m p lies between them from
``(c/m)^3`` to ``N (c/m)^3``.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.distributions import uniform_slope
from metafem.errors import Infeasible
from metafem.inversion.blueprint import Blueprint, Branch, Parameter
from metafem.inversion.feasibility import largest_load
from metafem.inversion.judge import REACHED, branch_fits, largest_misfit
from metafem.inversion.limits import Limits
from metafem.inversion.march import march
from metafem.inversion.refine import search
from metafem.inversion.sampled import GOAL, POINTS, RESTARTS, independent
from metafem.inversion.target import LinearLaw
from metafem.inversion.wanted import Wanted
from metafem.models import Independent
from metafem.surface import Material, Surface

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
    target: LinearLaw, radius: float, count: int, limits: Limits, rng: np.random.Generator
) -> Blueprint:
    """Return heights whose law is proportional to the load over the widest range that is found."""
    low, high = proportional_range(target.slope, radius, count)
    end = min(high, largest_load(radius, count, limits))
    nearest = LinearLaw(REACHABLE * uniform_slope(radius, limits.span), through_origin=True)
    if not low < end:
        raise Infeasible(
            f"slope {target.slope:g} through the origin is below the friction of a single asperity of "
            f"radius {radius:g} mm up to {low:.6g} mm^2, and the largest load is {end:.6g} mm^2; raise the "
            "slope, or use a smaller radius or more asperities",
            nearest,
        )
    best: Blueprint | None = None
    inside, outside = 0.0, 1.0
    for _ in range(HALVINGS):
        share = 0.5 * (inside + outside)
        ends = (low, low * (end / low) ** share)
        found = _over(target.slope, ends, radius, count, limits, TRIAL_RESTARTS, rng)
        if _misfit(found, radius) <= TRIAL_SHARE * REACHED:
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
        best, _over(target.slope, (low, last), radius, count, limits, RESTARTS, rng),
        key=lambda found: _misfit(found, radius),
    )  # fmt: skip
    note = (
        f"proportional within {100 * REACHED:g} % from {low:.4g} to {last:.4g} mm^2 under the independent "
        f"model; no surface of {count} such asperities can be beyond {high:.4g} mm^2, or below {low:.4g} mm^2"
    )
    return Blueprint(best.height, best.parameters, best.wanted, best.branches, notes=(note,))


def proportional_range(slope: float, radius: float, count: int) -> tuple[float, float]:
    """Return the loads P/E* [mm^2] between which a law of this slope through the origin can lie."""
    single = math.pi * radius * (0.75 / math.sqrt(radius)) ** (2.0 / 3.0)
    low = (single / slope) ** 3
    return low, count * low


def _over(
    slope: float, ends: tuple[float, float], radius: float, count: int, limits: Limits, restarts: int,
    rng: np.random.Generator,
) -> Blueprint:  # fmt: skip
    load = np.geomspace(*ends, POINTS)
    wanted = Wanted.exactly(load, slope * load)
    start = march(load, wanted.base, radius, count)
    found = search(independent(radius, load), [start], wanted, limits.span, count, GOAL, restarts, rng)
    height: FloatArray = np.sort(found.height - found.height.max())[::-1]
    parameters: dict[str, Parameter] = {"load_range": np.array(ends), "span": float(-height[-1])}
    branch = Branch(slope, ends, 0.0)
    return Blueprint(limits.offset + limits.max_height + height, parameters, wanted, (branch,))


def _misfit(blueprint: Blueprint, radius: float) -> float:
    """Return the misfit of independent asperities."""
    shape = (1, len(blueprint.height))
    surface = Surface.square_lattice(blueprint.height, shape, radius=radius, material=Material(1.0))
    model = Independent()
    return largest_misfit(surface, model, blueprint, branch_fits(surface, model, blueprint))
