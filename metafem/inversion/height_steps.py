"""Quantisation to height steps: heights are rounded, then changed by single steps to lower the misfit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.assessment import REACHED, branch_fits, largest_misfit
from metafem.inversion.candidate import Blueprint, Parameter
from metafem.inversion.limits import Limits
from metafem.inversion.targets.wanted import Wanted
from metafem.models import Model
from metafem.notes import Note, information
from metafem.surface import Surface

# Fractions of a step by which all heights are shifted before rounding: a common shift does not change a law.
SHIFTS = (0.0, 0.25, -0.25, 0.5, -0.5)

# Number of single moves that are combined into pairs, and of moves that are evaluated under the model.
PAIRED, TRIED = 64, 24

# Most moves, and most asperities with which moves are tried: with more, the rounding errors average out.
MOST_MOVES, MOST_MOVED = 60, 512

# Where a law is judged by its largest difference, moves lower the sum of this power of the differences: its
# root is within 1.8 of the largest of a hundred.
LARGE_POWER = 8

# Law (k,) and its gradient (k, n) of heights (n,).
Evaluate = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


def rounded_to_steps(
    surface: Surface, model: Model, blueprint: Blueprint, limits: Limits
) -> tuple[Surface, dict[str, Parameter], tuple[Note, ...]]:
    """Return the surface with heights on the steps of the limits, the loss, and a note that states it.

    Each height is rounded to the nearest level. Then one or two heights at a time are changed by one step,
    as long as that lowers the misfit under the model (or under its `gradient_model`, where it has no
    sensitivities). With many asperities the heights are only rounded.
    """
    solver = model.gradient_model
    levels, wanted = limits.levels, blueprint.wanted

    def evaluate(height: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = solver.sensitivity(surface.replaced(height=height), wanted.load)
        return found.curve.area, found.gradient

    index = _rounded(surface.height, levels, evaluate, wanted)
    if surface.count <= MOST_MOVED:
        index = _moved(index, levels, evaluate, wanted)
    result = surface.replaced(height=levels[index])
    before, after = (
        largest_misfit(part, model, blueprint, branch_fits(part, model, blueprint))
        for part in (surface, result)
    )
    used, counts = np.unique(index, return_counts=True)
    parameters: dict[str, Parameter] = {
        "step_levels": levels[used],
        "step_counts": counts.astype(np.int64),
        "step_loss": after - before,
    }
    aside = ": the search over steps found a better law than that over free heights" if after < before else ""
    if after > REACHED >= before:
        aside = f"; a smaller height_step brings it below {100.0 * REACHED:g} %"
    note = (
        f"heights are on steps of {1e3 * (limits.height_step or 0.0):.4g} um: the misfit is "
        f"{100.0 * after:.3g} %; before rounding to them it was {100.0 * before:.3g} %{aside}"
    )
    return result, parameters, (information(note),)


def _size(index: IntArray, levels: FloatArray, evaluate: Evaluate, wanted: Wanted) -> float:
    residual, _ = wanted.residual(*evaluate(levels[index]))
    return float(_sum(residual, wanted))


def _sum(residual: FloatArray, wanted: Wanted) -> FloatArray:
    """Return the sum over the loads (first axis) that is lowered: of squares, or of a large power."""
    return np.asarray((residual ** (LARGE_POWER if wanted.pointwise else 2)).sum(axis=0))


def _rounded(height: FloatArray, levels: FloatArray, evaluate: Evaluate, wanted: Wanted) -> IntArray:
    """Return the nearest levels after the best of several shifts."""
    step = float(levels[1] - levels[0]) if len(levels) > 1 else 1.0
    place = (height - levels[0]) / step
    trials = [np.clip(np.rint(place + shift), 0, len(levels) - 1).astype(np.int64) for shift in SHIFTS]
    return min(trials, key=lambda index: _size(index, levels, evaluate, wanted))


def _moved(index: IntArray, levels: FloatArray, evaluate: Evaluate, wanted: Wanted) -> IntArray:
    """Change one or two heights by a step at a time; the best changes by the gradient are evaluated."""
    for _ in range(MOST_MOVES):
        residual, jacobian = wanted.residual(*evaluate(levels[index]))
        trials = _trials(index, levels, residual, jacobian, wanted)
        best = min(trials, key=lambda trial: _size(trial, levels, evaluate, wanted), default=index)
        if not _size(best, levels, evaluate, wanted) < _sum(residual, wanted):
            break
        index = best
    return index


def _trials(
    index: IntArray, levels: FloatArray, residual: FloatArray, jacobian: FloatArray, wanted: Wanted
) -> list[IntArray]:
    """Return the steps of one or two heights that lower the misfit most to first order."""
    which = np.concatenate([np.arange(len(index))] * 2)
    by = np.repeat([1, -1], len(index))
    inside = (index[which] + by >= 0) & (index[which] + by < len(levels))
    which, by = which[inside], by[inside]
    if not which.size:
        return []
    change = jacobian[:, which] * (levels[index[which] + by] - levels[index[which]])
    single = _sum(residual[:, None] + change, wanted)
    order = np.argsort(single, kind="stable")
    # asperities of equal height have equal gradients, and two of each are enough for a pair
    third = np.append([False, False], single[order][2:] == single[order][:-2])
    kept = order[~third[: len(order)]][:PAIRED]
    part = change[:, kept]
    double = _sum(residual[:, None, None] + part[:, :, None] + part[:, None, :], wanted)
    double[np.diag_indices(len(kept))] = single[kept]
    double[np.tril_indices(len(kept), -1)] = np.inf
    same = which[kept][:, None] == which[kept][None, :]
    double[same & ~np.eye(len(kept), dtype=bool)] = np.inf
    _, first = np.unique(double.ravel(), return_index=True)
    trials = []
    for flat in first[:TRIED]:
        a, b = divmod(int(flat), len(kept))
        if not np.isfinite(double[a, b]):
            continue
        trial = index.copy()
        trial[which[kept[a]]] += by[kept[a]]
        if a != b:
            trial[which[kept[b]]] += by[kept[b]]
        trials.append(trial)
    return trials
