"""The largest tolerances with which made surfaces meet a requirement."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion.assessment import REACHED
from metafem.studies.made_laws import MadeLaws
from metafem.studies.sampling.moments import Estimate
from metafem.surface import STEEPEST

# The quantile of the misfit at the wanted probability, or a scatter, at a factor, with its error [-].
Level = Callable[[float], Estimate]

# The misfits of all draws.
Misfits = Callable[[MadeLaws], FloatArray]

# Allowed relative scatter of the slope of a part: a law within it counts as reached.
ALLOWED = REACHED

# Name of the common factor of all tolerances.
ALL = "all"

# The tolerances, and the largest value of each for a surface, if there is one.
BOUNDS: Mapping[str, Any] = {
    "height_sd": lambda surface: math.inf,
    "angle": lambda surface: STEEPEST,
    # ten standard deviations away from zero
    "radius_sd": lambda surface: 0.1 * float(surface.radius.min()),
    "position_sd": lambda surface: math.inf,
}

# A tolerance that is left out is multiplied by this fraction: its points are still drawn.
NOTHING = 1e-9

# The search for the largest tolerances evaluates this fraction of the draws about five times for each, and
# all of them once.
SHARE = 0.2

# Largest multiple of the given tolerance that is tried.
MOST = 100.0

# Relative distance from the extrapolated factor to one that is too large. The rate of the quantile is
# computed between the factor found and one that is larger by about as much: at a smaller distance, it would
# depend on a single draw.
BEYOND, NEAREST, FARTHEST = 0.1, 0.05, 0.3

# The search ends where the quantile of the misfit is within this fraction of its sampling error, or after
# this number of steps; each step evaluates all draws.
FRACTION, STEPS = 0.2, 12

# A smaller increase of the level, relative to the wanted one, counts as zero.
SMALLEST = 1e-9


def quantile(misfit: FloatArray, probability: float) -> Estimate:
    """Return the smallest misfit that is not exceeded by at least a fraction of the draws.

    Its error is half the distance of the misfits at one standard error of the fraction on both sides.
    """
    ordered, count = np.sort(misfit), len(misfit)
    half = math.sqrt(probability * (1.0 - probability) * count)
    place = probability * count
    index = (np.array([place, place - half, place + half]) - 1e-9).astype(np.int64)
    value, low, high = ordered[np.clip(index, 0, count - 1)].tolist()
    return Estimate(value, 0.5 * (high - low) if math.isfinite(high) else math.inf)


def largest(
    level: Level, given: Estimate, wanted: float, most: float, whole: Level | None = None
) -> Estimate:
    """Return the largest factor, up to `most`, at which a level equals the wanted one, and its error.

    The level of each draw is a continuous function of the factor, and so is the level of all draws with
    common random numbers: the root is bracketed and found by the method of false position in its Illinois
    form. The factor is nan if the level exceeds the wanted one even without this error, and infinite if it
    does not at the largest multiple. Its error is infinite if it depends on draws without a solution.

    level: the level at a factor; given: the level at 1; whole: the level of more draws, for one last step.
    """
    low, at_low = 0.0, level(0.0)
    high, at_high = 1.0, given
    if min(at_low.value, at_high.value) > wanted:
        return Estimate(math.nan, 0.0)
    while at_high.value <= wanted:
        if high >= most:
            return Estimate(math.inf, 0.0)
        rise = max(at_high.value - at_low.value, SMALLEST * wanted)
        ahead = (wanted - at_high.value) * (high - low) / rise
        new = min((1.0 + BEYOND) * min(high + ahead, 2.0 * high), most)
        low, at_low, high, at_high = high, at_high, new, level(new)
    above = {high: at_high.value}
    ends, unmoved = [at_low.value - wanted, at_high.value - wanted], 0
    for _ in range(STEPS):
        # an infinite level has no line through it
        share = ends[0] / (ends[0] - ends[1]) if math.isfinite(ends[1]) else 0.5
        factor = low + (high - low) * share
        found = level(factor)
        over = found.value - wanted
        if math.isfinite(found.error) and abs(over) <= max(FRACTION * found.error, SMALLEST * wanted):
            break
        # the level of an end that stays twice is halved
        if over > 0.0:
            high, above[factor] = factor, found.value
            ends = [ends[0] * (0.5 if unmoved < 0 else 1.0), over]
            unmoved = -1
        else:
            low, ends = factor, [over, ends[1] * (0.5 if unmoved > 0 else 1.0)]
            unmoved = 1
    near = [times for times in above if NEAREST <= times / factor - 1.0 <= FARTHEST]
    apart = min(near, default=min((1.0 + BEYOND) * factor, most))
    rise = (above[apart] if near else level(apart).value) - found.value
    if not 0.0 < rise < math.inf:
        return Estimate(factor, math.inf)
    rate = rise / (apart - factor)
    error = found.error / rate
    if whole is None or not 0.0 < error < math.inf:
        return Estimate(factor, error)
    value, error = whole(factor)
    return Estimate(factor - (value - wanted) / rate, error / rate)


def factors(
    misfits: Misfits, task: MadeLaws, drawn: FloatArray, allowed: float, wanted: float
) -> dict[str, Estimate]:
    """Return the largest factor of all tolerances and of each that is not 0.

    drawn: misfits under the given tolerances; misfits: computes those of other tolerances.
    """
    given = {name: getattr(task.tolerances, name) for name in BOUNDS if getattr(task.tolerances, name) > 0.0}
    count = min(len(drawn), task.size * math.ceil(SHARE * len(drawn) / task.size))
    at_given = quantile(drawn[:count], wanted)

    def factor(names: list[str]) -> Estimate:
        # a little less than the bound, for rounding
        most = min(MOST, *(0.999 * BOUNDS[name](task.surface) / given[name] for name in names))

        def level(times: float, draws: int = count) -> Estimate:
            if times == 0.0 and not task.inputs.names and len(names) == len(given):
                return Estimate(task.nominal[0], 0.0)
            scaled = {name: max(times, NOTHING) * given[name] for name in names}
            changed = replace(task.tolerances, **scaled)
            return quantile(misfits(replace(task, tolerances=changed, draws=draws, described=False)), wanted)

        # one step with all draws, as the level of a part of them already equals the wanted one
        return largest(level, at_given, allowed, most, lambda times: level(times, len(drawn)))

    if not given:
        return {}
    found = {ALL: factor(list(given))}
    # a single one is all
    return found | {name: factor([name]) if len(given) > 1 else found[ALL] for name in given}
