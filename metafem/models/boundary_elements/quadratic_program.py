"""Bound-constrained quadratic programs by projected, preconditioned conjugate gradients.

Minimises ``p.A p / 2 + p.(g - z)`` for p >= 0, where z is given, or for p >= 0 with a fixed sum, where z is
the Lagrange multiplier. Conjugate gradients are applied on the cells that carry pressure. A step that
violates the bounds is projected. Cells that overlap the plane are added when their violation exceeds the
error on the other cells (proportioning: Dostál, Optimal Quadratic Programming Algorithms (2009), chapter 5,
doi:10.1007/b138610).

A projected step is accepted only if it decreases the energy; otherwise a sufficiently short projected
gradient step replaces it. Since the energy decreases at every step, no set of cells recurs.
The program is strictly convex. The residual of its optimality conditions is recomputed for the returned
pressure and certifies the solution. In contrast, Polonsky and Keer, Wear 231, 206 (1999),
doi:10.1016/S0043-1648(99)00113-1, accept all projected steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._kernels import vectors as kernel
from metafem._validate import FloatArray
from metafem.models.boundary_elements.influence import Influence

# Maximum number of halvings of a gradient step; 2^-40 of the first step is below rounding.
MAX_HALVINGS = 40

# Maximum number of passes in the projection with a fixed sum. Each pass removes cells, and a few usually
# suffice.
MAX_PASSES = 100


@dataclass(frozen=True, eq=False)
class Minimum:
    """Pressure and gap on all cells that minimise the energy."""

    pressure: FloatArray  # not negative
    gradient: FloatArray  # A p + g - z, recomputed: the gap
    multiplier: float  # z
    error: float  # largest |gap| of a cell with pressure, or overlap of a cell without
    iterations: int


def project(trial: FloatArray, total: float | None) -> FloatArray:
    """Return the nearest vector without negative entries and, unless `total` is None, with this sum.

    The positive entries of `trial` must sum to at least `total`.
    """
    if total is None:
        return np.maximum(trial, 0.0)
    candidates = trial[trial > 0.0]
    shift = 0.0
    for _ in range(MAX_PASSES):
        kept = candidates[candidates > shift]
        new = float((kept.sum() - total) / kept.size)
        if new <= shift:
            break
        shift = new
    return np.maximum(trial - shift, 0.0)


def minimise(
    operator: Influence,
    gap: FloatArray,
    pressure: FloatArray,
    *,
    multiplier: float,
    total: float | None,
    tolerance: float,
    max_iterations: int,
) -> Minimum:
    """Return the solution of the program; `pressure` is an initial guess that satisfies the constraints.

    operator: A and its preconditioner; gap: g; multiplier: z, or a first guess of z if the pressure has a
    fixed sum `total`. The iteration stops when the error, in the units of g, is within the tolerance.
    """
    problem = _Problem(operator, gap, total, multiplier)
    p = pressure
    v = operator.product(p) + gap
    face = problem.face(p, v)
    d = np.zeros_like(p)
    rho = 0.0
    for iteration in range(max_iterations):
        s = problem.direction(v, face)
        w = v - problem.multiplier
        inner = np.where(face, w, 0.0)
        inside, outside = kernel.violations(w, face)
        if max(inside, outside) <= tolerance:
            again = operator.product(p) + gap
            if _error(p, again, problem) <= tolerance:
                return _result(p, again, problem, iteration)
            v = again
        if outside > inside:
            face = (p > 0.0) | (w < 0.0)
            rho = 0.0
            continue
        new_rho = -kernel.dot(inner, s)
        d = s + (new_rho / rho) * d if rho > 0.0 else s
        rho = new_rho
        slope = kernel.dot(inner, d)
        image = operator.product(d)
        length = -slope / kernel.dot(d, image)
        trial = p + length * d
        if trial.min() >= 0.0:
            v = v + length * image
            p = trial
            continue
        p, v, moved = _projected_step(problem, p, v, trial)
        face = problem.face(p, v)
        rho = 0.0
        if not moved:
            break
    return _result(p, operator.product(p) + gap, problem, max_iterations)


def solve_on(
    operator: Influence, face: NDArray[np.bool_], right: FloatArray, tolerance: float, max_iterations: int
) -> FloatArray:
    """Return q with A q = right on the face and q = 0 elsewhere, by preconditioned conjugate gradients.

    The iteration stops when the largest error of the equations is within `tolerance`, or after
    `max_iterations`.
    """
    q = np.zeros_like(right)
    rest = np.where(face, right, 0.0)
    d = np.zeros_like(right)
    rho = np.inf
    for _ in range(max_iterations):
        if float(np.abs(rest).max()) <= tolerance:
            break
        s = np.where(face, operator.precondition(rest), 0.0)
        new = kernel.dot(rest, s)
        d = s + (new / rho) * d
        rho = new
        image = np.where(face, operator.product(d), 0.0)
        length = rho / kernel.dot(d, image)
        q += length * d
        rest -= length * image
    return q


class _Problem:
    """The data of the program, and the current multiplier."""

    def __init__(self, operator: Influence, gap: FloatArray, total: float | None, multiplier: float) -> None:
        self.operator = operator
        self.gap = gap
        self.total = total
        self.multiplier = multiplier
        self._ones: tuple[NDArray[np.bool_], FloatArray, float] | None = None

    def face(self, p: FloatArray, v: FloatArray) -> NDArray[np.bool_]:
        """Return whether each cell has pressure or overlaps the plane; with a fixed sum, update z first."""
        if self.total is not None:
            self.multiplier = float(v[p > 0.0].mean())
        return np.asarray((p > 0.0) | (v < self.multiplier))

    def direction(self, v: FloatArray, face: NDArray[np.bool_]) -> FloatArray:
        """Return a preconditioned descent direction on the face, which preserves the sum if this is fixed.

        In that case the multiplier is set such that the sum of the direction is zero.
        """
        s = self._restricted(self.multiplier - v, face)
        if self.total is None:
            return s
        if self._ones is None or self._ones[0] is not face:
            one = self._restricted(np.ones_like(v), face)
            self._ones = (face, one, float(one.sum()))
        _, one, sum_one = self._ones
        change = -float(s.sum()) / sum_one
        self.multiplier += change
        return np.asarray(s + change * one)

    def _restricted(self, vector: FloatArray, face: NDArray[np.bool_]) -> FloatArray:
        return np.where(face, self.operator.precondition(np.where(face, vector, 0.0)), 0.0)

    def energy_change(self, step: FloatArray, before: FloatArray, after: FloatArray) -> float:
        """Return the change of the energy by a step, from both gradients, without cancellation."""
        return float(0.5 * kernel.dot(step, before + after)) - self.multiplier * float(step.sum())


def _projected_step(
    problem: _Problem, p: FloatArray, v: FloatArray, trial: FloatArray
) -> tuple[FloatArray, FloatArray, bool]:
    """Return pressure and A p + g after the projected trial step, or a projected gradient step, and success.

    The trial step is used if it decreases the energy; otherwise the gradient step is halved until it does.
    """
    operator, gap = problem.operator, problem.gap
    step, length = np.zeros(0), 0.0
    for halvings in range(MAX_HALVINGS):
        new = project(trial, problem.total)
        image = operator.product(new) + gap
        if problem.energy_change(new - p, v, image) < 0.0:
            return new, image, True
        if halvings == 0:
            face = problem.face(p, v)
            w = v - (problem.multiplier if problem.total is None else v[face].mean())
            step = np.where(face, -w, 0.0)
            if not step.any():
                break
            length = kernel.dot(step, step) / kernel.dot(step, operator.product(step))
        trial = p + length * step
        length *= 0.5
    return p, v, False


def _error(p: FloatArray, v: FloatArray, problem: _Problem) -> float:
    w = v - problem.multiplier
    closed = np.abs(w[p > 0.0]).max(initial=0.0)
    return float(max(closed, -w[p == 0.0].min(initial=0.0)))


def _result(p: FloatArray, v: FloatArray, problem: _Problem, iterations: int) -> Minimum:
    return Minimum(p, v - problem.multiplier, problem.multiplier, _error(p, v, problem), iterations)
