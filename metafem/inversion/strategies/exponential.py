"""Heights from exponential densities for linear laws (eqs. S3 to S5) and bilinear laws (eqs. S6 to S8)."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.errors import Infeasible
from metafem.inversion.candidate import Branch, Candidate, Parameter
from metafem.inversion.feasibility import INSIDE
from metafem.inversion.height_density import (
    FINEST_SCALE_IN_SD,
    ExponentialDensity,
    equal_masses,
    scale_from_slope,
    uniform_slope,
)
from metafem.inversion.limits import Limits
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.strategies.mixture import Mixture, best_mixture
from metafem.inversion.strategies.two_branches import two_branches
from metafem.models.model import PARABOLOID
from metafem.notes import Note

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem
    from metafem.inversion.targets.straight import StraightLaw
    from metafem.inversion.targets.wording import Wording

# A straight line is fitted to a branch beyond this fraction of its load range. At smaller loads the law still
# bends towards its asymptote. With this range the surfaces of Aymard et al. have their published slopes and
# scatter.
BRANCH_START = 0.25

# Largest slope, relative to the slope of the uniform density. The scale decreases with the inverse square of
# the slope. At this slope it is as small as the rounding error of the largest height.
STEEPEST = 1e7

# If the scale over the span of the heights is below this ratio, double precision does not resolve the
# differences of the heights.
FINEST = 2.0**-52

# Number of separations, from the top to the foot of a density, at which its law is compared with the law of
# the heights.
SEPARATIONS = 61


def candidate(target: StraightLaw, problem: Problem) -> Candidate:
    """Return heights that follow a density of one or two branches whose law has the target slopes."""
    return best_mixture(lambda mixture: _of_mixture(target, mixture, problem.limits), problem)


def _of_mixture(target: Any, mixture: Mixture, limits: Limits) -> Candidate:
    plain = ExponentialDensity(_scale(target, mixture, limits), limits.span)
    density = plain if len(target.lines) == 1 else two_branches(target, plain, mixture)
    end = float(density.rescaled_load(0.0, *mixture.asperities))
    intercept = plain.intercept(*mixture.asperities) if density is plain else None
    parameters: dict[str, Parameter] = {"scale": plain.scale}
    if intercept is not None:
        parameters |= {"intercept": intercept, "foot_load": end}
    height, found = _heights(density, mixture.count, limits)
    starts = [start for _, start in target.lines]
    branches = tuple(
        Branch(slope, (start + BRANCH_START * (stop - start), stop), intercept)
        for (slope, _), (start, stop) in zip(target.lines, pairwise([*starts, end]), strict=True)
    )
    return Candidate(
        height=limits.foot + height,
        radius=mixture.mixed(),
        parameters={**parameters, **found, "foot_load": end},
        target_law=law_of(density, branches, mixture),
        branches=branches,
        density=density,
        notes=_notes(plain.scale, mixture, limits, target.wording),
        stepped=limits.height_step is not None and density is plain,
    )


def _heights(
    density: ExponentialDensity, count: int, limits: Limits
) -> tuple[FloatArray, dict[str, Parameter]]:
    """Return heights above the foot, tallest first, (n,) [mm], and the parameters that describe them."""
    middle, top = density.crossover_height, limits.span
    if middle > 0.0:
        upper = min(max(round(count * density.upper_mass), 1), count - 1)  # N_1 of regime 1, h > h_c
        parts = _middles(density, middle, top, upper), _middles(density, 0.0, middle, count - upper)
        counts = np.array([upper, count - upper])
        height = np.concatenate(parts)
        crossover = limits.foot + middle
        return height, {"weight": density.weight, "crossover_height": crossover, "counts": counts}
    if limits.height_step is None:
        return _middles(density, 0.0, top, count), {}
    levels, numbers = level_counts(density, count, limits.height_step)
    used = numbers > 0
    return np.repeat(levels, numbers)[::-1], {"levels": limits.foot + levels[used], "counts": numbers[used]}


def law_of(density: ExponentialDensity, branches: tuple[Branch, ...], mixture: Mixture) -> TargetLaw:
    """Return the law of a density at evenly spaced separations, from the start of the first fit."""
    separation = density.max_height * (1.0 - np.arange(SEPARATIONS) / (SEPARATIONS - 1))
    load = density.rescaled_load(separation, *mixture.asperities)
    inside = load >= branches[0].load_range[0]
    area = density.area(separation[inside], *mixture.asperities)
    return TargetLaw.fixed(load[inside], area)


def level_counts(density: ExponentialDensity, count: int, step: float) -> tuple[FloatArray, IntArray]:
    """Return levels at the middles of height steps, (l,) [mm], and the numbers of asperities on them, (l,).

    The numbers are the expected numbers rounded to integers. Until their sum is `count`, single numbers are
    changed by 1. Each change is made where the relative difference from the expected number is then smallest.
    The highest level includes the mass up to the maximum height.
    """
    number = max(1, math.floor(density.max_height / step + 0.5))
    levels = np.asarray(step * (np.arange(number) + 0.5), dtype=np.float64)
    ends = np.append(step * np.arange(len(levels)), density.max_height)
    expected = count * density.mass(ends[:-1], ends[1:])
    counts = np.rint(expected).astype(np.int64)
    while (missing := count - int(counts.sum())) != 0:
        changed = counts + (1 if missing > 0 else -1)
        error = np.full(len(counts), np.inf)
        np.divide(np.abs(changed - expected), expected, out=error, where=(changed >= 0) & (expected > 0.0))
        best = int(error.argmin())
        counts[best] = changed[best]
    return levels, counts


def _middles(density: ExponentialDensity, low: float, high: float, count: int) -> FloatArray:
    """Return the middles of intervals of equal mass between two heights, tallest first, (count,) [mm]."""
    ends = equal_masses(density.scale, low, high, count)
    return np.asarray(0.5 * (ends[1:] + ends[:-1])[::-1])


def _scale(target: Any, mixture: Mixture, limits: Limits) -> float:
    """Return the scale [mm] at which the truncated exponential has the only or first slope of a target."""
    slope, wording, single = target.lines[0][0], target.wording, (mixture.radius, mixture.law)
    bound = uniform_slope(mixture.radius, limits.span, mixture.law)
    given, name = wording.slopes(slope), wording.name()

    def nearest(slope: float) -> Any:
        if len(target.lines) == 1:
            return replace(target, slope=slope)
        return replace(target, slopes=(slope, target.slopes[1]))

    if slope > STEEPEST * bound:
        raise Infeasible(
            f"{given} exceeds {STEEPEST:g} times the bound {wording.coefficient(bound):.6g}: the heights "
            f"would differ by less than double precision resolves; lower the {name}",
        )
    if slope <= bound:
        pair = "" if wording.per_slope is None else " sigma B/E*"
        form = "3 pi/4 sqrt(R/h_m)" if mixture.law == PARABOLOID else "A(h_m)/P(h_m)"
        raise Infeasible(
            f"{given} is not above the bound {form}{pair} = {wording.coefficient(bound):.6g} of "
            f"asperities of radius R = {mixture.radius:g} mm within h_m = {limits.span:g} mm of height; "
            f"raise the {name} or max_height, or use a smaller radius",
            nearest(bound * (1.0 + INSIDE)),
        )
    largest = ExponentialDensity(FINEST * limits.span, limits.span).asymptotic_slope(*single)
    if slope > largest:  # occurs for contact laws with a finite dA/dP at zero load, such as that of cones
        reached = largest * (1.0 - INSIDE)
        raise Infeasible(
            f"{given} is above {wording.coefficient(largest):.6g}, the largest of asperities with this "
            f"contact law; lower the {name}, or choose another contact law",
            nearest(reached) if reached > bound * (1.0 + INSIDE) else None,
        )
    return scale_from_slope(slope, mixture.radius, limits.span, mixture.law)


def _notes(scale: float, mixture: Mixture, limits: Limits, wording: Wording) -> tuple[Note, ...]:
    if limits.height_sd is None or scale >= FINEST_SCALE_IN_SD * limits.height_sd:
        return ()
    finest = FINEST_SCALE_IN_SD * limits.height_sd
    steepest = ExponentialDensity(finest, limits.span).asymptotic_slope(mixture.radius, mixture.law)
    return (
        Note(
            f"the scale {scale:.4g} mm is below {FINEST_SCALE_IN_SD:g} times height_sd, {finest:.4g} mm: "
            f"height errors will change the law; they will not for {wording.slopes(steepest)} and below",
            quantity="scale",
            value=scale,
            bound=finest,
            remedies=("slope",),
        ),
    )
