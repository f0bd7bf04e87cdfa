"""Newton's method for interacting contacts at a load or an approach, and sensitivities; see `coupling`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels import projected_cg
from metafem._kernels.compiled import compiled, inlined
from metafem._kernels.coupling import assemble, copy, energy, measure, respond, spread
from metafem._kernels.vectors import factorise, substitute

# Largest residual of a solution, and residual at which Newton's method stops; it is smaller to allow for
# rounding.
TOLERANCE = 1e-12
GOAL = 3e-13

# Maximum number of Newton steps. Usually 2 are needed along a curve, 3 to 8 from independent contacts, and
# more if steps are shortened.
MAX_STEPS = 60

# Relative residual of the linear solver; with this value two Newton steps still converge quadratically.
INNER = 1e-5

# Maximum number of halvings of a step; smaller steps change the energy by less than rounding.
MAX_CUTS = 30

# If the energy is not convex, because contacts overlap until one of them opens, the compliance of the contact
# law is multiplied by this factor, at most this many times, until the matrix is positive definite.
SOFTER = 4.0
MOST_SOFTENINGS = 20

# Smallest accepted fraction of the predicted decrease of the energy (Armijo's condition).
ARMIJO = 1e-4

# Maximum number of bisections of the approach at a load for which Newton's method does not converge.
MAX_BRACKET = 100


class Scratch(NamedTuple):
    """Scratch arrays of one thread."""

    matrix: np.ndarray  # (n, n)
    ready: np.ndarray  # whether each row of the matrix is filled, (n,)
    work: np.ndarray  # (4, n)
    loads: np.ndarray  # step of the loads (n,)
    step: np.ndarray  # step of z
    rhs: np.ndarray
    diagonal: np.ndarray
    start: np.ndarray  # z before the step
    safe: np.ndarray  # z before a search


def empty_scratch(count: int, order: int) -> Scratch:
    """Return the scratch arrays for `count` asperities."""
    size = 0 if order == 1 else count
    rows = [np.zeros(count) for _ in range(6)]
    return Scratch(np.zeros((size, size)), np.zeros(count, np.bool_), projected_cg.empty_work(count), *rows)


@compiled
def refresh(field, order, self_term, state, count, scratch, always):
    """Fill the diagonal, and the matrix if it is always needed or a row is missing; return the matrix."""
    for k in range(count):
        i = state.closed[k]
        scratch.diagonal[i] = self_term[i] + state.bend[i] / state.rate[i]
        if order > 1 and state.lever_bend[i] != 0.0:
            slope = state.slope_x[i] * state.slope_x[i] + state.slope_y[i] * state.slope_y[i]
            scratch.diagonal[i] -= 0.5 * state.lever_bend[i] * slope
        always = always or not scratch.ready[i]
    if order == 1:
        return field.influence
    if always:
        assemble(field, state, count, scratch.matrix)
        scratch.ready[:] = False
        for k in range(count):
            scratch.ready[state.closed[k]] = True
    return scratch.matrix


@compiled
def rates(state, count, shift, scratch, out):
    """Fill the change of z of all asperities (n,) that belongs to the last solution of the linear system."""
    for i in range(out.size):
        out[i] = scratch.work[0, i] + shift
    for k in range(count):
        i = state.closed[k]
        out[i] = (out[i] + state.bend[i] / state.rate[i] * scratch.loads[i]) / state.bend[i]


@compiled
def newton(field, order, law, self_term, gap, approach, target, state, scratch):
    """Solve for an equilibrium at the approach or, if `target` > 0, at this load, starting from state.z.

    Return the approach, the number of contacts, the load, the residual and the number of steps.
    """
    free = target > 0.0
    x, steps = approach, 0
    count = respond(field, order, law, self_term, state)
    residual, load = measure(order, gap, x, target, state, count)
    always = True
    for _ in range(MAX_STEPS):
        if residual <= GOAL:
            break
        if count == 0:  # no contact to linearise: close all asperities that overlap the plane
            for i in range(gap.size):
                state.z[i] = x - gap[i]
            count = respond(field, order, law, self_term, state)
            residual, load = measure(order, gap, x, target, state, count)
            if count == 0:
                break
        steps += 1
        matrix = refresh(field, order, self_term, state, count, scratch, always)
        largest = 0.0
        for i in range(gap.size):
            scratch.rhs[i] = (x - gap[i]) - state.indentation[i] - state.displacement[i]
            largest = max(largest, state.indentation[i])
        leave = largest * max(INNER * min(residual, 1.0), 0.1 * GOAL)
        shift, good = projected_cg.solve(
            matrix, scratch.diagonal, state.closed, count, free, target - load, scratch.rhs,
            leave, False, scratch.loads, scratch.work,
        )  # fmt: skip
        if order == 1 and not (good or free):  # a non-convex energy of order 3 has no minimum
            shift, good = downhill(self_term, matrix, state, count, leave, scratch)
        if not good:
            residual = max(residual, 1.0)
            break
        rates(state, count, shift, scratch, scratch.step)
        x, count, load, new, full = line_search(
            field, order, law, self_term, gap, x, shift, target, residual, count, state, scratch
        )
        # the matrix is reused while each full step gains two digits
        always = not full or new > 1e-2 * residual
        stalled = new > 0.5 * residual and (new <= TOLERANCE or (free and not full))
        residual = new
        if stalled:
            break
    for i in range(gap.size):  # set z of open asperities to minus their gap, as predictions need
        if state.z[i] <= 0.0:
            state.z[i] = min(x - gap[i] - state.displacement[i], 0.0)
            state.indentation[i] = state.z[i]
    return x, count, load, residual, steps


@inlined
def downhill(self_term, matrix, state, count, leave, scratch):
    """Solve for a step at fixed approach, with softer contacts that make the matrix positive definite.

    Return the change of the approach, 0, and whether the step was found.
    """
    raised = 1.0
    shift, good = 0.0, False
    for k in range(count):
        if scratch.diagonal[state.closed[k]] <= 0.0:  # possible on a thin layer: no minimum exists
            return shift, good
    for _ in range(MOST_SOFTENINGS):
        raised *= SOFTER
        for k in range(count):
            i = state.closed[k]
            scratch.diagonal[i] = self_term[i] + SOFTER * (scratch.diagonal[i] - self_term[i])
        shift, good = projected_cg.solve(
            matrix, scratch.diagonal, state.closed, count, False, 0.0, scratch.rhs,
            leave, False, scratch.loads, scratch.work,
        )  # fmt: skip
        if good:
            break
    for k in range(count):
        i = state.closed[k]
        scratch.diagonal[i] = self_term[i] + (scratch.diagonal[i] - self_term[i]) / raised
    return shift, good


@inlined
def line_search(field, order, law, self_term, gap, approach, shift, target, residual, count, state, scratch):
    """Move z by the full step, halved until the energy or the residual decreases enough.

    Return the approach, the number of contacts, the load, the residual, and whether the step is full. At a
    fixed load only the residual is used, because intermediate points do not have this load.
    """
    free = target > 0.0
    before = slope = 0.0
    copy(state.z, scratch.start)
    if not free:
        before = energy(order, law, gap, approach, state, count)
        for k in range(count):
            i = state.closed[k]
            slope -= scratch.rhs[i] * scratch.loads[i]
    length = 1.0
    for _ in range(MAX_CUTS):
        for i in range(gap.size):
            state.z[i] = scratch.start[i] + length * scratch.step[i]
        x = approach + length * shift
        count = respond(field, order, law, self_term, state)
        new, load = measure(order, gap, x, target, state, count)
        if new <= (1.0 - 0.5 * length) * residual or new <= TOLERANCE:
            break
        if not free:
            now = energy(order, law, gap, x, state, count)
            if now <= before + ARMIJO * length * slope and now < before:
                break
        length *= 0.5
    return x, count, load, new, length == 1.0


@inlined
def settle(field, order, law, self_term, gap, approach, target, state, scratch):
    """Solve by Newton's method at the load `target` or, if this is 0, at the approach.

    If Newton's method does not converge at the load, equilibria at fixed approaches bracket the solution,
    because the load increases with the approach and the energy at fixed approach is convex. Bisection
    continues until Newton's method converges at the load. Return the same values as `newton`.
    """
    copy(state.z, scratch.safe)
    low, high = 0.0, math.inf
    x = following = approach
    goal = target
    steps = 0
    for _ in range(2 * MAX_BRACKET + 1):
        end, count, load, residual, more = newton(field, order, law, self_term, gap, x, goal, state, scratch)
        steps += more
        if target == 0.0 or (goal > 0.0) == (residual <= TOLERANCE):
            break  # converged at the load, or failed at the approach
        if goal > 0.0:
            copy(scratch.safe, state.z)
            x, goal = following, 0.0
        else:
            if load < target:
                low = x
            else:
                high = x
            copy(state.z, scratch.safe)
            following = 2.0 * max(low, x) if high == math.inf else 0.5 * (low + high)
            goal = target
    return end, count, load, residual, steps


@compiled
def area_gradients(field, order, law, self_term, indentation, state, matrix, scratch, gradient):
    """Fill dA0/dh (k, n) for equilibria with nominal indentations (k, n); return the number of filled rows.

    See `models.interacting.sensitivity` for the equations. The loop ends at the first equilibrium whose
    matrix is not positive definite. matrix: (n, n), scratch: (6, n).
    """
    by_area, by_approach = scratch[3], scratch[4]
    for row in range(indentation.shape[0]):
        copy(indentation[row], state.z)
        count = respond(field, order, law, self_term, state)
        spread(order, law, state)
        hessian(field, order, self_term, state, count, matrix, scratch)
        if not factorise(matrix, count, scratch[5]):
            return row
        substitute(matrix, count, by_area)
        substitute(matrix, count, by_approach)
        total = whole = 0.0
        for k in range(count):
            total += by_area[k]
            whole += by_approach[k]
        for k in range(count):
            gradient[row, state.closed[k]] = by_area[k] - total / whole * by_approach[k]
    return indentation.shape[0]


@compiled
def hessian(field, order, self_term, state, count, matrix, scratch):
    """Fill the lower triangle of d2W/dp2 for the asperities in contact, and dA0/dp and ones in scratch."""
    lap, gx, gy, by_area, by_approach = scratch[0], scratch[1], scratch[2], scratch[3], scratch[4]
    closed = state.closed
    for k in range(count):
        i = closed[k]
        point = field.influence[i]
        for m in range(k + 1):
            matrix[k, m] = point[closed[m]]
        matrix[k, k] += state.bend[i] / state.rate[i] + self_term[i]
        by_area[k] = math.pi * state.by_load[i]
        by_approach[k] = 1.0
    if order == 1:
        return
    for k in range(count):
        i = closed[k]
        square, lever, slope_x, slope_y = state.square[i], state.lever[i], state.slope_x[i], state.slope_y[i]
        curved = 2.0 / 45.0 * square * square * math.sqrt(square)
        bend, tilt = square / 6.0, -state.lever_rate[i]
        narrowing, sloping = 0.5 * math.pi * state.by_curvature[i], 2.0 * math.pi * state.by_slope[i]
        # curvature and slopes at this contact due to the load of each contact
        for m in range(count):
            j = closed[m]
            lap[m], gx[m], gy[m] = field.laplacian[i, j], field.slope_x[i, j], field.slope_y[i, j]
            by_area[m] += narrowing * lap[m]
            if sloping != 0.0:
                by_area[m] += sloping * (slope_x * gx[m] + slope_y * gy[m])
        for m in range(count):
            mixed = bend * lap[m] + tilt * (slope_x * gx[m] + slope_y * gy[m])
            if m <= k:
                matrix[k, m] += mixed
            if m >= k:
                matrix[m, k] += mixed
        matrix[k, k] -= 0.5 * state.lever_bend[i] * (slope_x * slope_x + slope_y * slope_y)
        for m in range(count):
            line, a, b, c = matrix[m], curved * lap[m], lever * gx[m], lever * gy[m]
            for j in range(m + 1):
                line[j] -= a * lap[j] + (b * gx[j] + c * gy[j])
