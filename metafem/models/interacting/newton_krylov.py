"""Newton-Krylov method for many interacting contacts; `metafem._kernels.coupling` states the equations."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._kernels.contact.tabulated import Law
from metafem._kernels.continuation import Results, empty_memory, predict, uniform_approach
from metafem._kernels.coupling import State, empty_state, press, sharpen, spread
from metafem._kernels.vectors import exact_sum
from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.models.interacting.coarse import Coarse
from metafem.models.interacting.influence import MOST_KEPT_SUMS, Sites
from metafem.models.interacting.scattered import fast_sums
from metafem.models.interacting.sums import Sums
from metafem.progress import each
from metafem.substrate import Radial
from metafem.surface import Surface

# Largest residual of a converged state, and residual at which Newton's method stops. They allow for the
# errors of fast sums.
TOLERANCE, GOAL = 1e-9, 3e-10

# Maximum number of Newton steps (about 6 are needed from independent contacts), of halvings of a step, and of
# conjugate-gradient steps. A state that is not converged has a residual above the tolerance.
MAX_STEPS, MAX_CUTS, MAX_INNER = 60, 20, 300

# Largest residuals of linear equations, relative to their solution: of the first step of Newton's method, of
# the tangent, whose stiffness has twice as many digits, and of the sensitivities.
LOOSEST, TANGENT, SENSITIVITY = 0.1, 1e-4, 1e-9

# Residual of the coarse model at which a start is good enough.
START = 0.01

# Empty array that is passed for results that are not recorded.
NOT_RECORDED = np.empty((0, 0))


@dataclass
class Iterate:
    """The contacts at some nominal indentations, with the errors of their equations."""

    state: State
    residual: float = math.inf
    error: FloatArray = field(default_factory=lambda: np.empty(0))
    steps: int = 0  # of Newton's method
    precondition: Callable[[FloatArray], FloatArray] | None = None  # set by the first linear solution
    uniform: FloatArray = field(default_factory=lambda: np.empty(0))  # loads of a uniform displacement

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

    sums: Sums
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
            loads, shift, rest, _ = self.solve(state, -state.error, missing, goal)
            step = np.where(state.closed, state.compliance * loads, rest + shift) / state.state.bend
            length = 1.0
            for _ in range(MAX_CUTS):
                new = self.respond(state.state.z + length * step, approach + length * shift, target)
                if new.residual <= (1.0 - 0.25 * length) * state.residual or new.residual <= GOAL:
                    break
                length *= 0.5
            if new.residual >= state.residual:
                break
            # proportional to the square of the last reduction: choice 2 of Eisenstat and Walker, SIAM J. Sci.
            # Comput. 17, 16 (1996), doi:10.1137/0917003
            forcing = min(LOOSEST, max(0.9 * (new.residual / state.residual) ** 2, 1e-3))
            state, approach = new, approach + length * shift
            state.steps = taken + 1
        return state, approach

    def diagonal(self, state: Iterate) -> FloatArray:
        """Return the diagonal of the Jacobian dF/dp, (n,) [1/mm]; 0 for open asperities."""
        return np.asarray(np.where(state.closed, state.compliance + self.self_term, 0.0))

    def tangent(self, state: Iterate, before: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        """Return dP/dx [mm], dz/dx (n,) and dp/dP (n,) at an equilibrium; dP/dx is infinite without success.

        ``H y = x 1`` is solved for the loads y with a sum of 1, from those of the state before.
        """
        start = np.where(state.closed, before, 0.0)
        total = float(start.sum())
        uniform, diagonal = self.prepared(state)[1], self.diagonal(state)
        # the energy of the error relative to that of the tangent is at most the square of the residual,
        # divided by the compliances of independent contacts in parallel and of the scene
        alone = 1.0 / float((1.0 / diagonal[state.closed]).sum())
        goal = TANGENT * math.sqrt(alone / float(uniform.sum()))
        start = start / total if total > 0.5 else uniform / float(uniform.sum())
        share, shift, rest, good = self.solve(state, np.zeros_like(start), 0.0, goal, True, start)
        stiffness = -1.0 / float(share @ rest) if good else math.inf
        return stiffness, (rest + shift + state.compliance * share) / state.state.bend / shift, share

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
        change, _, _, good = self.solve(state, by_load, 0.0, SENSITIVITY * float(by_load.max()), exact=True)
        if not good:
            raise NotConverged(
                f"the derivatives of A0 by the heights are not converged after {MAX_INNER} steps of conjugate "
                "gradients; the contacts may overlap"
            )
        return change

    def jacobian(self, state: Iterate, loads: FloatArray, exact: bool) -> FloatArray:
        """Return dF/dp times a change of the loads, (n,), without the diagonal of the law and self terms.

        If not exact, it is that of order 1.
        """
        if self.order == 1 or not exact:
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

    def prepared(self, state: Iterate) -> tuple[Callable[[FloatArray], FloatArray], FloatArray]:
        """Return the preconditioner, and its loads for a uniform displacement (n,)."""
        if state.precondition is None:
            closed, diagonal = state.closed, self.diagonal(state)
            inverse = np.divide(1.0, diagonal, out=np.zeros_like(diagonal), where=closed)
            state.precondition = self.coarse.preconditioner(inverse)
            state.uniform = state.precondition(closed.astype(np.float64))
        return state.precondition, state.uniform

    def solve(
        self,
        state: Iterate,
        rhs: FloatArray,
        total: float | None,
        goal: float,
        exact: bool = False,
        start: FloatArray | None = None,
    ) -> tuple[FloatArray, float, FloatArray, bool]:
        """Return changes of loads (n,) and approach for the linearised equations, the residual (n,), and
        whether it reaches the goal.

        If `total` is not None, it is the sum of the changes of the loads beyond those of the start.
        Preconditioned conjugate gradients are used, with the constraint in the preconditioner as in
        `metafem._kernels.projected_cg`. The residual includes the rows of open asperities.
        """
        closed, diagonal = state.closed, self.diagonal(state)
        precondition, uniform = self.prepared(state)
        uniform_load = float(uniform.sum())
        loads, shift, rest = np.zeros_like(rhs), 0.0, rhs.copy()
        if start is not None:
            loads = start
        elif total:
            loads = uniform * (total / uniform_load)
        if loads.any():
            rest -= self.jacobian(state, loads, exact) + diagonal * loads
        direction, before = np.zeros_like(rhs), 0.0
        for _ in range(MAX_INNER):
            # without the constant part, to avoid rounding errors
            inside = np.where(closed, rest + shift, 0.0)
            ahead = precondition(inside)
            if total is not None:
                more = -float(ahead.sum()) / uniform_load
                shift, ahead = shift + more, ahead + more * uniform
                inside[closed] += more
            if float(np.abs(inside).max()) <= goal:
                # if not exact, one more correction, for which no product is needed
                return loads if exact else loads + ahead, shift, rest, True
            product = float(inside @ ahead)
            direction = ahead + (product / before if before > 0.0 else 0.0) * direction
            before = product
            change = self.jacobian(state, direction, exact) + diagonal * direction
            length = product / float(direction @ change)
            if not length > 0.0:
                break
            loads = loads + length * direction
            rest -= length * change
        return loads, shift, rest, False


def large_scene(surface: Surface, substrate: Radial, order: int) -> LargeScene:
    """Return the fast sums and the coarse model for the sites of a surface; the last ones are cached."""
    if surface.count > MOST_KEPT_SUMS or not isinstance(substrate, Hashable):
        return LargeScene(surface, substrate, order)
    return _last(Sites.of(surface), substrate, order)


@lru_cache(maxsize=1)
def _last(sites: Sites, substrate: Radial, order: int) -> LargeScene:
    """Return the cached sums of the last scene."""
    return LargeScene(sites.surface, substrate, order)


class LargeScene:
    """Fast sums and a coarse model for the sites of one surface; they do not depend on the heights."""

    def __init__(self, surface: Surface, substrate: Radial, order: int) -> None:
        self.order, self.substrate = order, substrate
        self.sums = fast_sums(surface, substrate, order)
        self.coarse = Coarse(surface.position, substrate)

    def equations(self, law: Law, self_term: FloatArray, gap: FloatArray) -> ContactEquations:
        """Return the equations of the contacts; self_term (n,) [1/mm] is added to that of the substrate."""
        own = self_term + self.sums.self_influence
        return ContactEquations(self.sums, self.order, law, own, np.ascontiguousarray(gap), self.coarse)

    def follow(
        self,
        law: Law,
        self_term: FloatArray,
        gap: FloatArray,
        control: FloatArray,
        by_load: bool,
        results: Results,
        indentation: FloatArray = NOT_RECORDED,
    ) -> State:
        """Fill the results (k,) at increasing loads or approaches, and return the last state.

        indentation: (k, n) [mm]; filled with nominal indentations unless empty.
        """
        equations = self.equations(law, self_term, gap)
        sums: Any = self.coarse  # order 1 needs only its displacements
        coarse = replace(equations, sums=sums, order=1)
        gap = equations.gap
        x = width = 0.0
        memory, points, share = empty_memory(len(gap)), 0, np.zeros_like(gap)
        state = open_state(-gap)
        for j, value in enumerate(each("load", control.tolist())):
            results.approach[j] = 0.0 if by_load else value
            if value <= 0.0:
                state = open_state(min(float(results.approach[j]), 0.0) - gap)
            else:
                target = float(value) if by_load else 0.0
                if points:
                    stiffness = results.stiffness[j - 1]
                    ahead = (target - results.load[j - 1]) / stiffness if by_load else value - x
                    z = np.empty_like(gap)
                    ahead = predict(memory, points, width, float(ahead), target, law, z)
                    state, new = equations.newton(z, x + ahead, target)
                if not points or state.residual > TOLERANCE:
                    start = float(uniform_approach(gap, law, target) if by_load else value)
                    first, start = coarse.newton(start - gap, start, target, START)
                    state, new = equations.newton(first.state.z, start, target)
                largest = float(state.state.indentation.max())
                state.residual = max(state.residual, self.sums.error(state.state.load) / largest)
                width, x = new - x, new
                spread(self.order, law, state.state)
                self._record(results, j, x, state)
                if state.residual <= TOLERANCE:
                    points = min(2, points + 1) if width > 0.0 else 1
                    memory.before[:], memory.before_rate[:] = memory.last, memory.last_rate
                    memory.last[:] = state.state.z
                    results.stiffness[j], memory.last_rate[:], share = equations.tangent(state, share)
                    if results.stiffness[j] == math.inf:  # not a minimum of the energy
                        results.residual[j], points = 1.0, 0
                else:
                    points = 0
            if indentation.size:
                indentation[j] = state.state.z
        return state.state

    def area_gradients(
        self,
        law: Law,
        self_term: FloatArray,
        gap: FloatArray,
        indentation: FloatArray,
    ) -> FloatArray:
        """Return dA0/dh at fixed load [mm], (k, n), for equilibria with nominal indentations z (k, n)."""
        equations = self.equations(law, self_term, gap)
        states = (equations.respond(z, 0.0, 0.0) for z in indentation)  # neither approach nor load matters
        none = np.zeros_like(gap)
        return np.array([equations.area_gradient(at) if at.closed.any() else none for at in states])

    @staticmethod
    def _record(results: Results, j: int, approach: float, state: Iterate) -> None:
        results.approach[j] = approach
        results.load[j] = exact_sum(state.state.load)
        results.area[j] = math.pi * exact_sum(state.state.footprint)
        results.radius[j] = math.sqrt(float(state.state.square.max()))
        results.residual[j] = state.residual
        results.steps[j] = state.steps
