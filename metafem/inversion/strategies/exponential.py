"""Heights of linear laws (eqs. S3 to S5) and bilinear laws (eqs. S6 to S8) from exponential densities."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray, IntArray
from metafem.errors import Infeasible
from metafem.inversion.bounds import at_load
from metafem.inversion.candidate import Branch, Candidate, Parameter
from metafem.inversion.feasibility import INSIDE
from metafem.inversion.height_density import (
    FINEST_SCALE_IN_SD,
    TIGHTEST,
    PiecewiseExponential,
    TruncatedExponential,
    TwoBranchExponential,
    equal_masses,
    scale_from_slope,
    uniform_slope,
)
from metafem.inversion.limits import Limits
from metafem.inversion.strategies.mixture import Mixture, best_mixture
from metafem.inversion.targets.target_law import TargetLaw
from metafem.models.model import PARABOLOID
from metafem.notes import Note

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem
    from metafem.inversion.targets.straight import BilinearLaw, LinearLaw
    from metafem.inversion.targets.wording import Wording

# A straight branch is fitted over its last three quarters: below, the law still bends towards its
# asymptote. Over this range the paper's surfaces have the paper's target slopes and scatter.
BRANCH_START = 0.25

# Largest slope, relative to that of the uniform density. The scale falls as the inverse square of the slope;
# here it is as small as the rounding error of the largest height.
STEEPEST = 1e7

# Scale over the span of the heights, below which double precision does not resolve their differences.
FINEST = 2.0**-52

# Number of separations, from the top of a density to its foot, at which its law is the target of a search.
SEPARATIONS = 61


def linear(target: LinearLaw, problem: Problem) -> Candidate:
    """Return heights of the truncated exponential whose law has the target slope."""
    return best_mixture(lambda mixture: _linear(target, mixture, problem.limits), problem)


def bilinear(target: BilinearLaw, problem: Problem) -> Candidate:
    """Return heights of the two-branch exponential whose law has the target slopes and crossover."""
    return best_mixture(lambda mixture: _bilinear(target, mixture, problem.limits), problem)


def _linear(target: LinearLaw, mixture: Mixture, limits: Limits) -> Candidate:
    single, count = (mixture.radius, mixture.law), mixture.count
    scale = _scale(target.slope, mixture, limits, target, lambda slope: replace(target, slope=slope))
    density = TruncatedExponential(scale, limits.span)
    end = float(density.rescaled_load(0.0, mixture.carrying, *single))
    intercept = density.intercept(mixture.carrying, *single)
    parameters: dict[str, Parameter] = {"scale": scale, "intercept": intercept, "foot_load": end}
    if limits.height_step is None:
        height = _middles(density, 0.0, limits.span, count)
    else:
        levels, counts = level_counts(density, count, limits.height_step)
        height = np.repeat(levels, counts)[::-1]
        parameters |= {"levels": limits.foot + levels[counts > 0], "counts": counts[counts > 0]}
    branch = Branch(target.slope, (BRANCH_START * end, end), intercept)
    return Candidate(
        height=limits.foot + height,
        radius=mixture.mixed(),
        parameters=parameters,
        target_law=law_of(density, (branch,), mixture),
        branches=(branch,),
        density=density,
        notes=_notes(scale, mixture, limits, target.wording),
        stepped=limits.height_step is not None,
    )


def _bilinear(target: BilinearLaw, mixture: Mixture, limits: Limits) -> Candidate:
    (first, second), count = target.slopes, mixture.count
    scale = _scale(first, mixture, limits, target, lambda slope: replace(target, slopes=(slope, second)))
    density = _two_branches(target, scale, mixture, limits)
    upper = min(max(round(count * density.upper_mass), 1), count - 1)  # N_1 of regime 1, h > h_c
    middle, top = density.crossover_height, limits.span
    parts = _middles(density, middle, top, upper), _middles(density, 0.0, middle, count - upper)
    height = np.concatenate(parts)
    crossover = target.crossover_load
    end = float(density.rescaled_load(0.0, mixture.carrying, mixture.radius, mixture.law))
    parameters: dict[str, Parameter] = {
        "scale": scale,
        "weight": density.weight,
        "crossover_height": limits.foot + middle,
        "counts": np.array([upper, count - upper]),
        "foot_load": end,
    }
    branches = (
        Branch(first, (BRANCH_START * crossover, crossover)),
        Branch(second, (crossover + BRANCH_START * (end - crossover), end)),
    )
    return Candidate(
        height=limits.foot + height,
        radius=mixture.mixed(),
        parameters=parameters,
        target_law=law_of(density, branches, mixture),
        branches=branches,
        density=density,
        notes=_notes(scale, mixture, limits, target.wording),
    )


def law_of(density: PiecewiseExponential, branches: tuple[Branch, ...], mixture: Mixture) -> TargetLaw:
    """Return the density's law over all branches, at even steps of the separation."""
    separation = density.max_height * (1.0 - np.arange(SEPARATIONS) / (SEPARATIONS - 1))
    asperities = mixture.carrying, mixture.radius, mixture.law
    load = density.rescaled_load(separation, *asperities)
    inside = load >= branches[0].load_range[0]
    area = density.area(separation[inside], *asperities)
    return TargetLaw.fixed(load[inside], area)


def level_counts(density: PiecewiseExponential, count: int, step: float) -> tuple[FloatArray, IntArray]:
    """Levels [mm] at the middles of steps of the height, and whole numbers of asperities on them.

    The numbers are the integers nearest to the expected ones. While their sum is not `count`, one of them
    changes by 1: that whose relative difference from its expectation is then the smallest. The mass above
    the last middle below the maximum height belongs to that level.
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


def _middles(density: PiecewiseExponential, low: float, high: float, count: int) -> FloatArray:
    """Middles of `count` intervals of equal mass between two heights, tallest first [mm]."""
    ends = equal_masses(density.scale, low, high, count)
    return np.asarray(0.5 * (ends[1:] + ends[:-1])[::-1])


def _uniform_slope(mixture: Mixture, limits: Limits) -> float:
    """Return the smallest slope, that of uniformly distributed heights [-]."""
    return uniform_slope(mixture.radius, limits.span, mixture.law)


def _scale(
    slope: float,
    mixture: Mixture,
    limits: Limits,
    target: LinearLaw | BilinearLaw,
    with_slope: Callable[[float], LinearLaw | BilinearLaw],
) -> float:
    """Return the scale at which the truncated exponential has a slope, the only or the first of a target."""
    bound, wording = _uniform_slope(mixture, limits), target.wording
    given, name = wording.slopes(slope), wording.name()
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
            with_slope(bound * (1.0 + INSIDE)),
        )
    finest = TruncatedExponential(FINEST * limits.span, limits.span)
    largest = finest.asymptotic_slope(mixture.radius, mixture.law)
    if slope > largest:  # of a law whose lightest contacts have a finite one, such as cones
        reached = largest * (1.0 - INSIDE)
        raise Infeasible(
            f"{given} is above {wording.coefficient(largest):.6g}, the largest of asperities with this "
            f"contact law; lower the {name}, or choose another contact law",
            with_slope(reached) if reached > bound * (1.0 + INSIDE) else None,
        )
    return scale_from_slope(slope, mixture.radius, limits.span, mixture.law)


def _two_branches(
    target: BilinearLaw, scale: float, mixture: Mixture, limits: Limits
) -> TwoBranchExponential:
    """Solve eq. S8 for u and h_c.

    P_c is proportional to the weight u, so the crossover load fixes u for each h_c; m_2 then fixes h_c.
    """
    single, count, carrying = (mixture.radius, mixture.law), mixture.count, mixture.carrying
    (first, second), crossover, top = target.slopes, target.crossover_load, limits.span
    wording = target.wording
    plain = TruncatedExponential(scale, top)
    full_load = float(plain.rescaled_load(0.0, carrying, *single))
    if crossover >= full_load:
        raise Infeasible(
            f"crossover_load = {wording.loads(crossover)} is outside the law of {wording.slopes(first)}, "
            f"which ends at {wording.loads(full_load)} where the plane reaches the lowest asperity",
            replace(target, slopes=(first, first / 0.75), crossover_load=0.5 * full_load),
        )

    # Where all the mass lies above a crossover height that is `depth` below the top, each asperity carries
    # less than at that depth: the smallest depth. Beyond it the mass above decreases with the depth.
    shallow = float(at_load(mixture.law, np.array([crossover / carrying]), mixture.radius)[0][0])
    if float(plain.rescaled_load(top - shallow, carrying, *single)) == 0.0:
        raise Infeasible(
            f"{wording.slopes(first)} puts so few asperities near the top that double precision resolves no "
            f"load at the crossover; lower the {wording.name()}"
        )

    def weight(middle: float) -> float:
        return crossover / float(plain.rescaled_load(middle, carrying, *single))  # eq. S8, P_c/E*

    def upper_mass(depth: float) -> float:
        return weight(top - depth) * float(plain.mass(top - depth, top))

    deepest = top * (1.0 - INSIDE)
    ends = []
    for share in (1.0 - 0.5 / count, 0.5 / count):  # each branch keeps at least half an asperity
        if upper_mass(deepest) >= share:
            ends.append(deepest)
        elif upper_mass(shallow) <= share:
            ends.append(shallow)
        else:
            excess = partial(lambda share, depth: upper_mass(depth) - share, share)
            ends.append(float(brentq(excess, shallow, deepest, xtol=TIGHTEST * top, rtol=TIGHTEST)))
    shallowest, deepest = ends

    def density(depth: float) -> TwoBranchExponential:
        return TwoBranchExponential(scale, top, top - depth, weight(top - depth))

    def second_slope(depth: float) -> float:
        return density(depth).asymptotic_slopes(*single)[1]  # eq. S8, m_2

    low, high = second_slope(shallowest), second_slope(deepest)
    if not low < high:
        raise Infeasible(
            f"with crossover_load = {wording.loads(crossover)} one of the branches has fewer than 1 of "
            f"{count} asperities; the law of {wording.slopes(first)} ends at {wording.loads(full_load)}: "
            "move the crossover towards its middle, or use more asperities",
            replace(target, slopes=(first, first / 0.75), crossover_load=0.5 * full_load),
        )
    if not low <= second <= high:
        name = wording.name()
        inside = min(max(second, low * (1.0 + INSIDE)), high * (1.0 - INSIDE))
        raise Infeasible(
            f"{wording.keys[1]}[1] = {wording.coefficient(second):g} cannot follow a branch of "
            f"{wording.slopes(first)} up to {wording.loads(crossover)} with {count} asperities: the "
            f"second {name} can be from {wording.slope_bound(low, up=True)} to "
            f"{wording.slope_bound(high, up=False)}",
            replace(target, slopes=(first, inside)),
        )
    depth = brentq(  # eq. S8 for h_c: m_2 is the second slope
        lambda depth: second_slope(depth) - second, shallowest, deepest, xtol=TIGHTEST * top, rtol=TIGHTEST
    )
    return density(float(depth))


def _notes(scale: float, mixture: Mixture, limits: Limits, wording: Wording) -> tuple[Note, ...]:
    if limits.height_sd is None or scale >= FINEST_SCALE_IN_SD * limits.height_sd:
        return ()
    finest = FINEST_SCALE_IN_SD * limits.height_sd
    steepest = TruncatedExponential(finest, limits.span).asymptotic_slope(mixture.radius, mixture.law)
    return (
        Note(
            f"the scale {scale:.4g} mm is below {FINEST_SCALE_IN_SD:g} times height_sd, {finest:.4g} mm: "
            f"height errors will change the law; they will not for {wording.slopes(steepest)} and below"
        ),
    )
