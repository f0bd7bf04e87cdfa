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

# Function of a factor of the tolerances: the quantile of the misfit at the required probability, or the
# scatter of the slope, with its error [-].
Level = Callable[[float], Estimate]

# Function of a task: the misfits of all its draws, (m,).
Misfits = Callable[[MadeLaws], FloatArray]

# Allowed relative standard deviation of the slope: the misfit up to which a design counts as reached.
ALLOWED = REACHED

# Name of the factor that multiplies all tolerances.
ALL = "all"

# Largest value of each tolerance for a surface; infinite if there is none.
BOUNDS: Mapping[str, Any] = {
    "height_sd": lambda surface: math.inf,
    "angle": lambda surface: STEEPEST,
    # all radii stay ten standard deviations above zero
    "radius_sd": lambda surface: 0.1 * float(surface.radius.min()),
    "position_sd": lambda surface: math.inf,
}

# Replaces a factor of 0: a tolerance of exactly 0 would have no random points, and all draws would change.
NOTHING = 1e-9

# For each tolerance, the search evaluates this fraction of the draws about five times, and all draws once.
SHARE = 0.2

# Largest multiple of a tolerance that the search tries.
MOST = 100.0

# To find a factor that is too large, the search exceeds the extrapolated factor by the fraction BEYOND. The
# derivative of the level is the difference quotient between the factor found and a factor that is larger by a
# fraction from NEAREST to FARTHEST. At a smaller distance, the quotient would depend on a single draw.
BEYOND, NEAREST, FARTHEST = 0.1, 0.05, 0.3

# The search ends if the level differs from the allowed one by at most this fraction of its sampling error, or
# after this number of steps.
FRACTION, STEPS = 0.2, 12

# Differences between levels that are smaller than this fraction of the allowed level count as zero.
SMALLEST = 1e-9


def quantile(misfit: FloatArray, probability: float) -> Estimate:
    """Return the misfit that a fraction `probability` of the draws does not exceed, and its error [-].

    The error is half the difference between the misfits at the fraction plus and minus its standard error.
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
    """Return the largest factor up to `most` at which the level equals `wanted`, and the factor's error.

    All factors use the same random numbers, so the level is a continuous function of the factor. The root is
    bracketed and then found by false position in the Illinois form. The factor is nan if the level exceeds
    `wanted` at both factors 0 and 1, and infinite if the level does not exceed `wanted` at `most`. The error
    is infinite if the level does not increase beyond the factor, or if draws there have no solution.

    level: function of the factor; given: the level at factor 1; whole: the same function with more draws, for
    one final correction.
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
        # no line passes through an infinite level: bisect
        share = ends[0] / (ends[0] - ends[1]) if math.isfinite(ends[1]) else 0.5
        factor = low + (high - low) * share
        found = level(factor)
        over = found.value - wanted
        if math.isfinite(found.error) and abs(over) <= max(FRACTION * found.error, SMALLEST * wanted):
            break
        # Illinois: halve the value of an end that stays twice in a row
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
    """Return the largest factor of all tolerances together, and of each tolerance that is not 0.

    misfits: computes the misfits of a task; drawn: the misfits (m,) under the tolerances of `task`.
    """
    given = {name: getattr(task.tolerances, name) for name in BOUNDS if getattr(task.tolerances, name) > 0.0}
    count = min(len(drawn), task.size * math.ceil(SHARE * len(drawn) / task.size))
    at_given = quantile(drawn[:count], wanted)

    def factor(names: list[str]) -> Estimate:
        # stay slightly below the bound, because of rounding
        most = min(MOST, *(0.999 * BOUNDS[name](task.surface) / given[name] for name in names))

        def level(times: float, draws: int = count) -> Estimate:
            if times == 0.0 and not task.inputs.names and len(names) == len(given):
                return Estimate(task.nominal[0], 0.0)
            scaled = {name: max(times, NOTHING) * given[name] for name in names}
            changed = replace(task.tolerances, **scaled)
            return quantile(misfits(replace(task, tolerances=changed, draws=draws, described=False)), wanted)

        # a fifth of the draws already reaches the allowed level: one correction with all draws is enough
        return largest(level, at_given, allowed, most, lambda times: level(times, len(drawn)))

    if not given:
        return {}
    found = {ALL: factor(list(given))}
    # a single tolerance has the same factor as all tolerances together
    return found | {name: factor([name]) if len(given) > 1 else found[ALL] for name in given}
