"""Heights whose law under any model is nearest to what is wanted: Levenberg and Marquardt, and restarts.

A0(P) has kinks in the heights where asperities enter the contact, so a descent can end short of the
target; random changes of the best heights then start the next one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion.wanted import Wanted

# Law (k,) [mm^2] and its gradient by the heights (k, n) [mm] at given heights (n,).
Evaluate = Callable[[FloatArray], tuple[FloatArray, FloatArray]]

# Damping, relative to the mean square of the Jacobian: start, and bounds between which it may move.
START_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-2, 1e-12, 1e4
DAMPING_STEP = 5.0

# A descent stops when a step wins less than this share of the sum of squares: what it would still win
# slowly, along kinks, a random change wins at once (measured: a quarter of the time of 1e-4).
GAIN = 0.05

# Steps of one descent, and of one that must converge to rounding.
MAX_STEPS, PATIENT_STEPS = 20, 40


@dataclass(frozen=True)
class Refined:
    """Heights (n,) [mm] and the weighted rms of the law's relative differences."""

    height: FloatArray
    misfit: float


def descend(
    evaluate: Evaluate, height: FloatArray, wanted: Wanted, span: float, goal: float, patient: bool = False
) -> Refined:
    """Lower the misfit from given heights until it is within the goal or no step wins.

    No height falls further than `span` below the tallest. A patient descent ignores small gains: from
    near a solution it converges to rounding.
    """
    area, gradient = evaluate(height)
    residual, jacobian = wanted.residual(area, gradient)
    squares, damping = float(residual @ residual), START_DAMPING
    count = len(residual)
    for _ in range(PATIENT_STEPS if patient else MAX_STEPS):
        if np.sqrt(squares / count) <= goal or damping > MOST_DAMPING:
            break
        product = jacobian @ jacobian.T
        size = float(np.trace(product)) / count
        if size == 0.0:
            break
        system = product + damping * size * np.eye(count)
        step = -jacobian.T @ np.linalg.solve(system, residual)
        trial = height + step
        trial = np.maximum(trial, trial.max() - span)
        area, gradient = evaluate(trial)
        new_residual, new_jacobian = wanted.residual(area, gradient)
        new = float(new_residual @ new_residual)
        if new < squares:
            stalled = squares - new < GAIN * squares and not patient
            height, residual, jacobian, squares = trial, new_residual, new_jacobian, new
            damping = max(damping / DAMPING_STEP, LEAST_DAMPING)
            if stalled:
                break
        else:
            damping *= DAMPING_STEP
    return Refined(height, float(np.sqrt(squares / count)))


def search(
    evaluate: Evaluate,
    starts: list[FloatArray],
    wanted: Wanted,
    span: float,
    most: int,
    goal: float,
    restarts: int,
    rng: np.random.Generator,
) -> Refined:
    """Descend from every start, then from random changes of the best heights.

    A change moves some of the heights by about their spacing, and adds or takes a few asperities, of
    which there may be `most`; with `most` the present number, none are added or taken.
    """
    best: Refined | None = None
    for start in starts:
        found = descend(evaluate, np.maximum(start, start.max() - span), wanted, span, goal)
        best = found if best is None or found.misfit < best.misfit else best
        if best.misfit <= goal:
            return best
    if best is None:
        raise ValueError("a search needs a start")
    fixed = most == len(best.height)
    for _ in range(restarts):
        if best.misfit <= goal:
            break
        height = _changed(best.height, fixed, most, rng)
        found = descend(evaluate, np.maximum(height, height.max() - span), wanted, span, goal)
        best = found if found.misfit < best.misfit else best
    return best


def _changed(height: FloatArray, fixed: bool, most: int, rng: np.random.Generator) -> FloatArray:
    """Return heights moved at random by about their spacing, some added or taken."""
    n = len(height)
    spacing = float(np.ptp(height)) / n * rng.choice([0.3, 1.0, 3.0])
    moved = height + spacing * rng.standard_normal(n) * (rng.random(n) < rng.choice([0.2, 0.5, 1.0]))
    if fixed:
        return np.asarray(moved)
    if n < most and rng.random() < 0.5:
        new = rng.choice(height, rng.integers(1, min(5, most - n) + 1))
        return np.append(moved, new + spacing * rng.standard_normal(len(new)))
    if n > 2 and rng.random() < 0.3:
        return np.delete(moved, rng.integers(n))
    return np.asarray(moved)
