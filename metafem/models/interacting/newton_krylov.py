"""Newton-Krylov method for many interacting contacts; `metafem._kernels.equations` states the equations."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from metafem._kernels.curve import (
    CARRIED,
    REMEMBERED,
    STIFFNESS,
    empty_memory,
    predict,
    remember,
    uniform_approach,
)
from metafem._kernels.equations import State, measure, press, sharpen, spread
from metafem._kernels.law import Law
from metafem._kernels.vectors import exact_sum
from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.models.interacting.influence import MOST_KEPT_SUMS, cached
from metafem.models.interacting.scattered import fast_sums
from metafem.models.interacting.sums import Preconditioner, Sums, coarse_model
from metafem.progress import each
from metafem.substrate import Radial
from metafem.surface import Surface

# Largest residual of a converged state, and residual at which Newton's method stops. They allow for the
# errors of fast sums.
TOLERANCE, GOAL = 1e-9, 3e-10

# Maximum number of conjugate-gradient steps (about 5 are needed). What is not converged has a residual above
# the tolerance, or raises.
MAX_INNER = 300

# Empty array that is passed for results that are not recorded.
NOT_RECORDED = np.empty((0, 0))


@dataclass
class Iterate:
    """The contacts at some nominal indentations, with the errors of their equations."""

    state: State
    residual: float
    error: FloatArray  # of their equations, (n,) [mm]
    self_term: FloatArray
    coarse: Preconditioner

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """Whether each asperity is in contact."""
        return np.asarray(self.state.z > 0.0)

    @cached_property
    def compliance(self) -> FloatArray:
        """Derivative of the indentation with respect to the load, (n,) [1/mm]; 0 for open asperities."""
        bend, rate = self.state.bend, self.state.rate
        return np.asarray(np.divide(bend, rate, out=np.zeros_like(bend), where=self.closed))

    @cached_property
    def diagonal(self) -> FloatArray:
        """Diagonal of the Jacobian dF/dp, (n,) [1/mm]; 0 for open asperities."""
        return np.asarray(np.where(self.closed, self.compliance + self.self_term, 0.0))

    @cached_property
    def precondition(self) -> Callable[[FloatArray], FloatArray]:
        """Preconditioner of the Jacobian of the contacts."""
        none = np.zeros_like(self.diagonal)
        return self.coarse(np.divide(1.0, self.diagonal, out=none, where=self.closed))

    @cached_property
    def uniform(self) -> FloatArray:
        """Loads for a uniform displacement by the preconditioner, (n,) [mm]."""
        return self.precondition(self.closed.astype(np.float64))


@dataclass
class ContactEquations:
    """The equations of the contacts of one surface, coupled by fast sums.

    Newton's method uses the Jacobian of order 1 also for order 3, which changes the Jacobian by only a
    percent.
    """

    sums: Sums
    order: int
    law: Law
    self_term: FloatArray  # with that of the substrate, (n,) [1/mm]
    gap: FloatArray
    coarse: Preconditioner

    def respond(self, z: FloatArray, approach: float, target: float) -> Iterate:
        """Return the contacts at nominal indentations z (n,) [mm], with their residual."""
        state = State(len(z))
        state.z[:] = z
        count = press(self.law, self.order, state.block, state.closed)
        load, u = state.load, state.displacement
        if self.order == 1:
            u[:] = self.self_term * load + self.sums.displacement(load)
        else:
            curvature, x, y = self.sums.field(load)
            state.curvature[:], state.slope_x[:], state.slope_y[:] = curvature, x, y
            sharpen(self.law, state.block, state.closed, count)
            u[:] = self.sums.displacement(load, state.moment, -state.lever * x, -state.lever * y)
            u += self.self_term * load - 0.5 * state.lever_rate * (x**2 + y**2)
        residual, _ = measure(self.gap, approach, target, state.block, count)
        error = state.indentation + u - (approach - self.gap)
        return Iterate(state, residual, error, self.self_term, self.coarse)

    def newton(self, z: FloatArray, approach: float, target: float) -> tuple[Iterate, float]:
        """Return the equilibrium at an approach or, if `target` > 0, at this load, and its approach."""
        at = self.respond(z, approach, target)
        forcing = loosest = 0.1  # largest residuals of linear equations, relative to their solution
        for _ in range(60):  # about 6 are needed from independent contacts
            if not at.closed.any():
                at = self.respond(approach - self.gap, approach, target)
            if at.diagonal.min() < 0.0:  # ill-posed: the self term outweighs the contact law
                at.residual = max(at.residual, 1.0)
                break
            if at.residual <= GOAL:
                break
            missing = target - float(at.state.load.sum()) if target > 0.0 else 0.0
            start = at.uniform * (missing / float(at.uniform.sum()))
            goal = float(at.state.indentation.max()) * max(forcing * min(at.residual, 1.0), 0.3 * GOAL)
            loads, shift, rest, _ = self.solve(at, -at.error, start, target > 0.0, goal)
            step = np.where(at.closed, at.compliance * loads, rest + shift) / at.state.bend
            length = 1.0
            for _ in range(20):
                new = self.respond(at.state.z + length * step, approach + length * shift, target)
                if new.residual <= (1.0 - 0.25 * length) * at.residual or new.residual <= GOAL:
                    break
                length *= 0.5
            if new.residual >= at.residual:
                break
            # proportional to the square of the last reduction: choice 2 of Eisenstat and Walker, SIAM J. Sci.
            # Comput. 17, 16 (1996), doi:10.1137/0917003
            forcing = min(loosest, max(0.9 * (new.residual / at.residual) ** 2, 1e-3))
            at, approach = new, approach + length * shift
        return at, approach

    def tangent(self, at: Iterate, before: FloatArray) -> tuple[float, FloatArray]:
        """Return dP/dx [mm] and dp/dP (n,) at an equilibrium; dP/dx is infinite without success.

        ``H y = x 1`` is solved for the loads y with a sum of 1, from those of the state before.
        """
        start = np.where(at.closed, before, 0.0)
        if start.sum() <= 0.5:
            start = at.uniform
        # the energy of the error relative to that of the tangent is at most the square of the residual,
        # divided by the compliances of independent contacts in parallel and of the scene
        alone = 1.0 / float((1.0 / at.diagonal[at.closed]).sum())
        tolerance = 1e-4 if self.order == 1 else 3e-4  # the stiffness has twice as many digits
        goal = tolerance * math.sqrt(alone / float(at.uniform.sum()))
        share, _, rest, good = self.solve(
            at, np.zeros_like(start), start / float(start.sum()), True, goal, exact=True
        )
        return -1.0 / float(share @ rest) if good else math.inf, share

    def area_gradient(self, at: Iterate) -> FloatArray:
        """Return dA0/dh at fixed load at an equilibrium, (n,) [mm].

        The method solves ``H l = c + x 1`` with the x for which the sum of l over the contacts is zero; see
        `metafem._kernels.gradient`.
        """
        found, none = at.state, np.zeros_like(self.gap)
        spread(self.order, self.law, found.block)
        widened = found.by_load
        if self.order == 3:
            slopes = (2.0 * found.by_slope * slope for slope in (found.slope_x, found.slope_y))
            widened = widened + self.sums.displacement(none, 0.5 * found.by_curvature, *slopes)
        by_load = np.where(at.closed, math.pi * widened, 0.0)
        goal = 1e-9 * float(by_load.max())
        change, _, _, good = self.solve(at, by_load, none, True, goal, exact=True)
        if not good:
            raise NotConverged(f"the derivatives of A0 are not converged after {MAX_INNER} steps")
        return change

    def jacobian(self, at: Iterate, loads: FloatArray, exact: bool) -> FloatArray:
        """Return dF/dp times a change of the loads, (n,); if not exact, for order 1."""
        if self.order == 1 or not exact:
            return at.diagonal * loads + self.sums.displacement(loads)
        found = at.state
        third, lever_rate = found.square / 6.0, found.lever_rate
        old_x, old_y = found.slope_x, found.slope_y
        curvature, x, y = self.sums.field(loads)
        image = self.sums.displacement(
            loads,
            third * loads - 2.0 / 45.0 * found.square**2.5 * curvature,
            -lever_rate * old_x * loads - found.lever * x,
            -lever_rate * old_y * loads - found.lever * y,
        )
        image += third * curvature - lever_rate * (old_x * x + old_y * y)
        bend = 0.5 * found.lever_bend * (old_x**2 + old_y**2)
        return np.asarray(image + (at.diagonal - bend) * loads)

    def solve(
        self, at: Iterate, rhs: FloatArray, loads: FloatArray, free: bool, goal: float, exact: bool = False
    ) -> tuple[FloatArray, float, FloatArray, bool]:
        """Solve the linearised equations for changes of loads (n,), from a start.

        Return them, the change of the approach, the residual (n,), and whether it reaches the goal. If
        `free`, the approach changes such that the sum of the loads remains. Preconditioned conjugate
        gradients are used, with the constraint in the preconditioner as in `metafem._kernels.newton`.
        The residual includes the rows of open asperities.
        """
        shift, whole, direction, before = 0.0, float(at.uniform.sum()), np.zeros_like(rhs), math.inf
        rest = rhs - self.jacobian(at, loads, exact) if loads.any() else rhs.copy()
        for _ in range(MAX_INNER):
            # without the constant part, to avoid rounding errors
            inside = np.where(at.closed, rest + shift, 0.0)
            ahead = at.precondition(inside)
            if free:
                more = -float(ahead.sum()) / whole
                shift, ahead = shift + more, ahead + more * at.uniform
                inside[at.closed] += more
            if float(np.abs(inside).max()) <= goal:
                # if not exact, one more correction, for which no product is needed
                return loads if exact else loads + ahead, shift, rest, True
            product = float(inside @ ahead)
            direction = ahead + product / before * direction
            before = product
            change = self.jacobian(at, direction, exact)
            length = product / float(direction @ change)
            if not length > 0.0:
                break
            loads = loads + length * direction
            rest -= length * change
        return loads, shift, rest, False

    def follow(
        self, control: FloatArray, by_load: bool, found: FloatArray, indentation: FloatArray = NOT_RECORDED
    ) -> State:
        """Fill the results (6, k) at increasing loads or approaches, and return the last state.

        found: rows as in `metafem._kernels.curve`. indentation: (k, n) [mm]; filled with nominal indentations
        unless empty.
        """
        gap, law = self.gap, self.law
        last = State(len(gap))
        x, points, memory, share = 0.0, 0, empty_memory(len(gap)), np.zeros_like(gap)
        for j, value in enumerate(each("load", control.tolist())):
            if value <= 0.0:
                found[:, j] = 0.0 if by_load else value, 0.0, 0.0, 0.0, 0.0, 0.0
                last = State(len(gap))
                last.z[:] = last.indentation[:] = (0.0 if by_load else value) - gap
            else:
                target, at = float(value) if by_load else 0.0, None
                if points:
                    ahead = (
                        (value - found[CARRIED, j - 1]) / found[STIFFNESS, j - 1] if by_load else value - x
                    )
                    z = np.empty_like(gap)
                    start = predict(memory, points, x + float(ahead), target, law, z)
                    at, new = self.newton(z, start, target)
                if at is None or at.residual > TOLERANCE:
                    start = float(uniform_approach(gap, law, target) if by_load else value)
                    at, new = self.newton(start - gap, start, target)
                last, further, x, stiffness = at.state, new > x, new, 0.0
                residual = max(at.residual, self.sums.error(last.load) / float(last.indentation.max()))
                spread(self.order, law, last.block)
                points = 0 if residual > TOLERANCE else min(REMEMBERED, points + 1) if further else 1
                if points:
                    remember(memory, x, last.z)
                    stiffness, share = self.tangent(at, share)
                    if stiffness == math.inf:  # not a minimum of the energy
                        residual, points = 1.0, 0
                load, area = exact_sum(last.load), math.pi * exact_sum(last.footprint)
                found[:, j] = x, load, area, stiffness, residual, math.sqrt(float(last.square.max()))
            if indentation.size:
                indentation[j] = last.z
        return last

    def area_gradients(self, indentation: FloatArray) -> FloatArray:
        """Return dA0/dh at fixed load [mm], (k, n), for equilibria with nominal indentations z (k, n)."""
        states = (self.respond(z, 0.0, 0.0) for z in indentation)  # neither approach nor load matters
        none = np.zeros_like(self.gap)
        return np.array([self.area_gradient(at) if at.closed.any() else none for at in states])


def large_scene(surface: Surface, substrate: Radial, order: int) -> tuple[Sums, Preconditioner]:
    """Return the fast sums of a surface, the last of which are cached, and its coarse model."""
    sums = cached(fast_sums, substrate, order, surface, 0, MOST_KEPT_SUMS)
    return sums, coarse_model(surface.position, substrate)
