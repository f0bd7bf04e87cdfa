"""Quantisation to height steps: heights are rounded, then changed by steps, added or removed.

The change of the law by each single change is that of independent asperities, and the changes of two
asperities are added. The best ones so predicted are evaluated under the model, as long as one lowers the
misfit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem.inversion.problem import NONE, Asperities, Candidate, Parameter, Problem, misfit
from metafem.inversion.search import Residual
from metafem.progress import each
from metafem.surface import Surface

# Before rounding, all heights are shifted by one of these fractions of a step, which does not change a law.
SHIFTS = (0.0, 0.25, -0.25, 0.5, -0.5)

# Number of changes of one asperity, those with the smallest predicted sums, that are combined to changes of
# two, and number of changes that are evaluated under the model at a time.
PAIRED, EVALUATED = 64, 24

# Changes are tried only up to this number of asperities: with more, rounding errors average out; and the
# largest number of repetitions.
MOST_STEPPED, REPETITIONS = 512, 60

# Misfit at which a search over steps ends, a little above that without steps; number of random changes of a
# few asperities that are tried above it, largest number of asperities, and probability that one is removed.
STEP_GOAL, KICKS, MOST_KICKED, REMOVED = 1.5e-3, 20, 3, 0.3

# If the misfit is the largest difference, the sum of this power of the differences is minimised. For a
# hundred differences, the corresponding root of the sum is at most 1.8 times the largest difference.
LARGEST_POWER = 8

# Number of spare asperities that may be added.
SPARE = 3

# Largest number of levels to which an asperity is added, evenly spaced, and depth of an absent asperity below
# the lowest level over the span of the heights.
ADDED_TO, ABSENT = 60, 100.0


def on_steps(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate with heights on the steps of the limits, if the limits have a height step.

    Prescribed heights stay as they are.
    """
    if problem.limits.height_step is None or (candidate.stepped and not problem.model.couples):
        return candidate
    search = _Steps(problem, candidate)
    at = search.asperities(search.best(rng))
    free = np.setdiff1d(at.sites, list(problem.held))
    levels, counts = np.unique(at.height[free], return_counts=True)
    steps: dict[str, Parameter] = {"step_levels": levels, "step_counts": counts.astype(np.int64)}
    before = misfit(problem, candidate.asperities, candidate.law)
    return replace(candidate.with_asperities(at), stepped=True, unrounded=before, found=steps)


@dataclass(frozen=True, eq=False)
class _Steps:
    """Search over the level indices of the asperities, and of spare ones; -1 is an absent one."""

    problem: Problem
    candidate: Candidate

    @cached_property
    def sites(self) -> IntArray:
        """Sites of the asperities and of the spare ones, increasing."""
        on = self.candidate.asperities.sites
        vacant = np.setdiff1d(self.problem.open, on)
        ignores = getattr(self.problem.model.gradient_model, "ignores_open", True)
        return np.sort(np.append(on, vacant[:SPARE])) if ignores else on

    @cached_property
    def whole(self) -> Asperities:
        """The asperities with the spare ones, which have the tool of the lowest."""
        at = self.candidate.asperities
        tool, on = at.tool.copy(), at.sites
        spare = np.setdiff1d(self.sites, on)
        tool[spare] = at.tool[on[at.height[on].argmin()]]
        return Asperities(np.where(at.exists, at.height, self.levels[-1]), tool)

    @cached_property
    def surface(self) -> Surface:
        """Surface of all asperities with the spare one."""
        return self.problem.surface(self.whole)

    @cached_property
    def held(self) -> NDArray[np.bool_]:
        """Whether each height is prescribed, (n,)."""
        return np.isin(self.sites, list(self.problem.held))

    @cached_property
    def levels(self) -> FloatArray:
        """Allowed heights, (l,), and last the height of an absent asperity [mm]."""
        limits = self.problem.limits
        levels = limits.levels[limits.levels >= self.problem.foot]
        return np.append(levels, levels[0] - ABSENT * limits.span)

    def heights(self, index: IntArray) -> FloatArray:
        """Return the heights for level indices (..., n), with the prescribed heights, (..., n) [mm]."""
        return np.where(self.held, self.whole.height[self.sites], self.levels[index])

    def asperities(self, index: IntArray) -> Asperities:
        """Return the asperities for level indices (n,)."""
        height, tool = self.whole.height.copy(), self.whole.tool.copy()
        height[self.sites] = self.heights(index)
        tool[self.sites[(index == NONE) & ~self.held]] = NONE
        return Asperities(height, tool)

    def residuals(self, index: IntArray, independent: bool = False) -> FloatArray:
        """Return the residuals (m, k) [-] for level indices (m, n); inf where the model does not converge."""
        model = self.problem.uncoupled if independent else self.problem.model.gradient_model
        law = self.candidate.law
        areas = model.areas(self.surface, law.load, self.heights(index))
        good = np.isfinite(areas).all(axis=1)
        rows = [np.sqrt(law.weight) * (areas[good] / law.laws(areas[good]) - 1.0)]
        rows.append(Residual(self.problem, law, self.candidate.branches).slope_errors(areas[good]))
        found = np.full((len(areas), sum(each.shape[1] for each in rows)), np.inf)
        found[good] = np.hstack(rows)
        return found

    def total(self, residual: FloatArray) -> FloatArray:
        """Return the sum of a power of residuals over the loads (last axis)."""
        squared = residual * residual
        power = LARGEST_POWER // 2 if self.candidate.law.pointwise else 1
        return np.asarray((squared**power).sum(axis=-1))

    def best(self, rng: np.random.Generator) -> IntArray:
        """Return the level indices (n,) with the smallest sum that was found."""
        levels, at = self.levels[:-1], self.candidate.asperities
        step = float(levels[1] - levels[0]) if len(levels) > 1 else 1.0
        exact = (self.whole.height[self.sites] - levels[0]) / step
        trials = np.array([np.clip(np.rint(exact + shift), 0, len(levels) - 1) for shift in SHIFTS])
        index, residual = self._least(np.where(at.exists[self.sites], trials, NONE).astype(np.int64))
        if len(self.sites) > MOST_STEPPED:
            return index
        index, residual = self._descended(index, residual)
        for _ in each("random change", range(0 if self.problem.draft else KICKS), at_most=True):
            if self.total(residual) <= self.total(np.full_like(residual, STEP_GOAL)):
                break
            kicked = self._kicked(index, rng)
            found = self._descended(kicked, self.residuals(kicked[None])[0])
            if self.total(found[1]) < self.total(residual):
                index, residual = found
        return index

    def _descended(self, index: IntArray, residual: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return level indices (n,) after changes that lower the sum, and their residual (k,)."""
        for _ in each("change of steps", range(1 if self.problem.draft else REPETITIONS), at_most=True):
            trials = self._predicted(index, residual)
            if not len(trials):
                break
            new, new_residual = self._least(trials)
            if not self.total(new_residual) < self.total(residual):
                break
            index, residual = new, new_residual
        return index, residual

    def _kicked(self, index: IntArray, rng: np.random.Generator) -> IntArray:
        """Return level indices (n,) of which a few asperities have others, near those of an asperity."""
        free = np.flatnonzero(~self.held)
        which = rng.choice(free, min(len(free), int(rng.integers(1, MOST_KICKED + 1))), replace=False)
        near = rng.choice(index[index != NONE], len(which)) + rng.integers(-2, 3, len(which))
        kicked = index.copy()
        kicked[which] = np.clip(near, 0, len(self.levels) - 2)
        gone = which[rng.random(len(which)) < REMOVED]
        if (kicked != NONE).sum() > len(gone):
            kicked[gone] = NONE
        return kicked

    def _least(self, trials: IntArray) -> tuple[IntArray, FloatArray]:
        """Return the trial with the smallest sum, (n,), and its residual (k,)."""
        residuals = self.residuals(trials)
        row = int(self.total(residuals).argmin())
        return trials[row], residuals[row]

    def _predicted(self, index: IntArray, residual: FloatArray) -> IntArray:
        """Return level indices (m, n) after changes of one or two asperities, of the least predicted sums."""
        which, to = self._changes(index)
        if not which.size:
            return np.empty((0, len(index)), dtype=np.int64)
        singles = np.tile(index, (len(which) + 1, 1))
        singles[np.arange(len(which)), which] = to
        found = self.residuals(singles, independent=True)
        change = residual + (found[:-1] - found[-1])
        single = self.total(change)
        # equal changes have equal predicted sums, and two of them are enough to form a pair
        order = np.argsort(single, kind="stable")
        third = np.append([False, False], single[order][2:] == single[order][:-2])[: len(order)]
        tried = order[~third][:PAIRED]
        double = self.total(change[tried][:, None] + change[tried][None] - residual)
        double[np.diag_indices(len(tried))] = single[tried]
        same = (which[tried][:, None] == which[tried]) & ~np.eye(len(tried), dtype=bool)
        double[same | np.tri(len(tried), k=-1, dtype=bool)] = np.inf
        _, first = np.unique(double, return_index=True)
        trials = []
        for flat in first[:EVALUATED].tolist():
            a, b = divmod(flat, len(tried))
            if np.isfinite(double[a, b]):
                trial = index.copy()
                trial[which[tried[[a, b]]]] = to[tried[[a, b]]]
                trials.append(trial)
        return np.array(trials, dtype=np.int64).reshape(-1, len(index))

    def _changes(self, index: IntArray) -> tuple[IntArray, IntArray]:
        """Return the asperities of all single changes, and their new level indices."""
        count, every = len(self.levels) - 1, np.arange(len(index))
        on = every[(index != NONE) & ~self.held]
        which, to = np.tile(on, 3), np.concatenate([index[on] + 1, index[on] - 1, np.full(len(on), NONE)])
        removed = np.arange(len(which)) >= 2 * len(on)
        inside = np.where(removed, len(on) > 1, (to >= 0) & (to < count))
        off = every[index == NONE][:1]
        some = np.unique(np.linspace(0, count - 1, min(count, ADDED_TO)).round().astype(np.int64))
        which = np.concatenate([which[inside], np.repeat(off, len(some))])
        return which, np.concatenate([to[inside], np.tile(some, len(off))])
