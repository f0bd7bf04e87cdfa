"""Heights whose law passes through given points: one level and one adjustment asperity a point (eq. S1).

With one radius the level of each point is unique, given those before it. With several radii there can be
many levels, also where the earlier asperities have more friction; they are tried in turn. If no levels meet
the points and no bound excludes them, heights without levels are searched for.
"""

from __future__ import annotations

import numpy as np

from metafem.errors import Infeasible
from metafem.inversion.candidate import Blueprint, Parameter
from metafem.inversion.feasibility import refuse_sampled
from metafem.inversion.limits import Limits
from metafem.inversion.radii import Radii
from metafem.inversion.search.levenberg_marquardt import POINT_GOAL, Heights, descend
from metafem.inversion.search.multistart import MIXED_RESTARTS, LawSearch, law_of_heights, nearest_law
from metafem.inversion.strategies.level import Level, Step
from metafem.inversion.strategies.sampled import wanted_law
from metafem.inversion.targets.laws import OperatingPoints, SampledLaw
from metafem.models import Independent
from metafem.notes import information

# Most levels that are tried, about 0.2 ms each.
MOST_TRIED = 5_000

# Where no levels meet the points: misfits at which the random search ends and a descent to rounding begins,
# and the restarts of the search. A descent can end at a kink; the next misfit gives another initial guess.
FREE_GOALS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-11)
FREE_RESTARTS = 30

# Largest misfit of heights without levels that is accepted and stated: far below the effect of height errors.
NEARLY = 1e-3


def invert(
    target: OperatingPoints, radii: Radii, count: int, limits: Limits, rng: np.random.Generator
) -> Blueprint:
    """Return heights whose independent law passes through all points, or raise Infeasible."""
    singles = [_Search(target, (radius,), count, limits) for radius in radii.tried.tolist()]
    paths = [path for search in singles if (path := search.path(()))]
    last = singles[-1]
    if not paths and not radii.single:
        last = _Search(target, tuple(radii.tried.tolist()), count, limits)
        paths = [path for path in [last.path(())] if path]
    if paths:
        fewest = min(paths, key=lambda levels: sum(level.count for level in levels))
        return _blueprint(target, fewest, radii, limits)
    if not last.limited and not _proven(target, radii, count, limits):
        for choice in dict.fromkeys(
            (radii.extremes, radii)
        ):  # the extremes leave more room for the refinement
            if blueprint := _without_levels(target, choice, count, limits, rng):
                return blueprint
    raise last.refused if last.refused is not None else Infeasible("no way to meet the points was found")


def _proven(target: OperatingPoints, radii: Radii, count: int, limits: Limits) -> bool:
    """Return whether the points break a bound of every surface."""
    try:
        samples = SampledLaw(target.rescaled_load, target.rescaled_friction)
        refuse_sampled(samples, radii, count, limits, 0.0)
    except Infeasible:
        return True
    return False


def _blueprint(target: OperatingPoints, path: tuple[Level, ...], radii: Radii, limits: Limits) -> Blueprint:
    height, radius, number = np.array([kind for level in path for kind in level.kinds]).T
    tops = np.array([level.height for level in path])
    parameters: dict[str, Parameter] = {
        "counts": np.array([level.number for level in path]),
        "levels": limits.offset + tops,
        "adjustment_heights": limits.offset
        + tops
        - np.array([level.depth - level.adjustment for level in path]),
    }
    if not radii.single:
        parameters["level_radii"] = np.array([level.radius for level in path])
        parameters["adjustment_radii"] = np.array([level.other for level in path])
    wanted = wanted_law(target)
    each = np.repeat(np.arange(len(number)), number.astype(np.int64))
    return Blueprint(
        limits.offset + height[each],
        radius[each],
        parameters,
        wanted,
        spare_height=limits.offset + float(tops[-1]),
    )


def _without_levels(
    target: OperatingPoints, radii: Radii, count: int, limits: Limits, rng: np.random.Generator
) -> Blueprint | None:
    """Return the best heights and radii found without levels, or None if they miss the points."""
    wanted = wanted_law(target)
    top, load = limits.offset + limits.max_height, wanted.load
    best: Blueprint | None = None
    misfit = NEARLY
    restarts = FREE_RESTARTS if radii.single else FREE_RESTARTS // MIXED_RESTARTS
    for goal in FREE_GOALS:
        task = LawSearch(wanted, [wanted.base], count, limits.span, restarts, rng, goal)
        height, radius = nearest_law(task, radii)
        evaluate = law_of_heights(radius, load)
        found = descend(evaluate, height, wanted, Heights(limits.span), POINT_GOAL, patient=True)
        height = found.unknowns - found.unknowns.max()
        approach = float(Independent().curves(height, radius, load[-1:])[0][0, 0])
        if found.misfit < misfit and approach <= top:
            misfit, order = found.misfit, np.argsort(-height, kind="stable")
            parameters: dict[str, Parameter] = {"span": float(np.ptp(height))}
            note = "no levels of equal heights meet the points: the heights were found by a search"
            best = Blueprint(
                top + height[order], radius[order], parameters, wanted, notes=(information(note),),
                spare_height=top + float(height.min()),
            )  # fmt: skip
        if misfit <= POINT_GOAL:
            break
    return best


class _Search:
    """Depth-first search for levels that meet all points; `refused` says why the last one was not met."""

    def __init__(self, target: OperatingPoints, tools: tuple[float, ...], count: int, limits: Limits) -> None:
        self.target, self.tools, self.count, self.limits = target, tools, count, limits
        self.refused: Infeasible | None = None
        self.furthest = -1
        self.limited = False
        self.tried = 0

    def path(self, done: tuple[Level, ...]) -> tuple[Level, ...] | None:
        """Return levels for all points that begin with those done, or None."""
        i = len(done)
        if i == len(self.target.rescaled_load):
            return done
        level = done[-1].height - done[-1].depth if done else self.limits.max_height
        step = Step(done, level, self.target.rescaled_load[i], self.target.rescaled_friction[i])
        left = self.count - sum(part.count for part in done)
        used = {part.radius for part in done}
        ways = sorted(step.ways(self.tools, left), key=lambda way: (way.radius not in used, way.count))
        if not ways:
            self.refuse(i, _unmet(self.target, i, step, self.tools, left), limited=False)
        for way in ways:
            self.tried += 1
            if self.tried > MOST_TRIED:
                break
            reason = _too_low(i, way, self.limits)
            if reason is not None:
                self.refuse(i, reason, limited=True)
            elif found := self.path((*done, way)):
                return found
        return None

    def refuse(self, i: int, reason: Infeasible, limited: bool) -> None:
        """Keep the first reason at the furthest point, and whether it is a manufacturing limit."""
        if i > self.furthest:
            self.furthest, self.refused, self.limited = i, reason, limited


def _unmet(target: OperatingPoints, i: int, step: Step, tools: tuple[float, ...], left: int) -> Infeasible:
    """Return why no level meets a point, with the range of friction that levels can have there."""
    fewest = [step.friction_with(step.fewest, radius) for radius in tools]
    most = [step.friction_with(left, radius) for radius in tools] if left >= step.fewest else []
    low, high = min(fewest + most), max(fewest + most)
    if step.friction < low:
        cause = "the asperities that the earlier points need" if i else "a single asperity"
        reason = f"{cause} already {'have' if i else 'has'} more friction ({left} asperities are left)"
        nearest = low
    elif step.friction > high:
        needed = min(step.needed(radius) for radius in tools)
        reason = f"at least {needed:.0f} more asperities are needed, {left} are left"
        # below the bound by more than rounding, so that no further asperity is needed
        nearest = max(high * (1.0 - 1e-9), low)
    else:
        reason = "no whole number of asperities of these radii has this load and friction"
        nearest = min(fewest + most, key=lambda friction: abs(friction - step.friction))
    wording = target.wording
    load = wording.loads(target.rescaled_load[i])
    friction = wording.frictions(target.rescaled_friction[i])
    return Infeasible(
        f"operating point {i + 1} (load {load}, friction {friction}) is not met: {reason}. After levels for "
        f"the earlier points, the friction at this load can be from {wording.frictions(low, high)}",
        OperatingPoints(target.rescaled_load[: i + 1], [*target.rescaled_friction[:i], nearest], wording),
    )


def _too_low(i: int, level: Level, limits: Limits) -> Infeasible | None:
    """Return why a level cannot be made: summits below the limits, or contact with the base plane."""
    lowest = min(height for height, _, number in level.kinds if number) if level.count else level.height
    plane = level.height - level.depth
    short = limits.min_height - lowest
    if short > 0.0:
        return Infeasible(
            f"operating point {i + 1} needs a summit at {lowest:.6g} mm, below min_height = "
            f"{limits.min_height:g} mm; raise max_height = {limits.max_height:g} mm by {short:.3g} mm"
        )
    if limits.offset + plane < 0.0:
        return Infeasible(
            f"at operating point {i + 1} the plane would reach the base plane; raise offset = "
            f"{limits.offset:g} mm or max_height by {-limits.offset - plane:.3g} mm"
        )
    return None
