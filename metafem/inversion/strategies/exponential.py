"""Heights of linear (S3 to S5) and bilinear (S6 to S8) laws from exponential densities."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import brentq

from metafem._validate import FloatArray, IntArray
from metafem.contact import Hertz
from metafem.errors import Infeasible
from metafem.inversion.candidate import Blueprint, Branch, Parameter
from metafem.inversion.height_density import (
    PiecewiseExponential,
    TruncatedExponential,
    TwoBranchExponential,
    equal_masses,
    scale_from_slope,
    uniform_slope,
)
from metafem.inversion.limits import Limits
from metafem.inversion.radii import Radii
from metafem.inversion.strategies.mixture import Mixture, best_mixture
from metafem.inversion.targets.laws import BilinearLaw, LinearLaw
from metafem.inversion.targets.wanted import Wanted
from metafem.inversion.targets.wording import Wording
from metafem.notes import Note

# A straight branch is judged over its last three quarters: below, the law still bends towards its
# asymptote. Over this range the paper's surfaces give its target slopes and its scatter.
BRANCH_START = 0.25

# brentq's tightest relative tolerance.
TIGHTEST = 4.0 * np.finfo(float).eps

# A bound is left by this relative step where the nearest reachable law is offered.
INSIDE = 1e-6

# The scale falls as the square of the slope: here it is a rounding error of the largest height.
STEEPEST = 1e7

# Separations from the top of a density to its foot at which its law is asked of other models.
LAW_POINTS = 61

# A scale below this many standard deviations of the made heights no longer makes an exponential
# density: the source paper's rule of thumb, doi:10.1126/science.adk4234.
FINEST_SCALE_IN_SD = 10.0


def invert_linear(
    target: LinearLaw, radii: Radii, count: int, limits: Limits, rng: np.random.Generator
) -> Blueprint:
    """Return heights of the truncated exponential whose law has the wanted slope."""
    return best_mixture(lambda mixture: _linear(target, mixture, limits), radii, count)


def invert_bilinear(
    target: BilinearLaw, radii: Radii, count: int, limits: Limits, rng: np.random.Generator
) -> Blueprint:
    """Return heights of the two-branch exponential whose law has the wanted slopes and crossover."""
    return best_mixture(lambda mixture: _bilinear(target, mixture, limits), radii, count)


def _linear(target: LinearLaw, mixture: Mixture, limits: Limits) -> Blueprint:
    radius, count = mixture.radius, mixture.count
    nearest = replace(target, slope=_lowest_slope(radius, limits))
    scale = _scale(target.slope, radius, limits, nearest)
    density = TruncatedExponential(scale, limits.span)
    end = float(density.rescaled_load(0.0, mixture.carrying, radius))
    intercept = density.intercept(mixture.carrying, radius)
    parameters: dict[str, Parameter] = {"scale": scale, "intercept": intercept, "foot_load": end}
    if limits.height_step is None:
        height = _middles(density, 0.0, limits.span, count)
    else:
        levels, counts = level_counts(density, count, limits.height_step)
        height = np.repeat(levels, counts)[::-1]
        parameters |= {"levels": limits.foot + levels[counts > 0], "counts": counts[counts > 0]}
    branch = Branch(target.slope, (BRANCH_START * end, end), intercept)
    wanted = law_of(density, (branch,), mixture)
    return Blueprint(
        height=limits.foot + height,
        radius=mixture.dealt(),
        parameters=parameters,
        wanted=wanted,
        branches=(branch,),
        density=density,
        notes=_notes(scale, mixture, limits, target.wording),
        stepped=limits.height_step is not None,
    )


def _bilinear(target: BilinearLaw, mixture: Mixture, limits: Limits) -> Blueprint:
    (first, second), radius, count = target.slopes, mixture.radius, mixture.count
    floor = _lowest_slope(radius, limits)
    scale = _scale(first, radius, limits, replace(target, slopes=(floor, second)))
    density = _two_branches(target, scale, mixture, limits)
    upper = min(max(round(count * density.upper_mass), 1), count - 1)
    middle, top = density.crossover_height, limits.span
    height = np.concatenate(
        [_middles(density, middle, top, upper), _middles(density, 0.0, middle, count - upper)]
    )
    crossover, end = target.crossover_load, float(density.rescaled_load(0.0, mixture.carrying, radius))
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
    return Blueprint(
        height=limits.foot + height,
        radius=mixture.dealt(),
        parameters=parameters,
        wanted=law_of(density, branches, mixture),
        branches=branches,
        density=density,
        notes=_notes(scale, mixture, limits, target.wording),
    )


def law_of(density: PiecewiseExponential, branches: tuple[Branch, ...], mixture: Mixture) -> Wanted:
    """Return the density's law over all branches, at even steps of the separation."""
    separation = density.max_height * (1.0 - np.arange(LAW_POINTS) / (LAW_POINTS - 1))
    load = density.rescaled_load(separation, mixture.carrying, mixture.radius)
    inside = load >= branches[0].load_range[0]
    area = density.area(separation[inside], mixture.carrying, mixture.radius)
    return Wanted.exactly(load[inside], area)


def level_counts(density: PiecewiseExponential, count: int, step: float) -> tuple[FloatArray, IntArray]:
    """Levels [mm] at the middles of steps of the height, and whole numbers of asperities on them.

    The nearest integers to the expectations; while their sum is not `count`, the level changes by one
    whose number then differs least from its expectation, relative to it. Mass above the last middle
    that fits below the maximum height goes to that level.
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


def _lowest_slope(radius: float, limits: Limits) -> float:
    return uniform_slope(radius, limits.span) * (1.0 + INSIDE)


def _scale(slope: float, radius: float, limits: Limits, nearest: LinearLaw | BilinearLaw) -> float:
    bound, wording = uniform_slope(radius, limits.span), nearest.wording
    told, name = wording.slopes(slope), wording.name()
    if slope > STEEPEST * bound:
        raise Infeasible(
            f"{told} exceeds {STEEPEST:g} times the bound {wording.coefficient(bound):.6g}: the heights "
            f"would differ by less than double precision can tell; lower the {name}",
        )
    if slope <= bound:
        pair = "" if wording.per_slope is None else " sigma B/E*"
        raise Infeasible(
            f"{told} is not above the bound 3 pi/4 sqrt(R/h_m){pair} = {wording.coefficient(bound):.6g} of "
            f"asperities of radius {radius:g} mm within {limits.span:g} mm of height; raise the {name} or "
            "max_height, or use a smaller radius",
            nearest,
        )
    return scale_from_slope(slope, radius, limits.span)


def _two_branches(
    target: BilinearLaw, scale: float, mixture: Mixture, limits: Limits
) -> TwoBranchExponential:
    """Solve S8: the crossover load gives the weight at each crossover height, m_2 then the height."""
    radius, count, carrying = mixture.radius, mixture.count, mixture.carrying
    (first, second), crossover, top = target.slopes, target.crossover_load, limits.span
    wording = target.wording
    plain = TruncatedExponential(scale, top)
    full_load = float(plain.rescaled_load(0.0, carrying, radius))
    if crossover >= full_load:
        raise Infeasible(
            f"crossover_load = {wording.loads(crossover)} is outside the law of {wording.slopes(first)}, "
            f"which ends at {wording.loads(full_load)} where the plane reaches the lowest asperity",
            replace(target, slopes=(first, first / 0.75), crossover_load=0.5 * full_load),
        )

    def weight(middle: float) -> float:
        return crossover / float(plain.rescaled_load(middle, carrying, radius))

    def upper_mass(depth: float) -> float:
        return weight(top - depth) * float(plain.mass(top - depth, top))

    # The whole mass above a crossover height that lies `depth` below the top has <d^1.5> <= depth^1.5;
    # from there on the mass falls with the depth.
    shallow = float(Hertz().indentation_at_load(crossover / carrying, radius))
    deepest = top * (1.0 - INSIDE)
    ends = []
    for share in (1.0 - 0.5 / count, 0.5 / count):  # half an asperity rounds to one
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
        return density(depth).asymptotic_slopes(radius)[1]

    low, high = second_slope(shallowest), second_slope(deepest)
    if not low < high:
        raise Infeasible(
            f"crossover_load = {wording.loads(crossover)} leaves less than one of {count} asperities to one "
            f"of the branches; the law of {wording.slopes(first)} ends at {wording.loads(full_load)}: move "
            "the crossover towards its middle, or use more asperities",
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
    depth = brentq(
        lambda depth: second_slope(depth) - second, shallowest, deepest, xtol=TIGHTEST * top, rtol=TIGHTEST
    )
    return density(float(depth))


def _notes(scale: float, mixture: Mixture, limits: Limits, wording: Wording) -> tuple[Note, ...]:
    if limits.height_sd is None or scale >= FINEST_SCALE_IN_SD * limits.height_sd:
        return ()
    finest = FINEST_SCALE_IN_SD * limits.height_sd
    steepest = TruncatedExponential(finest, limits.span).asymptotic_slope(mixture.radius)
    return (
        Note(
            f"the scale {scale:.4g} mm is below {FINEST_SCALE_IN_SD:g} times height_sd, {finest:.4g} mm: "
            f"errors of made heights will shape the law; {wording.slopes(steepest)} and below are free of "
            "that"
        ),
    )
