"""Quantisation to height steps: heights are rounded, then changed by single steps to lower the misfit."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.assessment import REACHED
from metafem.inversion.candidate import Candidate, Parameter
from metafem.inversion.limits import Limits
from metafem.inversion.problem import Problem
from metafem.inversion.search.levenberg_marquardt import Residual
from metafem.inversion.search.options import SearchOptions
from metafem.notes import Note, information


def rounded_to_steps(problem: Problem, candidate: Candidate) -> Candidate:
    """Return the candidate with heights on the steps of the limits.

    Each height is rounded to the nearest level. Then one or two heights at a time are changed by one step,
    as long as that lowers the misfit under the model (or under its `gradient_model`, where it has no
    sensitivities). With many asperities the heights are only rounded.
    """
    solver, law, levels = problem.model.gradient_model, candidate.target_law, problem.limits.levels
    surface = candidate.surface(problem.template)

    def residual(height: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = solver.sensitivity(surface, law.load, height)
        return law.residual(found.curve.area, found.gradient)

    options = problem.options
    search = _StepSearch(levels, residual, options.largest_power if law.pointwise else 2, options)
    index = search.rounded(candidate.height)
    if len(index) <= options.most_stepped:
        index = search.moved(index)
    used, counts = np.unique(index, return_counts=True)
    result = candidate.with_heights(levels[index])
    steps: dict[str, Parameter] = {"step_levels": levels[used], "step_counts": counts.astype(np.int64)}
    return replace(result, parameters={**result.parameters, **steps})


def step_note(limits: Limits, before: float, after: float) -> Note:
    """Return the note that states the misfits before and after the rounding."""
    aside = ": the search over steps found a better law than that over free heights" if after < before else ""
    if after > REACHED >= before:
        aside = f"; a smaller height_step brings it below {100.0 * REACHED:g} %"
    return information(
        f"heights are on steps of {1e3 * (limits.height_step or 0.0):.4g} um: the misfit is "
        f"{100.0 * after:.3g} %; before rounding to them it was {100.0 * before:.3g} %{aside}"
    )


@dataclass(frozen=True, eq=False)
class _StepSearch:
    """A search over the indices (n,) of levels; the sum of a power of the residual is lowered."""

    levels: FloatArray
    residual: Residual
    power: int
    options: SearchOptions

    def total(self, residual: FloatArray) -> FloatArray:
        """Return the sum over the loads (first axis)."""
        return np.asarray((residual**self.power).sum(axis=0))

    def size(self, index: IntArray) -> float:
        """Return the sum for heights on levels."""
        return float(self.total(self.residual(self.levels[index])[0]))

    def rounded(self, height: FloatArray) -> IntArray:
        """Return the nearest levels after the best of several shifts."""
        levels = self.levels
        step = float(levels[1] - levels[0]) if len(levels) > 1 else 1.0
        exact = (height - levels[0]) / step
        trials = [
            np.clip(np.rint(exact + shift), 0, len(levels) - 1).astype(np.int64)
            for shift in self.options.shifts
        ]
        return min(trials, key=self.size)

    def moved(self, index: IntArray) -> IntArray:
        """Change one or two heights by a step at a time; the best changes by the gradient are evaluated."""
        for _ in range(self.options.most_step_changes):
            residual, jacobian = self.residual(self.levels[index])
            trials = self.trials(index, residual, jacobian)
            sizes = list(map(self.size, trials))
            best = int(np.argmin(sizes)) if sizes else 0
            if not sizes or not sizes[best] < self.total(residual):
                break
            index = trials[best]
        return index

    def trials(self, index: IntArray, residual: FloatArray, jacobian: FloatArray) -> list[IntArray]:
        """Return the steps of one or two heights that lower the misfit most to first order."""
        levels, options = self.levels, self.options
        which = np.concatenate([np.arange(len(index))] * 2)
        by = np.repeat([1, -1], len(index))
        inside = (index[which] + by >= 0) & (index[which] + by < len(levels))
        which, by = which[inside], by[inside]
        if not which.size:
            return []
        change = jacobian[:, which] * (levels[index[which] + by] - levels[index[which]])
        single = self.total(residual[:, None] + change)
        order = np.argsort(single, kind="stable")
        # asperities of equal height have equal gradients, and two of each are enough for a pair
        third = np.append([False, False], single[order][2:] == single[order][:-2])
        kept = order[~third[: len(order)]][: options.paired_steps]
        part = change[:, kept]
        double = self.total(residual[:, None, None] + part[:, :, None] + part[:, None, :])
        double[np.diag_indices(len(kept))] = single[kept]
        double[np.tril_indices(len(kept), -1)] = np.inf
        same = which[kept][:, None] == which[kept][None, :]
        double[same & ~np.eye(len(kept), dtype=bool)] = np.inf
        _, first = np.unique(double.ravel(), return_index=True)
        trials = []
        for flat in first[: options.evaluated_steps]:
            a, b = divmod(int(flat), len(kept))
            if not np.isfinite(double[a, b]):
                continue
            trial = index.copy()
            trial[which[kept[a]]] += by[kept[a]]
            if a != b:
                trial[which[kept[b]]] += by[kept[b]]
            trials.append(trial)
        return trials
