"""Newton-Krylov method for many interacting contacts; `metafem._kernels.equations` states the equations."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from metafem._kernels.contact.tabulated import Law
from metafem._kernels.equations import State, empty_state, press, sharpen, spread
from metafem._kernels.vectors import exact_sum
from metafem._validate import FloatArray
from metafem.models.interacting.coarse import Coarse
from metafem.models.interacting.sums.ewald_sums import ScatteredSums
from metafem.models.interacting.sums.fft_sums import LatticeSums

# Largest residual of a converged state, and residual at which Newton's method stops. They allow for the
# errors of fast sums.
TOLERANCE = 1e-9
GOAL = 3e-10

# Maximum number of Newton steps (about 6 are needed from independent contacts), of halvings of a step, and of
# conjugate-gradient steps.
MAX_STEPS = 60
MAX_CUTS = 20
MAX_INNER = 300

# Loosest tolerance of the linear solver, used for the first step. Later tolerances are proportional to the
# square of the factor by which the last step reduced the residual (Eisenstat and Walker, SIAM J. Sci. Comput.
# 17, 16 (1996), doi:10.1137/0917003, choice 2).
LOOSEST = 0.1

# Relative residual of the tangent for the Jacobian of order 1; the stiffness has twice as many digits.
TANGENT = 1e-4

# For order 3 the tangent is corrected with the Jacobian of order 1: the residual of each correction relative
# to the previous residual, the largest change of dx/dP by the last correction, and the largest change
# relative to that of the correction before. The error that remains is a few percent of the last change.
INNER, TANGENT_CHANGE, CONTRACTION = 0.02, 1e-6, 0.04

# Factor by which the residual is reduced with rough sums before it is computed exactly again; the errors of
# rough sums are smaller.
ROUND = 1e-3

# Largest residual of the equations for sensitivities, relative to their right-hand side dA0/dp.
SENSITIVITY = 1e-9


@dataclass
class Iterate:
    """The contacts at some nominal indentations, with the errors of their equations."""

    state: State
    residual: float = math.inf
    error: FloatArray = field(default_factory=lambda: np.empty(0))
    steps: int = 0  # of Newton's method
    precondition: Callable[[FloatArray], FloatArray] | None = None  # set by the first linear solution

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Whether each asperity is in contact."""
        return np.asarray(self.state.z > 0.0)

    @property
    def compliance(self) -> FloatArray:
        """Derivative of the indentation with respect to the load, (n,) [1/mm]; 0 for open asperities."""
        state = self.state
        return np.asarray(
            np.divide(state.bend, state.rate, out=np.zeros_like(state.bend), where=state.z > 0.0)
        )


def open_state(gap: FloatArray) -> Iterate:
    """Return the state without contact; gap: minus the gaps of the summits, (n,) [mm]."""
    state = empty_state(len(gap))
    state.z[:] = state.indentation[:] = gap
    return Iterate(state, 0.0)


@dataclass
class ContactEquations:
    """The equations of the contacts of one surface, coupled by fast sums.

    Newton's method uses the Jacobian of order 1 also for order 3, which changes the Jacobian by only a
    percent.
    """

    sums: LatticeSums | ScatteredSums
    order: int
    law: Law
    self_term: FloatArray
    gap: FloatArray
    coarse: Coarse

    def respond(self, z: FloatArray, approach: float, target: float) -> Iterate:
        """Return the contacts at nominal indentations z (n,) [mm], with their residual."""
        state = empty_state(len(z))
        state.z[:] = z
        count = press(self.law, self.order, state)
        load, u = state.load, state.displacement
        outside = False
        if self.order == 1:
            u[:] = self.self_term * load + self.sums.displacement(load)
        else:
            curvature, x, y = self.sums.field(load)
            state.curvature[:], state.slope_x[:], state.slope_y[:] = curvature, x, y
            sharpen(self.law, state, count)
            outside = bool(state.outside.any())
            u[:] = self.sums.displacement(load, state.moment, -state.lever * x, -state.lever * y)
            u += self.self_term * load - 0.5 * state.lever_rate * (x**2 + y**2)
        error = state.indentation + u - (approach - self.gap)
        overlap = np.where(z > 0.0, np.abs(error), z - error)
        largest = float(state.indentation.max())
        residual = float(max(overlap.max(), 0.0)) / largest if largest > 0.0 and not outside else 1.0
        if target > 0.0:
            residual = max(residual, abs(exact_sum(load) - target) / target)
        return Iterate(state, residual, error)

    def newton(
        self, z: FloatArray, approach: float, target: float, tolerance: float = GOAL
    ) -> tuple[Iterate, float]:
        """Return the equilibrium at an approach or, if `target` > 0, at this load, and its approach."""
        state = self.respond(z, approach, target)
        forcing = LOOSEST
        for taken in range(MAX_STEPS):
            if state.residual <= tolerance:
                break
            if not state.closed.any():
                state = self.respond(approach - self.gap, approach, target)
            if self.diagonal(state).min() < 0.0:  # ill-posed: the self term outweighs the contact law
                state.residual = max(state.residual, 1.0)
                break
            missing = target - float(state.state.load.sum()) if target > 0.0 else None
            largest = float(state.state.indentation.max())
            goal = largest * max(forcing * min(state.residual, 1.0), 0.3 * GOAL)
            loads, shift, rest = self.solve(state, -state.error, missing, goal)
            step = np.where(state.closed, state.compliance * loads, rest + shift) / state.state.bend
            length = 1.0
            for _ in range(MAX_CUTS):
                new = self.respond(state.state.z + length * step, approach + length * shift, target)
                if new.residual <= (1.0 - 0.25 * length) * state.residual or new.residual <= GOAL:
                    break
                length *= 0.5
            if new.residual >= state.residual:
                break
            forcing = min(LOOSEST, max(0.9 * (new.residual / state.residual) ** 2, 1e-3))
            state, approach = new, approach + length * shift
            state.steps = taken + 1
        return state, approach

    def diagonal(self, state: Iterate) -> FloatArray:
        """Return the diagonal of the Jacobian dF/dp, (n,) [1/mm]; 0 for open asperities."""
        return np.asarray(np.where(state.closed, state.compliance + self.self_term, 0.0))

    def tangent(self, state: Iterate, coupled: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Return dP/dx [mm] and dz/dx (n,) at an equilibrium, and the next `coupled`.

        With order 3, ``H y = x 1`` is solved for the loads y with a sum of 1 by corrections with the Jacobian
        H1 of order 1. `coupled` is (H1 - H) y of the last tangent, or zero, so that usually one product with
        H is enough.
        """
        diagonal, none = self.diagonal(state), np.zeros_like(coupled)
        # the energy of the error relative to that of the tangent is at most the square of the residual,
        # divided by the compliances of independent contacts in parallel and of the scene; for the latter the
        # coarse model is used
        inverse = np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=state.closed)
        alone = 1.0 / float(inverse.sum())
        together = alone + alone**2 * float(inverse @ self.coarse.displacement(inverse))
        goal = TANGENT * math.sqrt(alone * max(alone, together))
        share, shift, rest = self.solve(state, coupled, 1.0, goal, exact=self.order == 1)
        form, gain, before = float(share @ (coupled - rest)), 0.0 if self.order == 1 else math.inf, math.inf
        while gain > TANGENT_CHANGE * form:
            if gain > CONTRACTION * before:  # the Jacobian of order 1 is too different
                share, shift, rest = self.solve(state, none, 1.0, goal, exact=True)
                form, coupled = -float(share @ rest), none
                break
            image = self.jacobian(state, share, True)
            coupled = np.where(state.closed, self.sums.displacement(share) - image, 0.0)
            rest = -image - np.where(state.closed, diagonal * share, 0.0)
            left = float(np.abs(rest + shift)[state.closed].max())
            change, shift, after = self.solve(state, rest, 0.0, max(INNER * left, 0.01 * goal))
            # y.H y is stationary at the tangent; this is y.H1 y of the change
            before, gain = gain, float(change @ rest)
            form = -float(share @ rest) - gain
            share, rest = share + change, after
        rate = (rest + shift + state.compliance * share) / state.state.bend / shift
        return 1.0 / form, rate, coupled

    def area_gradient(self, state: Iterate) -> FloatArray:
        """Return dA0/dh at fixed load at an equilibrium, (n,) [mm].

        The method solves ``H l = c + x 1`` with the x for which the sum of l over the contacts is zero; see
        `interacting.sensitivity`.
        """
        closed, found, none = state.closed, state.state, np.zeros_like(self.gap)
        spread(self.order, self.law, found)
        widened = found.by_load
        if self.order == 3:
            tilting = 2.0 * found.by_slope
            slopes = (tilting * slope for slope in (found.slope_x, found.slope_y))
            widened = widened + self.sums.displacement(none, 0.5 * found.by_curvature, *slopes)
        by_load = np.where(closed, math.pi * widened, 0.0)
        change, _, _ = self.solve(state, by_load, 0.0, SENSITIVITY * float(by_load.max()), exact=True)
        return change

    def jacobian(self, state: Iterate, loads: FloatArray, exact: bool) -> FloatArray:
        """Return dF/dp times a change of the loads, (n,), without the diagonal of the law and self terms.

        If not exact, the rough sums of order 1 are used.
        """
        if not exact:
            return self.sums.rough.displacement(loads)
        if self.order == 1:
            return self.sums.displacement(loads)
        found = state.state
        third, lever_rate = found.square / 6.0, found.lever_rate
        curvature, *slope = self.sums.field(loads)
        old = (found.slope_x, found.slope_y)
        flatter = 2.0 / 45.0 * found.square**2.5
        moment = [
            -lever_rate * before * loads - found.lever * new for before, new in zip(old, slope, strict=True)
        ]
        image = self.sums.displacement(loads, third * loads - flatter * curvature, *moment)
        tilt = sum(before * new for before, new in zip(old, slope, strict=True))
        bend = 0.5 * found.lever_bend * (old[0] ** 2 + old[1] ** 2)
        return np.asarray(image + third * curvature - lever_rate * tilt - bend * loads)

    def solve(
        self,
        state: Iterate,
        rhs: FloatArray,
        total: float | None,
        goal: float,
        exact: bool = False,
    ) -> tuple[FloatArray, float, FloatArray]:
        """Return changes of loads (n,) and approach for the linearised equations, and the residual (n,).

        If `total` is not None, it is the sum of the changes of the loads. Preconditioned conjugate gradients
        are used, with the constraint in the preconditioner as in `metafem._kernels.projected_cg`. The
        residual includes the rows of open asperities. If `exact`, it is that of the exact Jacobian. For order
        1 conjugate gradients with rough sums then start again from this residual until it is small enough.
        """
        closed, diagonal = state.closed, self.diagonal(state)
        refined = exact and self.order == 1 and self.sums.rough is not self.sums

        def image(change: FloatArray, exact: bool) -> FloatArray:
            return self.jacobian(state, change, exact) + np.where(closed, diagonal * change, 0.0)

        precondition = state.precondition
        if precondition is None:
            inverse = np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=closed)
            precondition = state.precondition = self.coarse.preconditioner(inverse)
        loads, shift, rest = np.zeros_like(rhs), 0.0, rhs.copy()
        if total is not None:
            uniform = precondition(closed.astype(np.float64))
            uniform_load = float(uniform.sum())
            if total != 0.0:
                loads = uniform * (total / uniform_load)
                rest -= image(loads, exact)
        direction, before, level = np.zeros_like(rhs), 0.0, goal
        for _ in range(MAX_INNER):
            # without the constant part, to avoid rounding errors
            inside = np.where(closed, rest + shift, 0.0)
            ahead = precondition(inside)
            if total is not None:
                more = -float(ahead.sum()) / uniform_load
                shift, ahead = shift + more, ahead + more * uniform
                inside[closed] += more
            largest = float(np.abs(inside).max())
            if refined and before == 0.0:  # the residual is exact
                level = max(goal, ROUND * largest)
            elif refined and largest <= level:
                rest, before = rhs - image(loads, True), 0.0
                continue
            if largest <= goal:
                if not exact:  # one more correction, for which no product is needed
                    loads = loads + ahead
                break
            product = float(inside @ ahead)
            direction = ahead + (product / before if before > 0.0 else 0.0) * direction
            before = product
            change = image(direction, exact and not refined)
            length = product / float(direction @ change)
            if not length > 0.0:
                break
            loads = loads + length * direction
            rest -= length * change
        return loads, shift, rest
