"""Newton's method for coupled contacts at a load or an approach; `equations` states the equations.

A step solves ``A y - s 1 = b`` for the changes y of the loads and, if the total load is given, the change s
of the approach with ``sum y = total``, by conjugate gradients. The preconditioner consists of the diagonal
and the constraint (Gould, Hribar and Nocedal, SIAM J. Sci. Comput. 23, 1376 (2001),
doi:10.1137/S1064827598345667). The projection removes the stiff long-wave modes, which only change the
approach.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels.compiled import compiled, inlined
from metafem._kernels.equations import add_rows, assemble, copy, energy, measure, respond
from metafem._kernels.vectors import dot, largest, total_of

# Largest residual of a solution at which a state is returned, and at the other points of a curve: one step
# from the prediction usually reaches the latter, because the matrix omits 1e-4 of its terms.
TOLERANCE = 1e-12
ON_CURVE = 1e-8

# Residual of order 1 from which order 3 starts: their solutions differ by a percent.
START = 1e-2

# Maximum number of Newton steps. Usually 1 or 2 are needed along a curve, 3 to 8 from independent contacts,
# and more if steps are shortened.
MAX_STEPS = 60

# Relative residual of the linear solver, about the relative size of the terms that the matrix omits; and
# maximum number of its steps. The next Newton step corrects an inexact solution.
INNER = 1e-5
MAX_INNER = 400

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
    """Scratch arrays of one thread, (n,) unless stated."""

    matrix: np.ndarray  # (n, n); empty for order 1
    ready: np.ndarray  # 1 if a row of the matrix is filled, else 0
    loads: np.ndarray  # step of the loads
    step: np.ndarray  # step of z
    rhs: np.ndarray
    diagonal: np.ndarray
    start: np.ndarray  # z before the step
    safe: np.ndarray  # z before a search
    rest: np.ndarray  # residual of the linear system, of open asperities too
    inverse: np.ndarray  # preconditioner, 0 for open asperities
    ahead: np.ndarray  # search direction
    image: np.ndarray  # of the search direction


@inlined
def scratch_in(block, matrix):
    """Return the scratch arrays in the first rows of a block (rows, n)."""
    return Scratch(
        matrix, block[0], block[1], block[2], block[3], block[4], block[5], block[6], block[7], block[8],
        block[9], block[10],
    )  # fmt: skip


@compiled
def solve(matrix, closed, count, total, free, leave, warm, scratch):
    """Fill y = scratch.loads, the changes of the loads; return the change of the approach, and success.

    matrix: rows of A for the contacts, without `scratch.diagonal`; A must be positive. free: whether the sum
    of y is `total`; otherwise the approach does not change. warm: whether y is a guess with this sum.
    Afterwards ``scratch.rest = scratch.rhs - A y`` for all asperities; with the change of the approach, its
    mean square over the contacts, weighted by the preconditioner, is within that of `leave`.
    """
    rest, inverse, ahead, image = scratch.rest, scratch.inverse, scratch.ahead, scratch.image
    diagonal, y, n = scratch.diagonal, scratch.loads, scratch.loads.size
    for i in range(n):
        image[i] = ahead[i] = 0.0
        rest[i] = scratch.rhs[i]
    least = math.inf
    for k in range(count):
        i = closed[k]
        image[i] = diagonal[i] + matrix[i, i]
        least = min(least, image[i])
    if least <= 0.0:
        return 0.0, False
    for i in range(n):
        inverse[i] = 1.0 / image[i] if image[i] > 0.0 else 0.0
    whole = total_of(inverse)
    share = total / whole if free else 0.0
    if not warm:
        for i in range(n):
            y[i] = share * inverse[i]
    if warm or share != 0.0:
        apply(matrix, diagonal, closed, count, y, image)
        for i in range(n):
            rest[i] -= image[i]
    before, shift = math.inf, 0.0
    for step in range(MAX_INNER + 1):
        if free:
            shift = dot(inverse, rest) / whole
        for i in range(n):
            image[i] = inverse[i] * (rest[i] - shift)
        product = dot(image, rest)  # that with the shift, because the sum of `image` is zero
        if product <= leave * leave * whole or step == MAX_INNER:
            break
        ratio = product / before
        before = product
        for i in range(n):
            ahead[i] = image[i] + ratio * ahead[i]
        apply(matrix, diagonal, closed, count, ahead, image)
        bend = dot(ahead, image)
        if bend <= 0.0:
            return -shift, False
        length = product / bend
        for i in range(n):
            y[i] += length * ahead[i]
            rest[i] -= length * image[i]
    return -shift, True


@inlined
def apply(matrix, diagonal, closed, count, y, image):
    """Fill A y for all asperities; y is 0 for open ones."""
    for i in range(y.size):
        image[i] = diagonal[i] * y[i]
    add_rows(matrix, closed, count, y, image)


@inlined
def refresh(field, order, self_term, state, count, scratch, always):
    """Fill the diagonal, and the matrix if it is always needed or a row is missing; return the matrix."""
    for i in range(self_term.size):
        own = self_term[i] + state.bend[i] / state.rate[i]
        scratch.diagonal[i] = own if state.z[i] > 0.0 else 0.0
    if order == 1:
        return field.source
    for i in range(self_term.size):
        slope = state.slope_x[i] * state.slope_x[i] + state.slope_y[i] * state.slope_y[i]
        scratch.diagonal[i] -= 0.5 * state.lever_bend[i] * slope if state.z[i] > 0.0 else 0.0
    missing = 0
    for k in range(count):
        missing += 1 if scratch.ready[state.closed[k]] == 0.0 else 0
    if always or missing > 0:
        assemble(field, state, count, scratch.matrix)
        for i in range(self_term.size):
            scratch.ready[i] = 1.0 if state.z[i] > 0.0 else 0.0
    return scratch.matrix


@inlined
def rates(state, shift, scratch, out):
    """Fill the change of z of all asperities (n,) that belongs to the last solution of the linear system."""
    for i in range(out.size):
        change = scratch.rest[i] + shift
        bent = (change + state.bend[i] / state.rate[i] * scratch.loads[i]) / state.bend[i]
        out[i] = bent if state.z[i] > 0.0 else change


@inlined
def newton(field, order, law, self_term, gap, approach, target, tolerance, state, scratch):
    """Solve for an equilibrium at the approach or, if `target` > 0, at this load, starting from state.z.

    A step is halved until the energy or the residual decreases enough; at a fixed load only the residual is
    used, because intermediate points do not have this load. Return the approach, the number of contacts, the
    load, the residual and the number of steps.
    """
    free = target > 0.0
    goal = max(0.3 * TOLERANCE, (tolerance - TOLERANCE))  # a state: below rounding on other processors, too
    x = origin = approach
    residual, length, shift, before, slope = math.inf, 0.0, 0.0, 0.0, 0.0
    steps = cuts = 0
    always = lifted = False
    while True:
        count = respond(field, order, law, self_term, state)
        new, load = measure(gap, x, target, state, count)
        now = 0.0 if free else energy(order, law, gap, x, state, count)
        stalled = False
        if length > 0.0:
            falls = not free and now < before and now <= before + ARMIJO * length * slope
            if not (falls or new <= (1.0 - 0.5 * length) * residual or new <= TOLERANCE) and cuts < MAX_CUTS:
                cuts += 1
                length *= 0.5
                for i in range(gap.size):
                    state.z[i] = scratch.start[i] + length * scratch.step[i]
                x = origin + length * shift
                continue
            # the matrix is reused while each full step gains two digits
            always = length < 1.0 or new > 1e-2 * residual
            stalled = new > 0.5 * residual and (new <= tolerance or (free and length < 1.0))
        residual = new
        if residual <= goal or stalled or steps == MAX_STEPS or (count == 0 and lifted):
            break
        if count == 0:  # no contact to linearise: close all asperities that overlap the plane
            lifted, length = True, 0.0
            for i in range(gap.size):
                state.z[i] = x - gap[i]
            continue
        steps += 1
        matrix = refresh(field, order, self_term, state, count, scratch, always)
        for i in range(gap.size):
            scratch.rhs[i] = (x - gap[i]) - state.indentation[i] - state.displacement[i]
        leave = largest(state.indentation) * max(INNER * min(residual, 1.0), 0.3 * goal)
        shift, good = solve(matrix, state.closed, count, target - load, free, leave, False, scratch)
        if order == 1 and not (good or free):  # a non-convex energy of order 3 has no minimum
            shift, good = downhill(self_term, matrix, state, count, leave, scratch)
        if not good:
            residual = max(residual, 1.0)
            break
        rates(state, shift, scratch, scratch.step)
        slope = -dot(scratch.rhs, scratch.loads)
        before, origin, length, cuts, lifted = now, x, 1.0, 0, False
        x += shift
        for i in range(gap.size):
            scratch.start[i] = state.z[i]
            state.z[i] += scratch.step[i]
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
        shift, good = solve(matrix, state.closed, count, 0.0, False, leave, False, scratch)
        if good:
            break
    for k in range(count):
        i = state.closed[k]
        scratch.diagonal[i] = self_term[i] + (scratch.diagonal[i] - self_term[i]) / raised
    return shift, good


@inlined
def settle(field, order, law, self_term, gap, approach, target, tolerance, rough, state, scratch):
    """Solve by Newton's method at the load `target` or, if this is 0, at the approach.

    If `rough`, the first steps are those of order 1, which are cheaper. If Newton's method does not converge
    at the load, equilibria at fixed approaches bracket the solution, because the load increases with the
    approach and the energy at fixed approach is convex. Bisection continues until Newton's method converges
    at the load. Return the same values as `newton`.
    """
    copy(state.z, scratch.safe)
    low, high = 0.0, math.inf
    x = following = approach
    goal = target
    steps = 0
    first = rough and order > 1
    for _ in range(2 * MAX_BRACKET + 2):
        end, count, load, residual, more = newton(
            field, 1 if first else order, law, self_term, gap, x, goal, START if first else tolerance, state,
            scratch,
        )  # fmt: skip
        steps += more
        if first:
            first = False
            if residual <= START:
                x = following = end
                copy(state.z, scratch.safe)
            else:
                copy(scratch.safe, state.z)
            continue
        if target == 0.0 or (goal > 0.0) == (residual <= tolerance):
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
