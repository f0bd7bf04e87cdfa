"""Heights whose law passes through points, with one level and one adjustment asperity per point (eq. S1).

With one radius, the previous levels determine the level of each point. With several radii many
levels can meet a point, and they are tried in turn. If no levels meet the points and no bound excludes the
points, a search for heights without levels follows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from metafem.errors import Infeasible
from metafem.inversion.assessment import POINT_GOAL
from metafem.inversion.candidate import Candidate, Parameter
from metafem.inversion.feasibility import broken_bound
from metafem.inversion.search.levenberg_marquardt import descend
from metafem.inversion.search.nearest_law import MIXED_RESTARTS, LawSearch, residual_of_heights
from metafem.inversion.search.spaces import Heights
from metafem.inversion.strategies.level import Level, Step, asperities
from metafem.inversion.targets.wording import Message
from metafem.models.model import has_paraboloids
from metafem.notes import information

if TYPE_CHECKING:
    from metafem.inversion.limits import Limits, Radii
    from metafem.inversion.problem import Problem
    from metafem.inversion.targets.laws import OperatingPoints

# Relative increase of the friction from point to point in a nearest law whose friction would otherwise not
# increase.
APART = 1e-6

# Maximum number of searches for the later points of the nearest law. Each search takes as long as the failed
# search, and hundreds of points could each need a search. After this number, the nearest law ends at the
# point that is not met.
MOST_MOVED = 20

# Distance of a level below the plane at the previous point, relative to the indentation of the previous
# level. With this distance no level touches the plane at the previous point. It is used for contact laws
# whose kinks at new contacts are sharper than those of Hertz's law.
LEVEL_DROP = 0.05

# Maximum number of levels that a search tries, about 0.2 ms each.
MOST_LEVELS = 5_000

# Heights without levels are accepted up to this misfit, which is far below the effect of height errors.
ACCEPTED = 1e-3

# Under a model with interaction, such heights are accepted up to this multiple of the interaction margin,
# because they are refined later. For points of 67 random surfaces the ratio was up to 1.8.
MARGINS = 4.0


def candidate(
    target: OperatingPoints, problem: Problem, rng: np.random.Generator, restarts: int | None = None
) -> Candidate:
    """Return heights whose independent law passes through all points, or raise Infeasible."""
    radii, paths = problem.radii, list[tuple[Level, ...]]()
    for drop in dict.fromkeys((0.0 if has_paraboloids(problem.model) else LEVEL_DROP, 0.0)):
        singles = [_Search(target, (radius,), problem, drop) for radius in radii.tried.tolist()]
        paths = [path for search in singles if (path := search.path(()))]
        last = singles[-1]
        if not paths and not radii.single:
            last = _Search(target, tuple(radii.tried.tolist()), problem, drop)
            paths = [path for path in [last.path(())] if path]
        if paths:
            break
    if paths:
        fewest = min(paths, key=lambda levels: sum(level.count for level in levels))
        return _with_levels(target, fewest, problem)
    # levels and bounds are those of independent asperities: under another model, bounds exclude points only
    # beyond the interaction margin
    margin = problem.interaction_margin()
    highest = (1.0 + margin) * problem.bounds.largest_load(problem.limits)
    broken = broken_bound(target.rescaled_load, target.rescaled_friction, problem.bounds, margin)
    searched = not (last.limited and margin == 0.0) and target.last_load <= highest and broken is None
    if searched:
        # a search with only the extreme radii comes first: they leave the refinement more freedom
        for choice in dict.fromkeys((radii.extremes, radii)):
            if found := _without_levels(target, choice, problem, rng, max(ACCEPTED, MARGINS * margin)):
                return found
    refused = last.refused or Infeasible("no heights that meet the points were found")
    raise Infeasible(refused.message, _nearest(last), by_search=searched)


def _with_levels(target: OperatingPoints, path: tuple[Level, ...], problem: Problem) -> Candidate:
    offset = problem.limits.offset
    height, radius = asperities(path)
    tops = np.array([level.height for level in path])
    below = np.array([level.depth - level.adjustment for level in path])
    parameters: dict[str, Parameter] = {
        "counts": np.array([level.number for level in path]),
        "levels": offset + tops,
        "adjustment_heights": offset + tops - below,
    }
    if not problem.radii.single:
        parameters["level_radii"] = np.array([level.radius for level in path])
        parameters["adjustment_radii"] = np.array([level.other for level in path])
    lowest = offset + float(tops[-1])
    return Candidate(offset + height, radius, parameters, target.curve(), lowest_level=lowest)


def _without_levels(
    target: OperatingPoints, radii: Radii, problem: Problem, rng: np.random.Generator, accepted: float
) -> Candidate | None:
    """Return the best heights and radii found without levels, or None if their misfit is not accepted."""
    law, limits, effort = target.curve(), problem.limits, problem.effort
    top, load = limits.top, law.load
    best: Candidate | None = None
    misfit = accepted
    restarts = effort.restarts if radii.single else effort.restarts // MIXED_RESTARTS
    for goal in effort.free_goals:
        height, radius = LawSearch(problem, law, [law.base], restarts, rng, goal).nearest(radii)
        residual = residual_of_heights(problem.independent, radius, law)
        found = descend(residual, height, Heights(limits.span), POINT_GOAL, True, problem.options)
        height = found.unknowns - found.unknowns.max()
        approach = float(problem.independent.curve_of(height, radius, load[-1:]).approach[0])
        if found.misfit < misfit and approach <= top:
            misfit, order = found.misfit, np.argsort(-height, kind="stable")
            note = "no levels of equal heights meet the points: the heights were found by a search"
            best = Candidate(
                top + height[order], radius[order], {"span": float(np.ptp(height))}, law,
                notes=(information(note),), lowest_level=top + float(height.min()),
            )  # fmt: skip
        if misfit <= POINT_GOAL:
            break
    return best


def _nearest(search: _Search) -> OperatingPoints | None:
    """Return nearby points that levels can meet after a failed search, or None if no such points are known.

    If possible, only the point that is not met changes. Its new friction is the nearest friction of levels at
    this point, or otherwise the friction of a law through the other points. If this fails, later points also
    change, or they are omitted if they cannot be met.
    """
    target, nearest = search.target, search.unmet
    if nearest is None:
        return None
    i, friction = len(nearest.rescaled_load) - 1, target.rescaled_friction
    for value in (float(nearest.rescaled_friction[i]), search.of_others(i)):
        moved = friction.copy()
        moved[i] = value
        if (np.diff(moved) > 0.0).all():
            trial = replace(target, rescaled_friction=moved)
            if search.of(trial).path(()) is not None:
                return trial
    for _ in range(MOST_MOVED):
        if len(nearest.rescaled_load) == len(friction):
            break
        number = len(nearest.rescaled_load)
        # friction must increase: later points below the changed point are raised just above it
        steps = (1.0 + APART) ** np.arange(1, len(friction) - number + 1)
        later = np.maximum(friction[number:], nearest.rescaled_friction[-1] * steps)
        moved = np.append(nearest.rescaled_friction, later)
        if not (np.diff(moved) > 0.0).all():
            break
        trial = replace(target, rescaled_friction=moved)
        following = search.of(trial)
        if following.path(()) is not None:
            return trial
        if following.unmet is None or len(following.unmet.rescaled_load) <= number:
            break
        nearest = following.unmet
    return nearest


@dataclass
class _Search:
    """Depth-first search for levels that meet all points; `refused` is the reason if a point is not met."""

    target: OperatingPoints
    tools: tuple[float, ...]
    problem: Problem
    drop: float  # distance of a level below the plane at the previous point, over the previous level's depth
    refused: Infeasible | None = None
    furthest: int = -1
    limited: bool = False
    tried: int = 0

    @property
    def unmet(self) -> OperatingPoints | None:
        """Points up to the point that is not met, where the friction is the nearest attainable friction."""
        return None if self.refused is None else self.refused.nearest

    def of(self, target: OperatingPoints) -> _Search:
        """Return the same search for another target."""
        return _Search(target, self.tools, self.problem, self.drop)

    def of_others(self, i: int) -> float:
        """Return the friction [mm^2] of a law through the other points at point i; nan without such a law."""
        load, friction = self.target.rescaled_load, self.target.rescaled_friction
        if len(load) == 1:
            return math.nan
        others = replace(
            self.target, rescaled_load=np.delete(load, i), rescaled_friction=np.delete(friction, i)
        )
        levels = self.of(others).path(())
        if levels is None:
            return math.nan
        curve = self.problem.independent.curve_of(*asperities(levels), load[i : i + 1])
        return float(curve.area[0])

    def path(self, done: tuple[Level, ...]) -> tuple[Level, ...] | None:
        """Return levels for all points that begin with the levels `done`, or None."""
        i = len(done)
        if i == len(self.target.rescaled_load):
            return done
        level = self.problem.limits.max_height
        if done:
            level = done[-1].height - (1.0 + self.drop) * done[-1].depth
        point = self.target.rescaled_load[i], self.target.rescaled_friction[i]
        step = Step(self.problem.independent.contact, done, level, *point)
        left = self.problem.count - sum(part.count for part in done)
        used = {part.radius for part in done}
        found = sorted(step.levels(self.tools, left), key=lambda each: (each.radius not in used, each.count))
        if not found:
            self.refuse(i, _unmet(self.target, i, step, self.tools, left), limited=False)
        for next_level in found:
            self.tried += 1
            if self.tried > MOST_LEVELS:
                break
            reason = _too_low(i, next_level, self.problem.limits)
            if reason is not None:
                self.refuse(i, reason, limited=True)
            elif path := self.path((*done, next_level)):
                return path
        return None

    def refuse(self, i: int, reason: Infeasible, limited: bool) -> None:
        """Store the first reason at the last point reached, and whether it is a manufacturing limit."""
        if i > self.furthest:
            self.furthest, self.refused, self.limited = i, reason, limited


def _unmet(target: OperatingPoints, i: int, step: Step, tools: tuple[float, ...], left: int) -> Infeasible:
    """Return the error that no level meets a point; it states the attainable range of friction there."""
    fewest = [step.friction_with(step.fewest, radius) for radius in tools]
    most = [step.friction_with(left, radius) for radius in tools] if left >= step.fewest else []
    low, high = min(fewest + most), max(fewest + most)
    if step.friction < low:
        cause = "the asperities that the earlier points need" if i else "a single asperity"
        reason = f"{cause} already {'have' if i else 'has'} more friction ({left} asperities are left)"
        nearest = low
    elif step.friction > high:
        needed = min(step.needed(radius) for radius in tools)
        more = "more than can be made" if math.isinf(needed) else f"at least {needed:.0f} more asperities"
        reason = f"{more} are needed, {left} are left"
        # slightly below the bound, so that rounding does not require another asperity
        nearest = max(high * (1.0 - 1e-9), low)
    else:
        reason = "no whole number of asperities of these radii has this load and friction"
        nearest = min(fewest + most, key=lambda friction: abs(friction - step.friction))
    parts = (
        f"operating point {i + 1} (load ",
        ("loads", target.rescaled_load[i]),
        ", friction ",
        ("frictions", target.rescaled_friction[i]),
        f") is not met: {reason}. After levels for the earlier points, the friction at this load can be "
        "from ",
        ("frictions", low, high),
    )
    return Infeasible(
        Message(parts, target.wording),
        replace(
            target,
            rescaled_load=target.rescaled_load[: i + 1],
            rescaled_friction=np.append(target.rescaled_friction[:i], nearest),
        ),
    )


def _too_low(i: int, level: Level, limits: Limits) -> Infeasible | None:
    """Return the error for a level that needs summits below the limits or contact of the base, or None."""
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
