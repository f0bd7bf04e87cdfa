"""Bound-constrained quadratic programs by projected, preconditioned conjugate gradients.

Minimises ``p.A p / 2 + p.(g - z)`` for p >= 0, where z is given, or for p >= 0 with a fixed sum, where z is
the Lagrange multiplier. Each cycle fixes the face: the cells that carry pressure or overlap the plane. On it
conjugate gradients solve ``A p + g = z`` without the bounds, until the error there is well below the error
that the bounds will cause. The result is then projected, which removes the cells in tension, and the next
cycle begins with the new face (proportioning: Dostál, Optimal Quadratic Programming Algorithms (2009),
chapter 5, doi:10.1007/b138610).

A projected step is accepted only if it decreases the energy; otherwise a sufficiently short projected
gradient step replaces it. Since the energy decreases in every cycle, no set of cells recurs.
The program is strictly convex. The residual of the optimality conditions is computed from a product with the
projected pressure. It certifies the solution. In contrast, Polonsky and Keer, Wear 231,
206 (1999), doi:10.1016/S0043-1648(99)00113-1, accept all projected steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._kernels import vectors as kernel
from metafem._validate import FloatArray
from metafem.models.boundary_elements.influence import Influence

# Conjugate gradients on a face stop if their error is below this share of the error that the bounds cause.
# Smaller values need fewer cycles and more steps: 6, 5 and 4 cycles and 17, 18 and 18 steps at 1, 0.3 and 0.1
# (64 contacts of 36 cells per radius).
SHARE = 0.1

# Growth of this share when a projected step does not decrease the energy: the next face is solved less
# accurately, down to one step, after which few cells are in tension.
GROWTH = 10.0

# Tolerance on a face divided by that of the program.
INNER = 0.5

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

    operator: A and its preconditioner; gap: g; multiplier: z, or a first
    guess of z if the pressure has a fixed sum `total`. The iteration stops when the error, in the units of g,
    is within the tolerance.
    """
    problem = _Problem(operator, gap, total, multiplier)
    p, v = pressure, operator.product(pressure) + gap
    iterations, halvings, share = 0, 0, SHARE
    while True:
        problem.restrict(p, v)
        error = problem.error(p, v)
        if error <= tolerance or iterations >= max_iterations or halvings == MAX_HALVINGS:
            break
        trial, steps = _on_face(problem, p, v, INNER * tolerance, max_iterations - iterations, share)
        iterations += max(steps, 1)
        if total is not None:
            trial *= total / trial.sum()  # which rounding may have changed
        p, v, halvings = _projected_step(problem, p, v, trial, tolerance)
        if halvings > 0:
            share *= GROWTH
    return Minimum(p, v - problem.multiplier, problem.multiplier, error, iterations)


def solve_on(
    operator: Influence, face: NDArray[np.bool_], right: FloatArray, tolerance: float, max_iterations: int
) -> FloatArray:
    """Return q with A q = right on the face and q = 0 elsewhere, by preconditioned conjugate gradients.

    The iteration stops when the largest error of the equations, recomputed in double precision, is within
    `tolerance`, or after `max_iterations`.
    """
    problem = _Problem(operator, -right, None, 0.0)
    problem.face = face
    q, v = np.zeros_like(right), -right
    iterations = 0
    while np.abs(v[face]).max(initial=0.0) > tolerance and iterations < max_iterations:
        q, steps = _on_face(problem, q, v, INNER * tolerance, max_iterations - iterations, 0.0)
        iterations += max(steps, 1)
        v = operator.product(q) - right
    return q


class _Problem:
    """The data of the program, and the current face and multiplier."""

    def __init__(self, operator: Influence, gap: FloatArray, total: float | None, multiplier: float) -> None:
        self.operator = operator
        self.gap = gap
        self.total = total
        self.multiplier = multiplier
        self.face: NDArray[np.bool_] = np.zeros(gap.shape, dtype=bool)

    def restrict(self, p: FloatArray, v: FloatArray) -> None:
        """Set the face, the cells with pressure or overlap; with a fixed sum, update z first."""
        if self.total is not None:
            self.multiplier = float(v[p > 0.0].mean())
        self.face = np.asarray((p > 0.0) | (v < self.multiplier))

    def restricted(self, vector: FloatArray) -> FloatArray:
        """Return the preconditioner on the face, applied to a vector that is zero elsewhere."""
        return self.operator.precondition(vector) * self.face

    def error(self, p: FloatArray, v: FloatArray) -> float:
        """Return the largest |gap| of a cell with pressure, or overlap of a cell without."""
        return float(max(kernel.violations(v, self.multiplier, p > 0.0)))

    def energy_change(self, step: FloatArray, before: FloatArray, after: FloatArray) -> float:
        """Return the change of the energy by a step, from both gradients, without cancellation."""
        z = self.multiplier
        return float(0.5 * (kernel.shifted_dot(step, before, z) + kernel.shifted_dot(step, after, z)))


def _on_face(
    problem: _Problem,
    p: FloatArray,
    v: FloatArray,
    tolerance: float,
    max_steps: int,
    share: float,
) -> tuple[FloatArray, int]:
    """Return the solution on the face without bounds, which may be negative, and the number of steps.

    With a fixed sum, the directions preserve it, and the multiplier is updated. The iteration stops if the
    error is within `tolerance`, or within a share of the error that the bounds cause.
    """
    face, operator = problem.face, problem.operator
    p, v = p.copy(), v.copy()
    d = np.zeros_like(p)
    rho = np.inf
    if problem.total is not None:
        one = problem.restricted(face.astype(np.float64))
        sum_one = float(one.sum())
    for step in range(max_steps):
        s = problem.restricted(kernel.shortage(v, problem.multiplier, face))
        if problem.total is not None:
            change = -float(s.sum()) / sum_one
            problem.multiplier += change
            kernel.add_multiple(s, change, one)
        inside, outside = kernel.violations(v, problem.multiplier, face)
        if inside <= max(tolerance, share * max(outside, -float(p.min()))):
            return p, step
        new = -kernel.shifted_dot(s, v, problem.multiplier)
        d *= new / rho
        d += s
        rho = new
        image = operator.product(d)
        curvature = kernel.dot(d, image)
        if curvature <= 0.0:  # the step is zero, or lost in rounding
            return p, step
        length = -kernel.shifted_dot(d, v, problem.multiplier) / curvature
        kernel.add_multiple(p, length, d)
        kernel.add_multiple(v, length, image)
    return p, max_steps


def _projected_step(
    problem: _Problem, p: FloatArray, v: FloatArray, trial: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray, int]:
    """Return pressure and A p + g after a projected step, and the number of halvings.

    The trial step is used if it decreases the energy or solves the program: 0 halvings. Otherwise a gradient
    step is halved until it decreases the energy. After MAX_HALVINGS, the pressure has not changed.
    """
    operator, gap = problem.operator, problem.gap
    step, length = np.zeros(0), 0.0
    for halvings in range(MAX_HALVINGS):
        new = project(trial, problem.total)
        image = operator.product(new) + gap
        if problem.energy_change(new - p, v, image) < 0.0 or problem.error(new, image) <= tolerance:
            return new, image, halvings
        if halvings == 0:
            problem.restrict(p, v)
            z = problem.multiplier if problem.total is None else v[problem.face].mean()
            step = np.where(problem.face, z - v, 0.0)
            if not step.any():
                break
            length = kernel.dot(step, step) / kernel.dot(step, operator.product(step))
        trial = p + length * step
        length *= 0.5
    return p, v, MAX_HALVINGS
