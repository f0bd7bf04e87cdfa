"""Asperities whose law is nearest to a target law: the Levenberg–Marquardt method with random restarts.

A0(P) has kinks in the heights where asperities enter the contact, so a descent can end at a local minimum.
The next descent then starts from a random change of the best unknowns. A `Space` defines the unknowns and
their limits; here they are the heights.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.targets.wanted import Wanted
from metafem.progress import each

# Law (k,) [mm^2] and its gradient (k, n) [mm] with respect to the unknowns (n,) [mm].
Evaluate = Callable[[FloatArray], tuple[FloatArray, FloatArray]]

# Damping, relative to the mean square of the Jacobian: initial value and bounds.
START_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-2, 1e-12, 1e4
DAMPING_STEP = 5.0

# Below this multiple of the goal, random changes reach the goal sooner than other initial guesses.
NEAR = 2.0

# Misfit at operating points: a hundredth of the tolerance of an exact design.
POINT_GOAL = 1e-11

# A descent ends when a step lowers the sum of squares by less than this fraction. Along kinks the progress
# is slow, and a random change is faster (measured: a quarter of the time needed with 1e-4).
GAIN = 0.05

# Heights within this share of the span of the lowest that is allowed are at the foot.
AT_FOOT = 1e-9

# Most steps of one descent, and of one that must converge to rounding.
MAX_STEPS, PATIENT_STEPS = 20, 40


@dataclass(frozen=True)
class Refined:
    """Unknowns (n,) [mm] and the weighted rms of the law's relative differences."""

    unknowns: FloatArray
    misfit: float


class Space(Protocol):
    """The unknowns of a search, a vector of lengths, with their limits and random changes."""

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the nearest unknowns within the limits."""
        ...

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return the places of the tallest height and of those as low as allowed."""
        ...

    def changed(self, unknowns: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Return unknowns changed at random."""
        ...


@dataclass(frozen=True)
class Heights:
    """Heights (n,) that differ by at most `span` [mm].

    A random change may add or remove a few asperities, up to `most` in all; with None their number is
    fixed.
    """

    span: float
    most: int | None = None

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the heights, raised where they are more than `span` below the tallest."""
        return np.asarray(np.maximum(unknowns, unknowns.max() - self.span))

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return the places of the tallest height and of those `span` below it."""
        return ends(unknowns, self.span)

    def changed(self, unknowns: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Return heights moved at random by about their spacing, with a few added or removed."""
        return moved(unknowns, self.most, rng)[0]


def ends(height: FloatArray, span: float) -> tuple[int, IntArray]:
    """Return the places of the tallest height and of those a span below it."""
    tallest = int(height.argmax())
    return tallest, np.flatnonzero(height <= height[tallest] - span * (1.0 - AT_FOOT))


def moved(height: FloatArray, most: int | None, rng: np.random.Generator) -> tuple[FloatArray, IntArray]:
    """Return heights moved at random by about their spacing, and the asperity that each derives from."""
    n = len(height)
    every = np.arange(n)
    spacing = float(np.ptp(height)) / n * rng.choice([0.3, 1.0, 3.0])
    result = height + spacing * rng.standard_normal(n) * (rng.random(n) < rng.choice([0.2, 0.5, 1.0]))
    if most is None:
        return result, every
    if n < most and rng.random() < 0.5:
        source = rng.integers(n, size=rng.integers(1, min(5, most - n) + 1))
        new = height[source] + spacing * rng.standard_normal(len(source))
        return np.append(result, new), np.append(every, source)
    if n > 2 and rng.random() < 0.3:
        taken = rng.integers(n)
        return np.delete(result, taken), np.delete(every, taken)
    return result, every


def descend(
    evaluate: Evaluate,
    start: FloatArray,
    wanted: Wanted,
    space: Space,
    goal: float,
    patient: bool = False,
) -> Refined:
    """Lower the misfit from given unknowns until it is within the goal or no step lowers it.

    A patient descent does not end at small gains: from near a solution it converges to rounding.
    """
    unknowns = start
    area, gradient = evaluate(unknowns)
    residual, jacobian = wanted.residual(area, gradient)
    squares, damping = float(residual @ residual), START_DAMPING
    count = len(residual)
    for _ in each("step", range(PATIENT_STEPS if patient else MAX_STEPS), at_most=True):
        if np.sqrt(squares / count) <= goal or damping > MOST_DAMPING:
            break
        step = _step(residual, jacobian, damping, *space.ends(unknowns))
        if step is None:
            break
        trial = space.project(unknowns + step)
        area, gradient = evaluate(trial)
        new_residual, new_jacobian = wanted.residual(area, gradient)
        new = float(new_residual @ new_residual)
        if new < squares:
            stalled = squares - new < GAIN * squares and not patient
            unknowns, residual, jacobian, squares = trial, new_residual, new_jacobian, new
            damping = max(damping / DAMPING_STEP, LEAST_DAMPING)
            if stalled:
                break
        else:
            damping *= DAMPING_STEP
    return Refined(unknowns, float(np.sqrt(squares / count)))


def _step(
    residual: FloatArray, jacobian: FloatArray, damping: float, tallest: int, foot: IntArray
) -> FloatArray | None:
    """Return the damped step, or None where no unknown changes the law.

    Heights at the foot that would sink further below the tallest follow it: the step is solved again with
    their columns of the Jacobian added to that of the tallest.
    """
    count, held = len(residual), np.empty(0, dtype=np.int64)
    while True:
        product = jacobian @ jacobian.T
        size = float(np.trace(product)) / count
        if size == 0.0:
            return None
        system = product + damping * size * np.eye(count)
        # Levenberg–Marquardt step J' (J J' + damping)^-1 r, with a (k, k) system
        step = -jacobian.T @ np.linalg.solve(system, residual)
        step[held] = step[tallest]
        sinks = step[foot] < step[tallest]
        if not sinks.any():
            return np.asarray(step)
        new, foot = foot[sinks], foot[~sinks]
        jacobian = jacobian.copy()
        jacobian[:, tallest] += jacobian[:, new].sum(axis=1)
        jacobian[:, new] = 0.0
        held = np.append(held, new)


def search(
    evaluate: Evaluate,
    starts: list[FloatArray],
    wanted: Wanted,
    space: Space,
    goal: float,
    restarts: int,
    rng: np.random.Generator,
) -> Refined:
    """Descend from every initial guess, then from random changes of the best result."""
    best: Refined | None = None
    for start in each("start", starts, at_most=True):
        found = descend(evaluate, space.project(start), wanted, space, goal)
        best = found if best is None or found.misfit < best.misfit else best
        if best.misfit <= NEAR * goal:
            break
    if best is None:
        raise ValueError("a search needs a start")
    for _ in each("random change", range(restarts), at_most=True):
        if best.misfit <= goal:
            break
        change = space.project(space.changed(best.unknowns, rng))
        found = descend(evaluate, change, wanted, space, goal)
        best = found if found.misfit < best.misfit else best
    return best
