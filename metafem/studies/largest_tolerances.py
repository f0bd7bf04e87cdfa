"""The largest multiples of tolerances at which made surfaces meet the target with a wanted probability."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from metafem._validate import FloatArray
from metafem.studies.made_laws import MadeLaws, Runs
from metafem.surface import STEEPEST

# Name of the common factor of all tolerances.
ALL = "all"

# The tolerances, and the largest value of each, where there is one, for a surface.
BOUNDS: Mapping[str, Any] = {
    "height_sd": lambda surface: math.inf,
    "angle": lambda surface: STEEPEST,
    # ten standard deviations away from zero
    "radius_sd": lambda surface: 0.1 * float(surface.radius.min()),
    "position_sd": lambda surface: math.inf,
}

# A tolerance that is left out has this fraction of its value: its points are still drawn.
NOTHING = 1e-9

# The search for the largest tolerances evaluates this fraction of the draws dozens of times.
SHARE = 0.2

# Largest multiple of the given tolerance that is tried.
MOST = 100.0

# The search ends where the quantile of the misfit is within this fraction of its sampling error, or after
# so many steps, each of which evaluates all draws.
FRACTION, STEPS = 0.1, 12


class Level(NamedTuple):
    """Quantile of the misfit at the wanted probability, and its standard sampling error [-]."""

    value: float
    error: float


class Largest(NamedTuple):
    """A multiple of a tolerance, and its standard sampling error [-].

    It is nan where even without this error the probability is too small, and infinite where it is large
    enough at the largest multiple tried.
    """

    factor: float
    error: float


def quantile(misfit: FloatArray, probability: float) -> Level:
    """Return the smallest misfit that at least a fraction of the draws does not exceed.

    Its error is half the distance of the misfits at one standard error of the fraction on both sides.
    """
    ordered, count = np.sort(misfit), len(misfit)
    half = math.sqrt(probability * (1.0 - probability) * count)
    place = probability * count
    index = (np.array([place, place - half, place + half]) - 1e-9).astype(np.int64)
    value, low, high = ordered[np.clip(index, 0, count - 1)].tolist()
    return Level(value, 0.5 * (high - low) if math.isfinite(high) else math.inf)


def largest(level: Callable[[float], Level], given: Level, misfit: float, most: float) -> Largest:
    """Return the largest factor, up to `most`, at which the quantile of the misfit is the wanted one.

    The misfit of each draw is a continuous function of the factor, and so is its quantile with common random
    numbers: the root is bracketed and found by the method of false position in its Illinois form.

    level: the quantile at a factor; given: that at 1.
    """
    low, at_low = 0.0, level(0.0)
    high, at_high = 1.0, given
    if at_high.value <= misfit:
        low, at_low = high, at_high
        while at_high.value <= misfit:
            if high >= most:
                return Largest(math.inf, 0.0)
            low, at_low = high, at_high
            high = min(2.0 * high, most)
            at_high = level(high)
    elif at_low.value > misfit:
        return Largest(math.nan, 0.0)
    ends = [at_low.value - misfit, at_high.value - misfit]
    best, side = (low, at_low), 0
    for _ in range(STEPS):
        if math.isfinite(ends[1]):
            middle = low + (high - low) * ends[0] / (ends[0] - ends[1])
        else:
            middle = 0.5 * (low + high)
        found = level(middle)
        over = found.value - misfit
        best = (middle, found)
        if abs(over) <= FRACTION * found.error:
            break
        # an end that is kept twice counts half
        if over > 0.0:
            high, at_high, ends[1] = middle, found, over
            ends[0] *= 0.5 if side > 0 else 1.0
            side = 1
        else:
            low, at_low, ends[0] = middle, found, over
            ends[1] *= 0.5 if side < 0 else 1.0
            side = -1
    factor, found = best
    rate = (at_high.value - at_low.value) / (high - low)
    return Largest(factor, found.error / rate if rate > 0.0 else math.inf)


def factors(
    runs: Runs, task: MadeLaws, drawn: FloatArray, allowed: float, wanted: float
) -> dict[str, Largest]:
    """Return the largest factor of all tolerances and of each that is not 0.

    drawn: misfits under the given tolerances.
    """
    given = {name: getattr(task.tolerances, name) for name in BOUNDS if getattr(task.tolerances, name) > 0.0}
    count = min(len(drawn), task.size * math.ceil(SHARE * len(drawn) / task.size))
    at_given = quantile(drawn[:count], wanted)

    def factor(names: list[str]) -> Largest:
        # a little less than the bound, for rounding
        most = min(MOST, *(0.999 * BOUNDS[name](task.surface) / given[name] for name in names))

        def level(times: float) -> Level:
            if times == 0.0 and task.inputs is None and len(names) == len(given):
                return Level(task.nominal[0], 0.0)
            scaled = {name: max(times, NOTHING) * given[name] for name in names}
            changed = replace(task, tolerances=replace(task.tolerances, **scaled), draws=count)
            return quantile(runs.misfits(changed), wanted)

        return largest(level, at_given, allowed, most)

    if not given:
        return {}
    found = {ALL: factor(list(given))}
    # a single one is all
    return found | {name: factor([name]) if len(given) > 1 else found[ALL] for name in given}
