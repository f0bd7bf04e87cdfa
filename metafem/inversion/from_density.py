"""Heights from exponential densities, for linear laws (eqs. S3 to S5) and bilinear laws (eqs. S6 to S8)."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from metafem.errors import Infeasible, InvalidInput
from metafem.inversion.density import (
    FINEST_SCALE_IN_SD,
    Crossing,
    ExponentialDensity,
    level_counts,
    middles,
    scale_from_slope,
    uniform_slope,
)
from metafem.inversion.guesses import placed
from metafem.inversion.problem import Branch, Candidate, Parameter, Problem, misfit
from metafem.inversion.target_law import TargetLaw
from metafem.notes import Note

# A straight line is fitted to a branch beyond this fraction of its load range. At smaller loads the law still
# bends towards its asymptote. With this range the surfaces of Aymard et al. have their published slopes and
# scatter.
BRANCH_START = 0.25

# Largest slope, relative to the slope of the uniform density. The scale decreases with the inverse square of
# the slope. At this slope it is as small as the rounding error of the largest height.
STEEPEST = 1e7

# Number of separations, from the top to the foot of a density, at which its law is compared with the law of
# the heights.
SEPARATIONS = 61

# The nearest reachable slope is inside its bound by this relative distance.
INSIDE = 1e-6

# Number of crossover loads that are tried for a pair of slopes that is refused, evenly spaced.
TRIED = 100


def from_density(problem: Problem, rng: np.random.Generator) -> Candidate:
    """Return heights that follow a density of one or two branches whose law has the target slopes.

    The density is that of Hertz contacts; under another law the heights are then refined. Of several tools,
    the one is used whose heights have the nearest law and need no warning.
    """
    found: list[tuple[bool, float, Candidate]] = []
    reasons: list[tuple[Any, Infeasible]] = []
    for tool in problem.tools.tried.tolist():
        (law, _), chosen = problem.tools.laws[tool], problem.tools.all[tool]
        words = f"{problem.target.title}: without load_range the heights follow the density of Hertz contacts"
        if law.without_adhesion.power not in (None, 2.0):
            raise Infeasible(f"{words}, and {law!r} has no curvature; give load_range")
        try:
            radius = float(chosen.cap.summit_radius(np.array([chosen.radius]))[0])
        except InvalidInput as error:
            raise Infeasible(f"{words}, and a summit {error}; give load_range") from None
        try:
            one = _of_radius(problem, radius, tool, rng)
        except Infeasible as reason:
            reasons.append((problem.tools.all[tool], reason))
            continue
        warned = any(note.warns for note in one.notes)
        found.append((warned, misfit(problem, one.asperities, one.law, problem.uncoupled), one))
    if found:
        return min(found, key=lambda each: each[:2])[2]
    first, last = reasons[0], reasons[-1]
    if len(reasons) == 1:
        raise first[1]
    both = "; ".join(f"with {tool!r}, {reason}" for tool, reason in (first, last))
    raise Infeasible(f"no tool reaches the target: {both}", first[1].nearest)


def _of_radius(problem: Problem, radius: float, tool: int, rng: np.random.Generator) -> Candidate:
    target: Any = problem.target
    limits, count = problem.limits, problem.count
    plain = ExponentialDensity(_scale(problem, radius), limits.span)
    density = plain if len(target.lines) == 1 else _two_branches(target, plain, count, radius)
    end = float(density.rescaled_load(0.0, count, radius))
    found: dict[str, Parameter] = {"scale": plain.scale}
    intercept, stepped, middle, top = None, False, density.crossover_height, limits.span
    if density is plain:
        intercept = plain.intercept(count, radius)
        found |= {"intercept": intercept}
        height = middles(plain, 0.0, top, count)
        if limits.height_step is not None:
            levels, numbers = level_counts(plain, count, limits.height_step)
            height, stepped, used = np.repeat(levels, numbers)[::-1], True, numbers > 0
            found |= {"levels": limits.foot + levels[used], "counts": numbers[used]}
    else:
        upper = min(max(round(count * density.upper_mass), 1), count - 1)  # N_1 of regime 1, h > h_c
        parts = middles(density, middle, top, upper), middles(density, 0.0, middle, count - upper)
        height = np.concatenate(parts)
        found |= {"weight": density.weight, "crossover_height": limits.foot + middle}
        found |= {"counts": np.array([upper, count - upper])}
    starts = [start for _, start in target.lines]
    branches = tuple(
        Branch(slope, (start + BRANCH_START * (stop - start), stop), intercept)
        for (slope, _), (start, stop) in zip(target.lines, pairwise([*starts, end]), strict=True)
    )
    at = placed(problem, height - height[0], np.full(count, tool), rng, top=limits.foot + height[0])
    return Candidate(
        at, law_of(density, branches, count, radius), found={**found, "foot_load": end}, branches=branches,
        density=density, notes=_notes(problem, plain.scale, radius), stepped=stepped,
    )  # fmt: skip


def law_of(density: ExponentialDensity, branches: tuple[Branch, ...], count: int, radius: float) -> TargetLaw:
    """Return the law of a density at evenly spaced separations, from the start of the first fit."""
    separation = density.max_height * (1.0 - np.arange(SEPARATIONS) / (SEPARATIONS - 1))
    load = density.rescaled_load(separation, count, radius)
    inside = load >= branches[0].load_range[0]
    return TargetLaw.of(load[inside], density.area(separation[inside], count, radius))


def _scale(problem: Problem, radius: float) -> float:
    """Return the scale [mm] at which the truncated exponential has the only or first slope of a target."""
    target: Any = problem.target
    slope, wording, span = target.lines[0][0], target.wording, problem.limits.span
    bound = uniform_slope(radius, span)
    given, name = wording.slopes(slope), wording.name()
    if slope > STEEPEST * bound:
        raise Infeasible(
            f"{given} exceeds {STEEPEST:g} times the bound {wording.coefficient(bound):.6g}: the heights "
            f"would differ by less than double precision resolves; lower the {name}",
        )
    if slope <= bound:
        pair = "" if wording.per_slope is None else " sigma B/E*"
        # 3 pi/4 sqrt(R/h) has the slope at this radius, and at this height
        smaller, higher = radius * (slope / bound) ** 2, span * (bound / slope) ** 2
        steeper = bound * (1.0 + INSIDE)
        one = len(target.lines) == 1
        nearest = (
            replace(target, slope=steeper) if one else replace(target, slopes=(steeper, target.slopes[1]))
        )
        raise Infeasible(
            f"{given} is not above the bound 3 pi/4 sqrt(R/h_m){pair} = {wording.coefficient(bound):.6g} of "
            f"asperities of radius R = {radius:g} mm within h_m = {span:g} mm of height; use a radius below "
            f"{smaller:.3g} mm, heights of more than {higher:.3g} mm, or a larger {name}",
            nearest,
        )
    return scale_from_slope(slope, radius, span)


def _notes(problem: Problem, scale: float, radius: float) -> tuple[Note, ...]:
    sd, wording = problem.limits.height_sd, problem.target.wording
    if sd is None or scale >= FINEST_SCALE_IN_SD * sd:
        return ()
    finest = FINEST_SCALE_IN_SD * sd
    steepest = ExponentialDensity(finest, problem.limits.span).asymptotic_slope(radius)
    return (
        Note(
            f"the scale {scale:.4g} mm is below {FINEST_SCALE_IN_SD:g} times height_sd, {finest:.4g} mm: "
            f"height errors will change the law; they will not for {wording.slopes(steepest)} and below",
            quantity="scale", value=scale, bound=finest, remedies=("slope",),
        ),
    )  # fmt: skip


def _two_branches(target: Any, plain: ExponentialDensity, count: int, radius: float) -> ExponentialDensity:
    """Return the density with the slopes and crossover load of a target, or raise Infeasible.

    `plain` is the truncated exponential density with the first slope.
    """
    (first, second), wording = target.slopes, target.wording
    crossing = Crossing(plain, target.crossover_load, count, radius)
    low, high = crossing.second_slopes if crossing.possible else (1.0, 0.0)
    if low <= second <= high:
        return crossing.density_of(second)
    loads = crossing.full_load * np.arange(1, TRIED) / TRIED
    within = [load for load in loads.tolist() if _has(replace(crossing, load=load), second)]
    words, nearest = "", None
    if within:
        words = f"; with these slopes crossover_load can be from {wording.inside(within[0], within[-1])}"
        nearest = replace(target, crossover_load=float(np.clip(crossing.load, within[0], within[-1])))
    given, end = wording.loads(crossing.load), wording.loads(crossing.full_load)
    if low < high:
        inside = min(max(second, low * (1.0 + INSIDE)), high * (1.0 - INSIDE))
        ends = f"{wording.slope_bound(low, up=True)} to {wording.slope_bound(high, up=False)}"
        raise Infeasible(
            f"{wording.keys[1]}[1] = {wording.coefficient(second):g} cannot follow a branch of "
            f"{wording.slopes(first)} up to {given} with {count} asperities: the second {wording.name()} can "
            f"be from {ends}{words}",
            replace(target, slopes=(first, inside)),
        )
    if crossing.possible:
        reason = f"one of the branches has fewer than 1 of {count} asperities"
    elif crossing.load < crossing.full_load:
        reason = "so few asperities are near the top that double precision resolves no load at the crossover"
    else:
        reason = (
            f"the law of {wording.slopes(first)} ends at {end}, where the plane reaches the lowest asperity"
        )
    raise Infeasible(f"with crossover_load = {given} {reason}{words or '; use more asperities'}", nearest)


def _has(crossing: Crossing, second: float) -> bool:
    """Return whether a second slope is possible."""
    if not crossing.possible:
        return False
    low, high = crossing.second_slopes
    return low <= second <= high
