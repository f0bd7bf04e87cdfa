"""Quantisation to height steps: heights are rounded and then changed by single steps to lower the misfit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.assessment import model_misfit
from metafem.inversion.candidate import Candidate, Parameter
from metafem.inversion.problem import Problem
from metafem.inversion.search.target_law import TargetLaw
from metafem.progress import each
from metafem.surface import Surface

# Before rounding, all heights are shifted by one of these fractions of a step, which does not change a law.
SHIFTS = (0.0, 0.25, -0.25, 0.5, -0.5)

# Changes of two heights combine this number of changes of one height, those with the smallest predicted sums.
PAIRED_STEPS = 64

# Changes are tried only up to this number of asperities: with more, rounding errors average out.
MOST_STEPPED = 512

# If the misfit is the largest difference, the sum of this power of the differences is minimised. For a
# hundred differences, the corresponding root of the sum is at most 1.8 times the largest difference. The
# exponent must be a power of two.
LARGEST_POWER = 8

# If the misfit is the largest difference, changes are first compared at this number of loads, those with the
# largest differences. The second number of changes is then evaluated together at all loads; it is even, for
# two threads.
LARGEST_LOADS, STEPS_AT_ONCE = 10, 4


def rounded_to_steps(problem: Problem, candidate: Candidate) -> Candidate:
    """Return the candidate with heights on the steps of the limits, if the limits have a height step.

    All heights except prescribed heights are rounded to the nearest level. Then one or two heights at a time
    are changed by one step, as long as this lowers the misfit under the model, or under its `gradient_model`
    if it has no sensitivities. With many asperities the heights are only rounded.
    """
    model, limits = problem.model, problem.limits
    if limits.height_step is None or (candidate.stepped and not model.couples):
        return candidate
    surface, held = candidate.surface(problem.template), candidate.held_rows
    search = _StepSearch(problem, candidate, surface)
    index, size = search.rounded(candidate.height)
    if len(index) <= MOST_STEPPED:
        index = search.moved(index, size)
    used, counts = np.unique(np.delete(index, held), return_counts=True)
    levels = limits.levels
    steps: dict[str, Parameter] = {"step_levels": levels[used], "step_counts": counts.astype(np.int64)}
    result, before = candidate.with_heights(search.heights(index)), model_misfit(problem, candidate)
    return replace(result, parameters={**result.parameters, **steps}, unrounded=before)


@dataclass(frozen=True, eq=False)
class _StepSearch:
    """A search over level indices (n,) of the heights that lowers the sum of a power of the residual."""

    problem: Problem
    candidate: Candidate
    surface: Surface

    @cached_property
    def levels(self) -> FloatArray:
        """Levels of the limits, (l,) [mm]."""
        return self.problem.limits.levels

    @property
    def law(self) -> TargetLaw:
        """Law to which the laws of the heights are compared."""
        return self.candidate.target_law

    def heights(self, index: IntArray) -> FloatArray:
        """Return the heights for level indices (..., n), with the prescribed heights, (..., n) [mm]."""
        heights, held = self.levels[index], self.candidate.held_rows
        heights[..., held] = self.candidate.height[held]
        return heights

    def residual(self, index: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return the residual (k,) [-] for level indices (n,), and its Jacobian (k, n) [1/mm]."""
        solver = self.problem.model.gradient_model
        found = solver.sensitivity(self.surface, self.law.load, self.heights(index))
        return self.law.residual(found.curve.area, found.gradient)

    def sums(self, trials: IntArray, law: TargetLaw) -> FloatArray:
        """Return the sums over the loads of a law for level indices (m, n), (m,); inf if not converged."""
        none = np.empty((len(law.load), 0))
        areas = self.problem.model.gradient_model.areas(self.surface, law.load, self.heights(trials))
        rows = [law.residual(row, none)[0] if np.isfinite(row).all() else row + np.inf for row in areas]
        return self.total(np.where(np.isnan(rows), np.inf, rows).T)

    def total(self, residual: FloatArray) -> FloatArray:
        """Return the sum of the power of the residual over the loads (first axis)."""
        raised = residual * residual
        power = LARGEST_POWER if self.law.pointwise else 2
        for _ in range(power.bit_length() - 2):  # ten times as fast as one power operation
            np.square(raised, out=raised)
        return np.asarray(raised.sum(axis=0))

    def best(self, trials: IntArray) -> tuple[IntArray, float]:
        """Return the trial with the smallest sum, (n,), and its sum."""
        sizes = self.sums(trials, self.law)
        return trials[int(sizes.argmin())], float(sizes.min())

    def below(self, trials: IntArray, size: float, residual: FloatArray) -> tuple[IntArray, float]:
        """Return the result of `best` with fewer evaluations, if its sum is below `size`.

        The sum over the few loads with the largest current residuals is a close lower bound of the total sum.
        Trials with the smallest lower bounds are evaluated first. A trial whose lower bound is not smaller
        than the smallest sum found is not evaluated.
        """
        sizes = np.full(len(trials), np.inf)
        largest = np.sort(np.argsort(-np.abs(residual))[:LARGEST_LOADS])
        bounds = self.sums(trials, self.law.part(largest))
        for some in np.array_split(np.argsort(bounds), -(-len(trials) // STEPS_AT_ONCE)):
            rows = some[bounds[some] < min(size, sizes.min())]
            if not rows.size:
                break
            sizes[rows] = self.sums(trials[rows], self.law)
        return trials[int(sizes.argmin())], float(sizes.min())

    def rounded(self, height: FloatArray) -> tuple[IntArray, float]:
        """Return the indices of the nearest levels for the best of several shifts, (n,), and their sum."""
        levels = self.levels
        step = float(levels[1] - levels[0]) if len(levels) > 1 else 1.0
        exact = (height - levels[0]) / step
        trials = [np.clip(np.rint(exact + shift), 0, len(levels) - 1).astype(np.int64) for shift in SHIFTS]
        return self.best(np.array(trials))

    def moved(self, index: IntArray, size: float) -> IntArray:
        """Return level indices (n,) after repeated changes of one or two heights by a step.

        In each repetition the best changes according to the Jacobian are evaluated.
        """
        excludes = self.law.pointwise and len(self.law.load) > 4 * LARGEST_LOADS
        for _ in each("change of steps", range(self.problem.effort.step_changes), at_most=True):
            residual, jacobian = self.residual(index)
            trials = self.trials(index, residual, jacobian)
            if not len(trials):
                break
            best, least = self.below(trials, size, residual) if excludes else self.best(trials)
            if not least < size:
                break
            index, size = best, least
        return index

    def trials(self, index: IntArray, residual: FloatArray, jacobian: FloatArray) -> IntArray:
        """Return level indices (m, n) after steps of one or two heights, for the smallest predicted sums."""
        levels = self.levels
        which = np.concatenate([np.arange(len(index))] * 2)
        by = np.repeat([1, -1], len(index))
        inside = (index[which] + by >= 0) & (index[which] + by < len(levels))
        inside &= ~np.isin(which, self.candidate.held_rows)
        which, by = which[inside], by[inside]
        if not which.size:
            return np.empty((0, len(index)), dtype=np.int64)
        change = jacobian[:, which] * (levels[index[which] + by] - levels[index[which]])
        single = self.total(residual[:, None] + change)
        order = np.argsort(single, kind="stable")
        # equal changes have equal predicted sums, and two of them are enough to form a pair
        third = np.append([False, False], single[order][2:] == single[order][:-2])
        tried = order[~third[: len(order)]][:PAIRED_STEPS]
        part = change[:, tried]
        double = self.total(residual[:, None, None] + part[:, :, None] + part[:, None, :])
        double[np.diag_indices(len(tried))] = single[tried]
        double[np.tril_indices(len(tried), -1)] = np.inf
        same = which[tried][:, None] == which[tried][None, :]
        double[same & ~np.eye(len(tried), dtype=bool)] = np.inf
        _, first = np.unique(double.ravel(), return_index=True)
        trials = []
        for flat in first[: self.problem.effort.evaluated_steps]:
            a, b = divmod(int(flat), len(tried))
            if not np.isfinite(double[a, b]):
                continue
            trial = index.copy()
            trial[which[tried[a]]] += by[tried[a]]
            if a != b:
                trial[which[tried[b]]] += by[tried[b]]
            trials.append(trial)
        return np.array(trials).reshape(-1, len(index))
