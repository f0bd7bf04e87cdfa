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

# Maximum number of halvings of a gradient step; 2^-40 of the first step is below rounding.
MAX_HALVINGS = 40

# Number of consecutive gradient steps after which a step ends at the first bound, where the energy is lower.
SLOW = 10


@dataclass(frozen=True, eq=False)
class Program:
    """A quadratic program: A, g, the sum of p unless z is given, and the error at which it is solved."""

    operator: Influence
    gap: FloatArray
    total: float | None
    tolerance: float
    max_iterations: int = 1000  # conjugate gradients need 10 to 60, unless the tolerance is below rounding

    def minimum(self, p: FloatArray, z: float) -> tuple[FloatArray, FloatArray, float, float]:
        """Return p, the gap A p + g - z, z and the error, from a p that satisfies the constraints and its z.

        The gap is recomputed. The error is the largest |gap| of a cell with pressure, or overlap of a cell
        without.
        """
        v, iterations, halvings, slow = self.operator.product(p) + self.gap, 0, 0, 0
        # Conjugate gradients on a face stop if their error is below this share of the error that the bounds
        # cause. Smaller values need fewer cycles and more steps: 6, 5 and 4 cycles and 17, 18 and 18 steps at
        # 1, 0.3 and 0.1 (64 contacts of 36 cells per radius). If a projected step does not decrease the
        # energy, the next face is solved less accurately, after which few cells are in tension.
        share = 0.1
        while True:
            if self.total is not None:
                z = float(v[p > 0.0].mean())
            error = max(_violations(v - z, p > 0.0))
            if error <= self.tolerance or iterations >= self.max_iterations or halvings == MAX_HALVINGS:
                return p, v - z, z, error
            face = (p > 0.0) | (v < z)
            trial, z, steps = self.on_face(face, p, v, z, share, self.max_iterations - iterations)
            iterations += max(steps, 1)
            if slow >= SLOW:
                trial = _within_bounds(p, trial)
            p, v, halvings = self._projected_step(face, p, v, z, trial)
            slow = slow + 1 if halvings else 0
            share *= 10.0 if halvings else 1.0

    def on_face(
        self, face: NDArray[np.bool_], p: FloatArray, v: FloatArray, z: float, share: float, most: int
    ) -> tuple[FloatArray, float, int]:
        """Return p and z with v = z on the face, without bounds on p, and the number of steps.

        v: the gradient A p + g. To keep the sum of p, the directions preserve it, and z is updated. The
        iteration stops if the error is within half of the tolerance, or a share of that due to the bounds.
        """
        p, w, d, rho = p.copy(), v - z, np.zeros_like(p), np.inf
        one = self.operator.precondition(face.astype(np.float64)) * face
        for step in range(most):
            s = self.operator.precondition(np.where(face, -w, 0.0)) * face
            if self.total is not None:
                change = -float(s.sum() / one.sum())
                z += change
                w -= change
                s += change * one
            inside, outside = _violations(w, face)
            if inside <= max(0.5 * self.tolerance, share * max(outside, -float(p.min()))):
                return p, z, step
            new = -_dot(s, w)
            d = s + (new / rho) * d
            rho = new
            image = self.operator.product(d)
            curvature = _dot(d, image)
            if curvature <= 0.0:  # the step is zero, or lost in rounding
                return p, z, step
            length = -_dot(d, w) / curvature
            p += length * d
            w += length * image
        return p, z, most

    def _projected_step(
        self, face: NDArray[np.bool_], p: FloatArray, v: FloatArray, z: float, trial: FloatArray
    ) -> tuple[FloatArray, FloatArray, int]:
        """Return pressure and A p + g after a projected step, and the number of halvings.

        The trial step is used if it decreases the energy or solves the program: 0 halvings. Otherwise a
        gradient step is halved until it decreases the energy. After MAX_HALVINGS, p has not changed.
        """
        for halvings in range(MAX_HALVINGS):
            new = project(trial, self.total)
            image = self.operator.product(new) + self.gap
            # the change of the energy from both gradients, without cancellation
            falls = _dot(new - p, (v - z) + (image - z)) < 0.0
            if falls or max(_violations(image - z, new > 0.0)) <= self.tolerance:
                return new, image, halvings
            if halvings == 0:
                step = np.where(face, (z if self.total is None else v[face].mean()) - v, 0.0)
                if not step.any():
                    break
                step *= 2.0 * _dot(step, step) / _dot(step, self.operator.product(step))
            step *= 0.5
            trial = p + step
        return p, v, MAX_HALVINGS


def _within_bounds(p: FloatArray, trial: FloatArray) -> FloatArray:
    """Return the point on the way from p to a trial step at which the first entry becomes 0, or the trial."""
    falling = trial < 0.0
    share = (p[falling] / (p[falling] - trial[falling])).min(initial=1.0)
    return np.asarray(np.maximum(p + share * (trial - p), 0.0) if share > 0.0 else trial)


def project(trial: FloatArray, total: float | None) -> FloatArray:
    """Return the nearest vector without negative entries and, unless `total` is None, with this sum.

    The sum of `trial` is `total` but for rounding.
    """
    if total is None:
        return np.maximum(trial, 0.0)
    trial = trial * (total / trial.sum())
    kept, shift = trial[trial > 0.0], 0.0
    while (new := float((kept.sum() - total) / kept.size)) > shift:  # each pass removes cells
        kept, shift = kept[kept > new], new
    return np.maximum(trial - shift, 0.0)


def _dot(a: FloatArray, b: FloatArray) -> float:
    """Return the inner product in one thread, since those of a BLAS may wait for busy cores."""
    return float(np.einsum("i,i", a, b))


def _violations(w: FloatArray, face: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the largest |w| on the face, and the largest -w, the overlap, outside it."""
    return float(np.abs(w[face]).max(initial=0.0)), float(-w[~face].min(initial=0.0))
