"""Nonlinear least squares by the Levenberg–Marquardt method, for bounded unknowns that are lengths.

Step size rule: the step is ``-J' (J J' + c s I)^-1 r``, which equals ``-(J' J + c s I)^-1 J' r``. Here c is
the damping and s the mean of the squared norms of the rows of J. If a step lowers the sum of squares, c is
divided by `DAMPING_FACTOR`. Otherwise the step is discarded and c is multiplied by `DAMPING_FACTOR`.

As a function of the heights, A0 has kinks where asperities come into contact, so a descent can end at a
local minimum. `search` therefore starts from several initial guesses, and from random changes of the best
result.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dposv

from metafem._validate import FloatArray, IntArray
from metafem.inversion.search.spaces import Bounded, Heights, Residual
from metafem.progress import each

# Smallest and largest damping c, and the factor of the step size rule.
LEAST_DAMPING, MOST_DAMPING, DAMPING_FACTOR = 1e-12, 1e4, 5.0

# If the misfit is below this multiple of the goal, random changes reach the goal faster than other initial
# guesses.
NEAR = 2.0


@dataclass(frozen=True)
class SearchOptions:
    """Sizes and numbers of steps in the searches of one inversion; they depend on the contact law."""

    # Damping of the first step.
    start_damping: float = 1e-2
    # A descent ends when a step lowers the sum of squares by less than this fraction. A descent along kinks
    # is slow, and a random change is faster (measured: a quarter of the time needed with 1e-4).
    least_gain: float = 0.05
    # Maximum number of steps of a descent, and of a descent that must converge to rounding.
    most_steps: int = 20
    most_exact_steps: int = 40
    # Sizes of random changes, relative to the mean spacing of the heights.
    change_sizes: tuple[float, ...] = (0.3, 1.0, 3.0)


DEFAULTS = SearchOptions()

# Options for contact laws other than Hertz's law. If a cap is flatter than a paraboloid, its area as a
# function of the indentation begins with an infinite slope. With adhesion the area jumps. New contacts then
# cause sharper kinks, and the gradient is not valid beyond a kink. First steps and random changes are
# therefore smaller, and descents longer. With these options and `LEVEL_DROP` of operating points, the median
# misfit for laws of random surfaces with power caps of n = 3, 4, 8 falls from .05, .07 and .5 % to .05, .05
# and .4 %, in a quarter of the time (measured).
OTHER_LAWS = SearchOptions(start_damping=1.0, least_gain=0.01, most_steps=40, change_sizes=(0.1, 0.3, 1.0))


@dataclass(frozen=True)
class Minimum:
    """Unknowns (n,) [mm] and the root mean square of the residual [-]."""

    unknowns: FloatArray
    misfit: float


def search(
    residual: Residual,
    starts: Sequence[FloatArray],
    space: Heights | Bounded,
    goal: float,
    restarts: int,
    rng: np.random.Generator,
    options: SearchOptions = DEFAULTS,
    to_rounding: bool = False,
) -> Minimum:
    """Return the best minimum of descents from initial guesses and from random changes of the best result.

    The search ends early when the misfit is close to the goal.
    """
    best, enough = Minimum(starts[0], np.inf), goal if to_rounding else NEAR * goal
    for start in each("start", starts, at_most=True):
        found = descend(residual, space.project(start), space, goal, to_rounding, options)
        best = found if found.misfit < best.misfit else best
        if best.misfit <= enough:
            break
    for _ in each("random change", range(restarts), at_most=True):
        if best.misfit <= goal:
            break
        change = space.project(space.changed(best.unknowns, rng, options.change_sizes))
        found = descend(residual, change, space, goal, to_rounding, options)
        best = found if found.misfit < best.misfit else best
    return best


def descend(
    residual: Residual,
    start: FloatArray,
    space: Heights | Bounded,
    goal: float,
    to_rounding: bool = False,
    options: SearchOptions = DEFAULTS,
) -> Minimum:
    """Return the minimum of a descent from `start`, which ends at the goal or when no step lowers the misfit.

    The descent also ends at small gains. With `to_rounding` it continues, and converges to rounding near a
    solution.
    """
    unknowns, damping, residual = start, options.start_damping, space.held(residual)
    r, jacobian = residual(unknowns)
    squares, count = float(r @ r), len(r)
    known: FloatArray | None = None
    steps = range(options.most_exact_steps if to_rounding else options.most_steps)
    for _ in each("step", steps, at_most=True):
        if np.sqrt(squares / count) <= goal or damping > MOST_DAMPING:
            break
        known = jacobian() if known is None else known
        step = _step(r, known, damping, *space.ends(unknowns))
        if step is None:
            break
        trial = space.project(unknowns + step)
        new_r, new_jacobian = residual(trial)
        new = float(new_r @ new_r)
        if new < squares:
            stalled = squares - new < options.least_gain * squares and not to_rounding
            unknowns, r, jacobian, known, squares = trial, new_r, new_jacobian, None, new
            damping = max(damping / DAMPING_FACTOR, LEAST_DAMPING)  # step size rule
            if stalled:
                break
        else:
            damping *= DAMPING_FACTOR  # step size rule
    return Minimum(unknowns, float(np.sqrt(squares / count)))


def _step(
    r: FloatArray, jacobian: FloatArray, damping: float, tallest: int, foot: IntArray
) -> FloatArray | None:
    """Return the damped step (n,) [mm], or None if no unknown changes the residual.

    If heights at the foot would move further below the tallest height, they move together with it instead.
    The step is then computed again, with their columns of the Jacobian added to the column of the tallest
    height.
    """
    count, held = len(r), np.empty(0, dtype=np.int64)
    while True:
        # the smaller of the two systems is solved
        wide = count <= jacobian.shape[1]
        product = jacobian @ jacobian.T if wide else jacobian.T @ jacobian
        size = float(np.trace(product)) / count
        if size == 0.0:
            return None
        product[np.diag_indices(len(product))] += damping * size
        step = -jacobian.T @ _solved(product, r) if wide else -_solved(product, jacobian.T @ r)
        step[held] = step[tallest]
        sinks = step[foot] < step[tallest]
        if not sinks.any():
            return np.asarray(step)
        new, foot = foot[sinks], foot[~sinks]
        jacobian = jacobian.copy()
        jacobian[:, tallest] += jacobian[:, new].sum(axis=1)
        jacobian[:, new] = 0.0
        held = np.append(held, new)


def _solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Return the solution of a damped system, by Cholesky's method unless rounding makes it indefinite."""
    _, found, failed = dposv(matrix, right)
    return np.asarray(np.linalg.solve(matrix, right) if failed else found)
