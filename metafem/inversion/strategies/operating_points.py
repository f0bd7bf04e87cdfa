"""Heights whose law passes through points, with one level and one adjustment asperity per point (eq. S1).

With one radius, the previous levels determine the level of each point. With several radii many
levels can meet a point, and they are tried in turn. For adhesive asperities, and where the limits exclude the
levels, groups with free heights are tried, see `groups`. If these fail and no bound excludes the points, a
search for heights without levels follows. With interaction, the misfit after the refinement under the model
then decides whether the points are refused.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from metafem.errors import Infeasible
from metafem.inversion.assessment import REACHED, model_misfit
from metafem.inversion.candidate import Candidate, Parameter
from metafem.inversion.feasibility import broken_bound
from metafem.inversion.strategies.free_heights import without_levels
from metafem.inversion.strategies.groups import GroupStep
from metafem.inversion.strategies.level import Level, Step, asperities
from metafem.inversion.targets.wording import Message
from metafem.models.model import has_paraboloids

if TYPE_CHECKING:
    from metafem.inversion.limits import Limits
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

# The same for groups, whose heights are free, so that no group touches the plane at the previous point.
GROUP_DROP = 1e-3

# Distance below the lowest height that counts as rounding, relative to the largest height.
ROUNDING = 1e-10

# Maximum number of levels that a search tries, about 0.2 ms each.
MOST_LEVELS = 5_000

# The same for groups with Hertz's law, about 0.2 ms each, and with other laws, up to 5 ms each.
MOST_GROUPS, MOST_OTHERS = 300, 30


def candidate(
    target: OperatingPoints, problem: Problem, rng: np.random.Generator, restarts: int | None = None
) -> Candidate:
    """Return heights whose independent law passes through all points, or raise Infeasible."""
    radii, paths, searches = problem.radii, list[tuple[Level, ...]](), list[_Search]()
    for drop, groups in _kinds(problem):
        singles = [_Search(target, (radius,), problem, drop, groups) for radius in radii.tried.tolist()]
        paths = [path for search in singles if (path := search.path(()))]
        searches.append(singles[-1])
        if not paths and not radii.single:
            searches[-1] = _Search(target, tuple(radii.tried.tolist()), problem, drop, groups)
            paths = [path for path in [searches[-1].path(())] if path]
        if paths or (not groups and not drop and not searches[-1].limited):
            break
    if paths:
        fewest = min(paths, key=lambda levels: sum(level.count for level in levels))
        return _with_levels(target, fewest, problem)
    # levels and bounds are those of independent asperities: under another model, bounds exclude points only
    # beyond the interaction margin
    margin = problem.interaction_margin()
    highest = (1.0 + margin) * problem.bounds.largest_load(problem.limits)
    broken = broken_bound(target.rescaled_load, target.rescaled_friction, problem.bounds, margin)
    searched = target.last_load <= highest and broken is None

    # the reason is that of levels, whose counts and heights the message states
    last = [each for each in searches if not each.groups][-1:] or searches

    def refusal() -> Infeasible:
        refused = last[-1].refused or Infeasible("no heights that meet the points were found")
        return Infeasible(refused.message, _nearest(last[-1]), by_search=searched)

    found = without_levels(target.curve(), problem, rng, margin) if searched else None
    if found is None:
        raise refusal()
    return replace(found, refusal=refusal) if problem.model.couples else found


def _kinds(problem: Problem) -> list[tuple[float, bool]]:
    """Return the drops of levels that are tried, and whether groups are tried in place of levels.

    Groups follow levels if the limits exclude the levels. Adhesive asperities have only groups.
    """
    drops = list(dict.fromkeys((0.0 if has_paraboloids(problem.model) else LEVEL_DROP, 0.0)))
    levels = [] if problem.contact.adhesive else [(drop, False) for drop in drops]
    return [*levels, (GROUP_DROP, True)]


def judged(target: OperatingPoints, problem: Problem, candidate: Candidate) -> Candidate:
    """Return the refined candidate; raise Infeasible if it misses the points and no levels meet them."""
    if candidate.refusal is not None and model_misfit(problem, candidate) > REACHED:
        raise candidate.refusal()
    return candidate


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
    if any(level.others > 1 for level in path):
        parameters["adjustment_counts"] = np.array(
            [level.others * (level.adjustment > 0.0) for level in path]
        )
    if not problem.radii.single:
        parameters["level_radii"] = np.array([level.radius for level in path])
        parameters["adjustment_radii"] = np.array([level.other for level in path])
    lowest = offset + float(tops[-1])
    return Candidate(offset + height, radius, parameters, target.curve(), lowest_level=lowest)


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
    """Depth-first search for levels that meet all points."""

    target: OperatingPoints
    tools: tuple[float, ...]
    problem: Problem
    drop: float  # distance of a level below the plane at the previous point, over the previous level's depth
    groups: bool = False
    reason: Callable[[], Infeasible | None] | None = None
    furthest: int = -1
    limited: bool = False
    tried: int = 0

    @property
    def refused(self) -> Infeasible | None:
        """Reason if a point is not met."""
        return None if self.reason is None else self.reason()

    @property
    def unmet(self) -> OperatingPoints | None:
        """Points up to the point that is not met, where the friction is the nearest attainable friction."""
        refused = self.refused
        return None if refused is None else refused.nearest

    @property
    def most(self) -> int:
        """Maximum number of levels or groups that are tried."""
        if not self.groups:
            return MOST_LEVELS
        return MOST_GROUPS if has_paraboloids(self.problem.model) else MOST_OTHERS

    def of(self, target: OperatingPoints) -> _Search:
        """Return the same search for another target."""
        return replace(self, target=target, reason=None, furthest=-1, limited=False, tried=0)

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
        given = self.problem.contact, done, level, *point
        step = Step(*given)
        if self.groups:
            step = GroupStep(*given, deepest=level - self.problem.limits.min_height)
        left = self.problem.count - sum(part.count for part in done)
        any_found = False
        for next_level in step.levels(self.tools, left):
            any_found = True
            self.tried += 1
            if self.tried > self.most:
                break
            too_low = partial(_too_low, i, next_level, self.problem.limits)
            if too_low() is not None:
                self.refuse(i, too_low, limited=True)
            elif path := self.path((*done, next_level)):
                return path
        if not any_found:
            self.refuse(i, partial(_unmet, self.target, i, step, self.tools, left), limited=False)
        return None

    def refuse(self, i: int, reason: Callable[[], Infeasible | None], limited: bool) -> None:
        """Store the first reason at the last point reached, and whether it is a manufacturing limit.

        The counts that a reason states can take longer than the search, so they are computed only if needed.
        """
        if i > self.furthest:
            self.furthest, self.reason, self.limited = i, cache(reason), limited


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
    lowest = min((height for height, _, number in level.kinds if number), default=math.inf)
    plane = level.height - level.depth
    short = limits.min_height - lowest
    if short > ROUNDING * limits.max_height:
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
