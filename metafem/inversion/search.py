"""Search for the asperities whose law is nearest to a target: descents and random changes.

A descent is a Levenberg–Marquardt method on bounded heights; the tool of each asperity is fixed in it. The
step is ``-J' (J J' + c s I)^-1 r`` with the residual r, its Jacobian J, the damping c and the mean s of the
squared norms of the rows of J. If a step lowers the sum of squares, c is divided by DAMPING_FACTOR; otherwise
the step is discarded and c is multiplied by it. A height at a limit does not move if a step down the gradient
``J' r`` would move it beyond the limit (a projected gradient).

As a function of the heights, A0 has kinks where asperities come into contact, so that a descent can end at a
local minimum. Random changes of the best asperities follow, each with a descent and with changes of tools,
until the goal is met or until restarts agree.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg.lapack import dposv

from metafem._validate import FloatArray
from metafem.errors import InvalidInput, NotConverged
from metafem.inversion.problem import NONE, Asperities, Branch, Problem
from metafem.inversion.target_law import LateResidual, TargetLaw
from metafem.models.curve import Sensitivity
from metafem.models.independent import load_equation
from metafem.models.model import has_paraboloids
from metafem.progress import each

# Misfit at which a search ends: height errors of 1 um change A0 by more than this.
GOAL = 9e-4

# A search for a law that must be exact first ends at this misfit; a descent to rounding follows.
NEARLY = 1e-4

# If the misfit is below this multiple of the goal, random changes reach the goal faster than other initial
# guesses, and one search that does not reach it is enough.
NEAR = 1.6

# Smallest and largest damping c, and the factor of the step size rule.
LEAST_DAMPING, MOST_DAMPING, DAMPING_FACTOR = 1e-12, 1e4, 5.0

# Largest separation of the plane from the base over the largest height at which it counts as near: the search
# keeps the plane this far away at the last load of the target.
CLEAR = 1e-3

# A height within this fraction of the span from a limit counts as at the limit, because of rounding.
AT_LIMIT = 1e-9

# Heights of a descent are multiples of this fraction of the span, unless it must converge to rounding. On
# another processor, whose sums differ in the last digit, a descent then finds the same heights.
GRAIN = 2.0**-26

# Decimals by which misfits are compared: of equal asperities any may move, and sums differ in the last digit.
DIGITS = 12

# Random changes: fractions of the heights that move, probability that asperities are added, probability that
# otherwise one is removed, the largest number of either, and probability of a new height anywhere.
FRACTIONS = (0.2, 0.5, 1.0)
ADDING, REMOVING, MOST_ADDED, ANYWHERE, NEIGHBOURING = 0.5, 0.3, 5, 0.3, 0.5

# Number of consecutive random changes without a gain of this fraction, after which a search ends; with many
# asperities and loads, so many that all of them together evaluate this number of contacts.
PATIENCE, LEAST_PATIENCE, GAIN, CONTACTS = 40, 4, 0.05, 6_000_000

# The same for a draft; and contacts that take as long as an adhesive one, and as each neighbour of one.
PATIENCE_DRAFT, ADHESIVE, COUPLED = 2, 40.0, 0.15

# Restarts agree if this number of them end within this factor of the best, or below a misfit at which every
# law is met within 1 %; the largest number of restarts, and the number of random changes from the best
# asperities to a new start.
AGREEING, AGREE, MET, MOST_RESTARTS, FAR = 3, 1.1, 3e-3, 8, 5

# If a law counts by its largest difference, the part of it that counts as the misfit of a search: differences
# of one sign and size would be a third of the usual largest ones.
PEAK = 1.0 / 3.0

# Weight of the error of a slope, over that of all differences at loads: a slope is met twice as loosely.
SLOPES = 0.5

# Fraction of the way of the plane between two loads after which an added asperity is touched: its contact is
# small at the second load, since that of a flat cap grows fast.
LATE = 0.95

# Dampings of steps from tool to tool.
TOOL_DAMPINGS = (1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5)


@dataclass(frozen=True)
class Descent:
    """Options of descents and random changes."""

    damping: float  # c of the first step
    # a descent ends when a step lowers the sum of squares by less than this fraction: a descent along kinks
    # is slow, and a random change is faster
    least_gain: float
    steps: int  # largest number of steps
    sizes: tuple[float, ...]  # sizes of random changes, relative to the mean spacing of the heights


HERTZ = Descent(damping=1e-2, least_gain=0.05, steps=20, sizes=(0.3, 1.0, 3.0))

# Options for other contact laws. If a cap is flatter than a paraboloid, its area as a function of the
# indentation begins with an infinite slope; with adhesion the area jumps. New contacts then cause sharper
# kinks, and the gradient is not valid beyond a kink.
OTHERS = Descent(damping=1.0, least_gain=0.01, steps=40, sizes=(0.1, 0.3, 1.0))

# Largest number of steps of a descent that must converge to rounding.
EXACT_STEPS = 40


@dataclass(frozen=True, eq=False)
class Found:
    """Asperities and the misfit of their law [-], see `Residual.misfit`."""

    asperities: Asperities
    misfit: float


@dataclass(frozen=True, eq=False)
class Residual:
    """Differences of the law of asperities from a target law, and their Jacobian.

    The rows are the differences at the loads, those of the slopes of branches, and how far the plane is below
    its least height over the base.

    - `model`: that of surfaces; None for lists of independent asperities, whose sites have no effect.
    - `ratio` [-]: A0 of surfaces over that of independent asperities, by which the target was divided.
    - `own`: whether the areas are those of the model of the problem, with the gradients of `model`.
    """

    problem: Problem
    law: TargetLaw
    branches: tuple[Branch, ...] = ()
    model: Any = None
    ratio: FloatArray | float = 1.0
    own: bool = False

    @classmethod
    def under_model(
        cls, problem: Problem, law: TargetLaw, branches: tuple[Branch, ...], own: bool = False
    ) -> Residual:
        """Return the residual under the model that has the gradients; with `own`, under the model itself."""
        model = problem.model.gradient_model
        return cls(problem, law, branches, None if model == problem.uncoupled else model, own=own)

    def __call__(self, at: Asperities) -> LateResidual:
        """Return the rows (k,) [-], and the function that returns their Jacobian (k, n) [1/mm]."""
        problem, law, some = self.problem, self.law, at.sites
        height, summits = at.height[some], problem.tools.summits[at.tool[some]]
        try:
            found = self.sensitivity(at)
            area = problem.model.curve(problem.surface(at), law.load).area if self.own else found.curve.area
        except InvalidInput:  # heights beyond the range of the contact law
            count = len(law.load) + len(self._slopes) + 1
            return np.full(count, np.inf), lambda: np.zeros((count, len(some)))
        r, jacobian = law.residual(area, lambda: found.gradient)
        top = problem.limits.top
        missing = CLEAR - (float(height.max()) - float(found.curve.approach[-1])) / top
        weight = np.sqrt(len(r)) if missing > 0.0 else 0.0

        def whole() -> FloatArray:
            # at a fixed load the separation follows the heights, weighted by the stiffnesses of the contacts
            stiffness = np.zeros(len(height))
            if weight:
                stiffness = _rates(problem, found.indentation[-1:], summits)[1][0]
                stiffness = stiffness / stiffness.sum()
            return np.vstack([jacobian(), self._slopes @ found.gradient, -weight / top * stiffness])

        return np.concatenate([r, self.slope_errors(area), [weight * missing]]), whole

    def sensitivity(self, at: Asperities) -> Sensitivity:
        """Return the law of asperities at the loads of the target."""
        height = at.height[at.sites]
        if self.model is None:
            summits = self.problem.tools.summits[at.tool[at.sites]]
            return self.problem.independent.sensitivity_of(height, summits, self.law.load)
        found: Sensitivity = self.model.sensitivity(self._surface(at.tool.tobytes()), self.law.load, height)
        return found

    def _surface(self, which: bytes) -> Any:
        """Return the surface of asperities made by tools, at any heights."""
        if which not in self._surfaces:
            tool = np.frombuffer(which, dtype=np.int64)
            self._surfaces[which] = self.problem.surface(
                Asperities(np.where(tool == NONE, 0.0, self.problem.limits.top), tool)
            )
        return self._surfaces[which]

    @cached_property
    def _surfaces(self) -> dict[bytes, Any]:
        return {}

    @cached_property
    def _slopes(self) -> FloatArray:
        """Factors (b, k) of areas that give the weighted slopes of lines fitted to the branches."""
        load, size = self.law.load, SLOPES * np.sqrt(len(self.law.load))
        rows = []
        for branch in () if self.law.pointwise else self.branches:
            even = branch.load
            line = (even - even.mean()) / ((even - even.mean()) ** 2).sum() / branch.slope
            rows.append(size * np.array([line @ np.interp(even, load, one) for one in np.eye(len(load))]))
        return np.reshape(rows, (-1, len(load))) * self.ratio

    def slope_errors(self, area: FloatArray) -> FloatArray:
        """Return the weighted relative errors of slopes (..., b) of area curves (..., k)."""
        return np.asarray(area @ self._slopes.T - SLOPES * np.sqrt(len(self.law.load)))

    def misfit(self, r: FloatArray) -> float:
        """Return the root mean square of the rows, or the part PEAK of the largest."""
        if self.law.pointwise:
            return PEAK * float(np.abs(r).max())
        return float(np.sqrt((r @ r) / len(self.law.load)))

    def patience(self, asperities: int) -> int:
        """Return the number of random changes without a gain after which a search ends."""
        if self.problem.draft:
            return PATIENCE_DRAFT
        coupled = COUPLED * asperities * (self.model is not None)
        each = (ADHESIVE if self.problem.tools.law.adhesive else 1.0) + coupled
        contacts = HERTZ.steps * asperities * (len(self.law.load) + 1) * each
        return min(PATIENCE, max(LEAST_PATIENCE, int(CONTACTS / contacts)))


def descend(
    residual: Residual, start: Asperities, goal: float, exact: bool = False, most: int = EXACT_STEPS
) -> Found:
    """Return the minimum of a descent from `start`, which ends at the goal or when no step lowers the misfit.

    The descent also ends at small gains; an exact one continues, and converges to rounding near a solution.
    most: largest number of steps, if it is below the usual one.
    """
    problem = residual.problem
    options = HERTZ if has_paraboloids(problem.model) else OTHERS
    low, high = problem.foot, problem.limits.top
    near, some = AT_LIMIT * problem.limits.span, start.sites
    grain = GRAIN * problem.limits.span
    held = np.isin(some, list(problem.held))
    given, damping = start.height[some], options.damping

    def allowed(height: FloatArray) -> FloatArray:
        rounded = height if exact else grain * np.rint(height / grain)
        return np.where(held, given, np.clip(rounded, low, high))

    height = given if exact else allowed(given)
    at = start.with_heights(height)
    r, jacobian = residual(at)
    squares, known = float(r @ r), None
    for _ in each("step", range(min(EXACT_STEPS if exact else options.steps, most)), at_most=True):
        if residual.misfit(r) <= goal or damping > MOST_DAMPING or not np.isfinite(squares):
            break
        if known is None:
            known = jacobian()
            slope = r @ known
            stay = held | ((height <= low + near) & (slope > 0.0)) | ((height >= high - near) & (slope < 0.0))
            known[:, stay] = 0.0
        step = _step(r, known, damping)
        if step is None:
            break
        trial = allowed(height + step)
        moved = at.with_heights(trial)
        new_r, new_jacobian = residual(moved)
        new = float(new_r @ new_r)
        if new < squares:
            stalled = squares - new < options.least_gain * squares and not exact
            height, at, r, jacobian, known, squares = trial, moved, new_r, new_jacobian, None, new
            damping = max(damping / DAMPING_FACTOR, LEAST_DAMPING)
            if stalled:
                break
        else:
            damping *= DAMPING_FACTOR
    return Found(at, residual.misfit(r))


def _step(r: FloatArray, jacobian: FloatArray, damping: float) -> FloatArray | None:
    """Return the damped step (n,) [mm], or None if no height changes the residual."""
    wide = len(r) <= jacobian.shape[1]  # the smaller of the two systems is solved
    product = jacobian @ jacobian.T if wide else jacobian.T @ jacobian
    size = float(np.trace(product)) / len(r)
    if not size > 0.0:  # also where a gradient is not finite
        return None
    product[np.diag_indices(len(product))] += damping * size
    right = r if wide else jacobian.T @ r
    _, found, failed = dposv(product, right)
    if failed:  # rounding makes the matrix indefinite
        found = np.linalg.solve(product, right)
    return np.asarray(-jacobian.T @ found if wide else -found)


def search(
    residual: Residual,
    starts: Iterable[Asperities],
    goal: float,
    rng: np.random.Generator,
    agreeing: int = AGREEING,
) -> Found:
    """Return the best asperities of descents from initial guesses and of random changes.

    The search ends at the goal, or when so many restarts agree; a single one has half the random changes.
    """
    found = descended(residual, starts, goal)
    best, ends = found[0], list[float]()
    patience = residual.patience(len(best.asperities.sites)) // (1 if agreeing > 1 else 2)
    problem = residual.problem
    # heights of one tool that are near an exact law usually reach it
    met = NEAR * goal if problem.target.exact and len(problem.tools) > 1 else MET
    for restart in range(MOST_RESTARTS):
        alike, enough = max(met, AGREE * best.misfit), 1 if best.misfit <= NEAR * goal else agreeing
        if best.misfit <= goal or sum(end <= alike for end in ends) >= enough:
            break
        begun = found[restart] if restart < len(found) else _far(residual, best, goal, rng)
        ends.append((one := _changed(residual, begun, goal, rng, patience)).misfit)
        best = min(best, one, key=misfit_of)
    return best


def descended(residual: Residual, starts: Iterable[Asperities], goal: float) -> list[Found]:
    """Return the results of descents, best first; the last one is that which comes near the goal."""
    found = list[Found]()
    for start in starts:
        found.append(descend(residual, start, goal))
        if found[-1].misfit <= NEAR * goal:
            break
    return sorted(found, key=misfit_of)


def misfit_of(found: Found) -> float:
    """Return the misfit without the digits that depend on the processor, by which results are compared."""
    return round(found.misfit, DIGITS)


def _far(residual: Residual, best: Found, goal: float, rng: np.random.Generator) -> Found:
    """Return the result of a descent from asperities far from the best ones."""
    at = best.asperities
    for _ in range(FAR):
        at = changed(at, residual.problem, rng)
    return descend(residual, at, goal)


def _changed(residual: Residual, best: Found, goal: float, rng: np.random.Generator, patience: int) -> Found:
    """Return the best asperities of random changes of the best ones so far."""
    failed = 0
    for _ in each("random change", range(100 * patience), at_most=True):
        if best.misfit <= goal or failed >= patience:
            break
        last = failed == patience - 1 > 0 and np.isfinite(best.misfit)
        start = _with_one_more(residual, best.asperities) if last else None
        start = start or changed(best.asperities, residual.problem, rng)
        one = with_tools(residual, descend(residual, start, goal), goal)
        failed = 0 if one.misfit < (1.0 - GAIN) * best.misfit else failed + 1
        best = min(best, one, key=misfit_of)
    return best


def changed(at: Asperities, problem: Problem, rng: np.random.Generator) -> Asperities:
    """Return asperities after a random change: some move, are added or removed, or change their tool."""
    sizes = (HERTZ if has_paraboloids(problem.model) else OTHERS).sizes
    height, tool, on = at.height.copy(), at.tool.copy(), at.sites
    free = np.setdiff1d(on, list(problem.held)) if problem.held else on
    if not free.size:
        return at
    low, high = problem.foot, problem.limits.top
    spacing = (float(np.ptp(height[on])) or problem.limits.span) / len(on) * rng.choice(sizes)
    moves = rng.random(len(free)) < rng.choice(FRACTIONS)
    height[free] += spacing * rng.standard_normal(len(free)) * moves
    if rng.random() < ANYWHERE:
        height[rng.choice(free)] = rng.uniform(height[on].min(), height[on].max())
    vacant = np.setdiff1d(problem.open, on)
    if vacant.size and rng.random() < ADDING:
        new = rng.choice(vacant, rng.integers(1, min(MOST_ADDED, vacant.size) + 1), replace=False)
        source = rng.choice(on, len(new))
        height[new] = height[source] + spacing * rng.standard_normal(len(new))
        tool[new] = tool[source]
    elif len(free) > 1 and len(on) > 2 and rng.random() < REMOVING:
        tool[rng.choice(free)] = NONE
    if len(problem.tools) > 1:
        anew = free[(rng.random(len(free)) < rng.choice((0.0, 0.1, 0.3))) & (tool[free] != NONE)]
        if rng.random() < NEIGHBOURING:
            tool[anew] = np.clip(tool[anew] + rng.integers(-3, 4, len(anew)), 0, len(problem.tools) - 1)
        else:
            tool[anew] = rng.integers(len(problem.tools), size=len(anew))
    height = np.clip(height, low, high)
    for site, given in problem.held.items():
        height[site] = given
    return Asperities(height, tool)


def _with_one_more(residual: Residual, at: Asperities) -> Asperities | None:
    """Return the asperities and one that touches first below the load at which most friction is missing.

    The result is None if no site is vacant or the model has no solution.
    """
    vacant = np.setdiff1d(residual.problem.open, at.sites)
    curve = residual.sensitivity(at).curve if vacant.size else None
    if curve is None or not curve.converged:
        return None
    height, tool = at.height.copy(), at.tool.copy()
    least = np.round(residual.law.difference(curve.area), DIGITS).argmin()
    before = curve.approach[least - 1] if least else 0.0
    depth = before + LATE * (curve.approach[least] - before)
    lowest = at.sites[height[at.sites].argmin()]
    height[vacant[0]] = max(height[at.sites].max() - depth, residual.problem.foot)
    tool[vacant[0]] = tool[lowest]
    return Asperities(height, tool)


def with_tools(residual: Residual, found: Found, goal: float) -> Found:
    """Return asperities after changes of their tools, each with a descent, until no change lowers the misfit.

    Steps in the indices of the tools reduce the residual that the heights cannot reduce. They are damped and
    rounded, so that fewer tools change with more damping; in one of them a single tool changes.
    """
    best, last = found, len(residual.problem.tools) - 1
    while last and best.misfit > goal:
        at, before = best.asperities, best.misfit
        which, (r, rates) = at.tool[at.sites], _rates_by_tools(residual, at)
        if not len(r):
            break
        # the change of one tool with the least predicted residual
        single = ((r[:, None] + np.hstack([rates, -rates])) ** 2).sum(axis=0)
        single[np.append(which == last, which == 0)] = np.inf
        first = np.round(single, 2 * DIGITS).argmin()
        up, down = np.reshape(np.arange(single.size) == first, (2, -1)).astype(float)
        steps = [up - down, *(_step(r, rates, damping) for damping in TOOL_DAMPINGS)]
        trials = dict[bytes, Asperities]()
        for step in steps:
            tool = at.tool.copy()
            tool[at.sites] = np.clip(which + np.rint(0.0 if step is None else step), 0, last)
            if (tool != at.tool).any():
                trials[tool.tobytes()] = Asperities(at.height, tool)
        best = min([best, *(descend(residual, trial, goal) for trial in trials.values())], key=misfit_of)
        if best.misfit >= (1.0 - GAIN) * before:
            break
    return best


def _rates_by_tools(residual: Residual, at: Asperities) -> tuple[FloatArray, FloatArray]:
    """Return the residual (q,) that no heights reduce, and its differences from tool to tool (q, n).

    To first order, another tool changes A0 at a fixed load by the change of its own area, less dA0/dP times
    that of its own load, where interaction is left out. Both are empty beyond the range of a contact law, and
    where the model has no solution.
    """
    problem, law = residual.problem, residual.law
    summits, which = problem.tools.summits, at.tool[at.sites]
    up, down = np.minimum(which + 1, len(summits) - 1), np.maximum(which - 1, 0)
    try:
        found = residual.sensitivity(at)
        found.curve.checked()
        own, more, less = (_rates(problem, found.indentation, summits[each]) for each in (which, up, down))
    except (InvalidInput, NotConverged):
        return np.empty(0), np.empty((0, len(which)))
    slope = own[3].sum(axis=1) / own[1].sum(axis=1)
    change = (more[2] - less[2] - slope[:, None] * (more[0] - less[0])) / (up - down)
    r, jacobian = law.residual(found.curve.area, lambda: found.gradient)
    scale = np.sqrt(law.weight) / law.law(found.curve.area)
    moving = (found.gradient != 0.0).any(axis=0)
    q, _ = np.linalg.qr(jacobian()[:, moving], mode="complete")
    # a basis of what the heights cannot change; of everything, if a descent ended where they could change all
    rest = q[:, moving.sum() if moving.sum() < len(q) else 0 :].T
    return np.asarray(rest @ r), np.asarray(rest @ (scale[:, None] * change))


def _rates(problem: Problem, depth: FloatArray, summits: Any) -> tuple[FloatArray, ...]:
    """Return loads [mm^2], dP/dd [mm], areas [mm^2] and dA/dd [mm] of contacts (k, n); 0 if open."""
    law = problem.tools.law
    if not law.adhesive:
        return load_equation(law).rates(depth, summits)
    size, closed = np.broadcast_to(summits, depth.shape), depth > 0.0
    at = law.contacts(depth, size)
    growth = law.area_slope(at.contact_radius, size)
    return tuple(np.where(closed, part, 0.0) for part in (at.load, at.stiffness, at.area, growth))
