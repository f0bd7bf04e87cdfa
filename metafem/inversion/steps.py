"""Quantisation to height steps: heights are rounded, then changed by steps, added or removed.

The change of the law by each single change is that of independent asperities, and the changes of two
asperities are added. The best ones so predicted are evaluated under the model, as long as one lowers the
misfit. Random changes of the best asperities follow. All surfaces have the same sites, with absent asperities
far below, because the influence between sites can take a minute.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem.inversion.problem import NONE, Asperities, Candidate, Parameter, Problem, misfit
from metafem.inversion.search import Residual, changed
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

# Misfit at which a search over steps ends, a little above that without steps, and number of random changes
# that are tried above it.
STEP_GOAL, RANDOM = 1.5e-3, 20

# If the misfit is the largest difference, the sum of this power of the differences is minimised. For a
# hundred differences, the corresponding root of the sum is at most 1.8 times the largest difference.
LARGEST_POWER = 8

# Number of vacant sites to which asperities may be added.
SPARE = 3

# Largest number of levels to which an asperity is added, evenly spaced, and depth of an absent asperity below
# the lowest level over the span of the heights.
ADDED_TO, ABSENT = 60, 100.0


def on_steps(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate with heights on the steps of the limits; prescribed heights stay as they are."""
    if candidate.stepped and not problem.model.couples:
        return candidate
    at = _Steps(problem, candidate).best(rng)
    free = np.setdiff1d(at.sites, list(problem.held))
    levels, counts = np.unique(at.height[free], return_counts=True)
    steps: dict[str, Parameter] = {"step_levels": levels, "step_counts": counts.astype(np.int64)}
    before = misfit(problem, candidate.asperities, candidate.law)
    return replace(candidate.with_asperities(at), stepped=True, unrounded=before, found=steps)


@dataclass(frozen=True, eq=False)
class _Steps:
    """Search over heights on the levels of a problem for the law of a candidate."""

    problem: Problem
    candidate: Candidate

    @cached_property
    def levels(self) -> FloatArray:
        """Allowed heights, increasing, (l,) [mm]."""
        levels = self.problem.limits.levels
        return np.asarray(levels[levels >= self.problem.foot])

    @cached_property
    def within(self) -> Problem:
        """Problem whose open sites are those of all surfaces: the candidate's and a few vacant ones."""
        vacant = np.setdiff1d(self.problem.open, self.candidate.asperities.sites)[SPARE:]
        pinned = {**self.problem.pinned, **dict.fromkeys(vacant.tolist(), None)}
        return replace(self.problem, pinned=pinned)

    @cached_property
    def absent(self) -> float:
        """Height of an absent asperity [mm]."""
        return float(self.levels[0] - ABSENT * self.problem.limits.span)

    def best(self, rng: np.random.Generator) -> Asperities:
        """Return the asperities on steps with the smallest sum that was found."""
        tried = [self._rounded(self.candidate.asperities, shift) for shift in SHIFTS]
        at = min(tried, key=lambda each: self._total(self._residual(each)))
        if len(at.sites) > MOST_STEPPED:
            return at
        at, residual = self._descended(at)
        for _ in each("random change", range(0 if self.problem.draft else RANDOM), at_most=True):
            if self._total(residual) <= self._total(np.full_like(residual, STEP_GOAL)):
                break
            found = self._descended(self._rounded(changed(at, self.within, rng)))
            if self._total(found[1]) < self._total(residual):
                at, residual = found
        return at

    def _rounded(self, at: Asperities, shift: float = 0.0) -> Asperities:
        """Return the asperities on the nearest levels, after a shift by a fraction of a step."""
        levels, step = self.levels, self.problem.limits.height_step or 1.0
        index = np.clip(np.rint((at.height - levels[0]) / step + shift), 0, len(levels) - 1)
        height = levels[index.astype(np.int64)]
        for site, given in self.problem.held.items():
            height[site] = given
        return Asperities(height, at.tool)

    def _residual(self, at: Asperities) -> FloatArray:
        """Return the residual of asperities, (k,) [-]."""
        whole = self._whole(at)
        found: FloatArray = self._residuals(self.problem.surface(whole), whole.height[whole.sites][None])[0]
        return found

    def _whole(self, at: Asperities) -> Asperities:
        """Return asperities on all open sites; the absent ones have the tool of the lowest."""
        on, tool = at.sites, at.tool.copy()
        tool[np.setdiff1d(self.within.open, on)] = at.tool[on[at.height[on].argmin()]]
        return Asperities(np.where(at.exists, at.height, self.absent), tool)

    def _residuals(self, surface: Surface, height: FloatArray, independent: bool = False) -> FloatArray:
        """Return the residuals (m, k) [-] for heights (m, n); inf where the model does not converge."""
        model = self.problem.uncoupled if independent else self.problem.model.gradient_model
        law = self.candidate.law
        areas = model.areas(surface, law.load, height)
        good = np.isfinite(areas).all(axis=1)
        rows = [np.sqrt(law.weight) * (areas[good] / law.laws(areas[good]) - 1.0)]
        rows.append(Residual(self.problem, law, self.candidate.branches).slope_errors(areas[good]))
        found = np.full((len(areas), sum(each.shape[1] for each in rows)), np.inf)
        found[good] = np.hstack(rows)
        return found

    def _total(self, residual: FloatArray) -> FloatArray:
        """Return the norm of residuals over the loads (last axis), in single precision.

        The last digits depend on the processor, and would decide between equal changes.
        """
        power = LARGEST_POWER // 2 if self.candidate.law.pointwise else 1
        return np.asarray(((residual * residual) ** power).sum(axis=-1) ** (1.0 / power), dtype=np.float32)

    def _descended(self, at: Asperities) -> tuple[Asperities, FloatArray]:
        """Return asperities after changes that lower the sum, and their residual (k,)."""
        residual = self._residual(at)
        for _ in each("change of steps", range(1 if self.problem.draft else REPETITIONS), at_most=True):
            whole = self._whole(at)
            sites, surface = whole.sites, self.problem.surface(whole)
            held = np.isin(sites, list(self.problem.held))
            trials = self._predicted(surface, whole.height[sites], held, residual)
            residuals = self._residuals(surface, trials)
            if not len(trials) or not self._total(residuals).min() < self._total(residual):
                break
            row = int(self._total(residuals).argmin())
            at, residual = whole.with_heights(trials[row]), residuals[row]
            at.tool[at.height <= self.absent] = NONE
        return at, residual

    def _predicted(
        self, surface: Surface, height: FloatArray, held: NDArray[np.bool_], residual: FloatArray
    ) -> FloatArray:
        """Return heights (m, n) after changes of one or two asperities, of the least predicted sums."""
        which, to = self._changes(height, held)
        singles = np.tile(height, (len(which) + 1, 1))
        singles[np.arange(len(which)), which] = to
        found = self._residuals(surface, singles, independent=True)
        change = residual + (found[:-1] - found[-1])
        single = self._total(change)
        # equal changes have equal predicted sums, and two of them are enough to form a pair
        order = np.argsort(single, kind="stable")
        third = np.append([False, False], single[order][2:] == single[order][:-2])[: len(order)]
        tried = order[~third][:PAIRED]
        double = self._total(change[tried][:, None] + change[tried][None] - residual)
        double[np.diag_indices(len(tried))] = single[tried]
        same = (which[tried][:, None] == which[tried]) & ~np.eye(len(tried), dtype=bool)
        double[same | np.tri(len(tried), k=-1, dtype=bool)] = np.inf
        least, first = np.unique(double, return_index=True)
        pairs = np.array(np.divmod(first[np.isfinite(least)][:EVALUATED], max(1, len(tried))))
        trials = np.tile(height, (pairs.shape[1], 1))
        for one in tried[pairs]:
            trials[np.arange(len(trials)), which[one]] = to[one]
        return trials

    def _changes(self, height: FloatArray, held: NDArray[np.bool_]) -> tuple[IntArray, FloatArray]:
        """Return the asperities of all single changes, and their new heights [mm]."""
        levels, exists, step = self.levels, height > self.absent, self.problem.limits.height_step or 1.0
        on, off = np.flatnonzero(exists & ~held), np.flatnonzero(~exists)[:1]
        index = np.rint((height[on] - levels[0]) / step).astype(np.int64)
        up, down = index < len(levels) - 1, index > 0
        removed = on if len(on) > 1 else on[:0]
        some = levels[
            np.unique(np.linspace(0, len(levels) - 1, min(len(levels), ADDED_TO)).round().astype(int))
        ]
        which = np.concatenate([on[up], on[down], removed, np.repeat(off, len(some))])
        to = [levels[index[up] + 1], levels[index[down] - 1], np.full(len(removed), self.absent)]
        return which, np.concatenate([*to, np.tile(some, len(off))])
