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

from metafem._validate import FloatArray
from metafem.models.boundary_elements.influence import Influence

BoolArray = NDArray[np.bool_]

# Conjugate gradients on a face stop if their error is below this share of the error that the bounds cause.
# Smaller values need fewer cycles and more steps: 6, 5 and 4 cycles and 17, 18 and 18 steps at 1, 0.3 and 0.1
# (64 contacts of 36 cells per radius). The share grows by the second number when a projected step does not
# decrease the energy: the next face is solved less accurately, after which few cells are in tension.
SHARE, GROWTH = 0.1, 10.0

# Maximum number of halvings of a gradient step; 2^-40 of the first step is below rounding.
MAX_HALVINGS = 40


@dataclass(frozen=True, eq=False)
class Minimum:
    """Pressure and gap on all cells that minimise the energy."""

    pressure: FloatArray  # not negative
    gap: FloatArray  # A p + g - z, recomputed
    multiplier: float  # z
    error: float  # largest |gap| of a cell with pressure, or overlap of a cell without


def minimise(
    operator: Influence,
    gap: FloatArray,
    pressure: FloatArray,
    multiplier: float,
    total: float | None,
    tolerance: float,
    max_iterations: int,
) -> Minimum:
    """Return the solution of the program; `pressure` is an initial guess that satisfies the constraints.

    gap: g; multiplier: z, or a first guess of z if the pressure has a fixed sum `total`. The iteration stops
    when the error, in the units of g, is within the tolerance, or after `max_iterations`.
    """
    p, v, z = pressure, operator.product(pressure) + gap, multiplier
    iterations, halvings, share = 0, 0, SHARE
    while True:
        if total is not None:
            z = float(v[p > 0.0].mean())
        error = max(_violations(v - z, p > 0.0))
        if error <= tolerance or iterations >= max_iterations or halvings == MAX_HALVINGS:
            return Minimum(p, v - z, z, error)
        face = (p > 0.0) | (v < z)
        left = max_iterations - iterations
        trial, z, steps = on_face(operator, face, p, v, z, total is not None, 0.5 * tolerance, left, share)
        iterations += max(steps, 1)
        if total is not None:
            trial *= total / trial.sum()  # which rounding may have changed
        p, v, halvings = _projected_step(operator, gap, face, p, v, z, trial, total, tolerance)
        if halvings:
            share *= GROWTH


def on_face(
    operator: Influence,
    face: BoolArray,
    p: FloatArray,
    v: FloatArray,
    z: float,
    keep_sum: bool,
    tolerance: float,
    max_steps: int,
    share: float = 0.0,
) -> tuple[FloatArray, float, int]:
    """Return p and z with v = z on the face, without bounds on p, and the number of steps.

    v: the gradient A p + g. To keep the sum of p, the directions preserve it, and z is updated. The iteration
    stops if the error is within `tolerance`, or within a share of the error that the bounds cause.
    """
    p, w = p.copy(), v - z
    d, rho = np.zeros_like(p), np.inf
    one = operator.precondition(face.astype(np.float64)) * face if keep_sum else np.zeros(0)
    for step in range(max_steps):
        s = operator.precondition(np.where(face, -w, 0.0)) * face
        if keep_sum:
            change = -float(s.sum() / one.sum())
            z += change
            w -= change
            s += change * one
        inside, outside = _violations(w, face)
        if inside <= max(tolerance, share * max(outside, -float(p.min()))):
            return p, z, step
        new = -_dot(s, w)
        d = s + (new / rho) * d
        rho = new
        image = operator.product(d)
        curvature = _dot(d, image)
        if curvature <= 0.0:  # the step is zero, or lost in rounding
            return p, z, step
        length = -_dot(d, w) / curvature
        p += length * d
        w += length * image
    return p, z, max_steps


def project(trial: FloatArray, total: float | None) -> FloatArray:
    """Return the nearest vector without negative entries and, unless `total` is None, with this sum.

    The positive entries of `trial` must sum to at least `total`.
    """
    if total is None:
        return np.maximum(trial, 0.0)
    kept, shift = trial[trial > 0.0], 0.0
    while (new := float((kept.sum() - total) / kept.size)) > shift:  # each pass removes cells
        kept, shift = kept[kept > new], new
    return np.maximum(trial - shift, 0.0)


def _dot(a: FloatArray, b: FloatArray) -> float:
    """Return the inner product in one thread, since those of a BLAS may wait for busy cores."""
    return float(np.einsum("i,i", a, b))


def _violations(w: FloatArray, face: BoolArray) -> tuple[float, float]:
    """Return the largest |w| on the face, and the largest -w, the overlap, outside it."""
    return float(np.abs(w[face]).max(initial=0.0)), float(-w[~face].min(initial=0.0))


def _projected_step(
    operator: Influence,
    gap: FloatArray,
    face: BoolArray,
    p: FloatArray,
    v: FloatArray,
    z: float,
    trial: FloatArray,
    total: float | None,
    tolerance: float,
) -> tuple[FloatArray, FloatArray, int]:
    """Return pressure and A p + g after a projected step, and the number of halvings.

    The trial step is used if it decreases the energy or solves the program: 0 halvings. Otherwise a gradient
    step is halved until it decreases the energy. After MAX_HALVINGS, the pressure has not changed.
    """
    step, length = np.zeros(0), 0.0
    for halvings in range(MAX_HALVINGS):
        new = project(trial, total)
        image = operator.product(new) + gap
        # the change of the energy from both gradients, without cancellation
        falls = _dot(new - p, (v - z) + (image - z)) < 0.0
        if falls or max(_violations(image - z, new > 0.0)) <= tolerance:
            return new, image, halvings
        if halvings == 0:
            level = z if total is None else v[face].mean()
            step = np.where(face, level - v, 0.0)
            if not step.any():
                break
            length = _dot(step, step) / _dot(step, operator.product(step))
        trial = p + length * step
        length *= 0.5
    return p, v, MAX_HALVINGS
