"""Nonlinear least squares by the Levenberg–Marquardt method, with unknowns that are lengths within limits.

Step size rule: the step is ``-J' (J J' + c s I)^-1 r``, which equals ``-(J' J + c s I)^-1 J' r``, with the
damping c and the mean square s of the rows of J. After a step that lowers the sum of squares c is divided by
`SearchOptions.damping_factor`; any other step is discarded and c multiplied by it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.search.options import DEFAULTS, SearchOptions
from metafem.progress import each

# Heights within this fraction of the span of the lowest that is allowed are at the foot: rounding.
AT_FOOT = 1e-9

# Relative differences (k,) [-] from a law, and a function that returns their Jacobian (k, n) [1/mm]: it takes
# longer than the differences, and most steps need none.
LateResidual = tuple[FloatArray, Callable[[], FloatArray]]

# Those of unknowns (n,) [mm].
Residual = Callable[[FloatArray], LateResidual]


@dataclass(frozen=True)
class Minimum:
    """Unknowns (n,) [mm] and the root mean square of the residual [-]."""

    unknowns: FloatArray
    misfit: float


def descend(
    residual: Residual,
    start: FloatArray,
    space: Space,
    goal: float,
    to_rounding: bool = False,
    options: SearchOptions = DEFAULTS,
) -> Minimum:
    """Lower the misfit from given unknowns until it is within the goal or no step lowers it.

    `to_rounding` does not end at small gains: from near a solution the descent converges to rounding.
    """
    unknowns, damping = start, options.start_damping
    r, jacobian = residual(unknowns)
    squares, count = float(r @ r), len(r)
    known: FloatArray | None = None
    steps = range(options.most_exact_steps if to_rounding else options.most_steps)
    for _ in each("step", steps, at_most=True):
        if np.sqrt(squares / count) <= goal or damping > options.most_damping:
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
            damping = max(damping / options.damping_factor, options.least_damping)  # step size rule
            if stalled:
                break
        else:
            damping *= options.damping_factor  # step size rule
    return Minimum(unknowns, float(np.sqrt(squares / count)))


def _step(
    r: FloatArray, jacobian: FloatArray, damping: float, tallest: int, foot: IntArray
) -> FloatArray | None:
    """Return the damped step, or None where no unknown changes the residual.

    Heights at the foot that would sink further below the tallest follow it: the step is solved again with
    their columns of the Jacobian added to that of the tallest.
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
    from scipy.linalg.lapack import dposv

    _, found, failed = dposv(matrix, right)
    return np.asarray(np.linalg.solve(matrix, right) if failed else found)


class Space(Protocol):
    """The unknowns of a search, a vector of lengths, with their limits and random changes."""

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the nearest unknowns within the limits."""
        ...

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return the indices of the tallest height and of those as low as allowed."""
        ...

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, options: SearchOptions) -> FloatArray:
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
        """Return the indices of the tallest height and of those `span` below it."""
        return ends(unknowns, self.span)

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, options: SearchOptions) -> FloatArray:
        """Return heights moved at random by about their spacing, with a few added or removed."""
        return moved(unknowns, self.most, rng, options)[0]


def ends(height: FloatArray, span: float) -> tuple[int, IntArray]:
    """Return the indices of the tallest height and of those a span below it."""
    tallest = int(height.argmax())
    return tallest, np.flatnonzero(height <= height[tallest] - span * (1.0 - AT_FOOT))


def moved(
    height: FloatArray, most: int | None, rng: np.random.Generator, options: SearchOptions
) -> tuple[FloatArray, IntArray]:
    """Return heights moved at random by about their spacing, and the asperity that each derives from."""
    n = len(height)
    every = np.arange(n)
    spacing = float(np.ptp(height)) / n * rng.choice(options.change_sizes)
    result = height + spacing * rng.standard_normal(n) * (
        rng.random(n) < rng.choice(options.change_fractions)
    )
    if most is None:
        return result, every
    if n < most and rng.random() < options.adding:
        source = rng.integers(n, size=rng.integers(1, min(options.most_added, most - n) + 1))
        new = height[source] + spacing * rng.standard_normal(len(source))
        return np.append(result, new), np.append(every, source)
    if n > 2 and rng.random() < options.removing:
        removed = rng.integers(n)
        return np.delete(result, removed), np.delete(every, removed)
    return result, every
