"""Newton's method for coupled contacts at a load or an approach; `equations` states the equations.

A step solves ``A y - s 1 = b`` for the changes y of the loads and, if the total load is given, the change s
of the approach with ``sum y = total``, by conjugate gradients. The preconditioner consists of the diagonal
and the constraint (Gould, Hribar and Nocedal, SIAM J. Sci. Comput. 23, 1376 (2001),
doi:10.1137/S1064827598345667). The projection removes the stiff long-wave modes, which only change the
approach.
"""

from __future__ import annotations

import math

from metafem._kernels.compiled import compiled, inlined
from metafem._kernels.equations import (
    BEND,
    DISPLACEMENT,
    INDENTATION,
    LEVER_BEND,
    RATE,
    SCRATCH,
    SLOPE_X,
    SLOPE_Y,
    Z,
    add_rows,
    assemble,
    copy,
    energy,
    measure,
    respond,
)
from metafem._kernels.vectors import dot, largest, total_of

# Largest residual of the last solution of a curve, from which a state is returned, and of the others: two
# steps from the prediction usually reach it, because the matrix omits 1e-4 of its terms.
TOLERANCE, ON_CURVE = 1e-12, 1e-10

# Residual of order 1 from which order 3 starts: their solutions differ by a percent.
START = 1e-2

# Maximum number of Newton steps. Usually 1 or 2 are needed along a curve, 3 to 8 from independent contacts,
# and more if steps are shortened.
MAX_STEPS = 60

# Relative residual of the linear solver, about the relative size of the terms that the matrix omits; and
# maximum number of its steps. The next Newton step corrects an inexact solution.
INNER = 1e-4
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


# Rows of the block for the solver: whether a row of the matrix is filled, the steps of loads and z, the
# right-hand side and the diagonal of A, z before a step and before a search, the residual of the linear
# system, the preconditioner (0 for open asperities), the search direction and its image.
READY, STEP_LOADS, STEP, RHS, DIAGONAL, START_Z, SAFE, REST, INVERSE, AHEAD, IMAGE, KEPT = range(
    SCRATCH, SCRATCH + 12
)


@compiled
def solve(matrix, s, closed, count, total, free, leave, warm):
    """Fill y = s[STEP_LOADS], the changes of the loads; return the change of the approach, and success.

    matrix: rows of A for the contacts, without `s[DIAGONAL]`; A must be positive. free: whether the sum
    of y is `total`; otherwise the approach does not change. warm: whether y is a guess with this sum.
    Afterwards ``s[REST] = s[RHS] - A y`` for all asperities; with the change of the approach, its
    mean square over the contacts, weighted by the preconditioner, is within that of `leave`.
    """
    rest, inverse, ahead, image = s[REST], s[INVERSE], s[AHEAD], s[IMAGE]
    diagonal, y, n = s[DIAGONAL], s[STEP_LOADS], s[STEP_LOADS].size
    for i in range(n):
        image[i] = ahead[i] = 0.0
        rest[i] = s[RHS, i]
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


@compiled
def refresh(field, order, self_term, s, closed, count, matrix, always):
    """Fill the diagonal, and the matrix if it is always needed or a row is missing; return the matrix."""
    for i in range(self_term.size):
        own = self_term[i] + s[BEND, i] / s[RATE, i]
        s[DIAGONAL, i] = own if s[Z, i] > 0.0 else 0.0
    if order == 1:
        return field[0]
    for i in range(self_term.size):
        slope = s[SLOPE_X, i] * s[SLOPE_X, i] + s[SLOPE_Y, i] * s[SLOPE_Y, i]
        s[DIAGONAL, i] -= 0.5 * s[LEVER_BEND, i] * slope if s[Z, i] > 0.0 else 0.0
    missing = 0
    for k in range(count):
        missing += 1 if s[READY, closed[k]] == 0.0 else 0
    if always or missing > 0:
        assemble(field, s, closed, count, matrix)
        for i in range(self_term.size):
            s[READY, i] = 1.0 if s[Z, i] > 0.0 else 0.0
    return matrix


@inlined
def rates(s, shift, out):
    """Fill the change of z of all asperities (n,) that belongs to the last solution of the linear system."""
    for i in range(out.size):
        change = s[REST, i] + shift
        bent = (change + s[BEND, i] / s[RATE, i] * s[STEP_LOADS, i]) / s[BEND, i]
        out[i] = bent if s[Z, i] > 0.0 else change


@compiled
def newton(field, order, law, self_term, gap, approach, target, tolerance, s, closed, matrix):
    """Solve for an equilibrium at the approach or, if `target` > 0, at this load, starting from s[Z].

    A step is halved until the energy or the residual decreases enough; at a fixed load only the residual is
    used, because intermediate points do not have this load. Return the approach, the number of contacts, the
    load and the residual.
    """
    free = target > 0.0
    goal = max(0.3 * TOLERANCE, (tolerance - TOLERANCE))  # a state: below rounding on other processors, too
    x = origin = approach
    residual, length, shift, before, slope = math.inf, 0.0, 0.0, 0.0, 0.0
    steps = cuts = 0
    always = lifted = False
    while True:
        count = respond(field, order, law, self_term, s, closed)
        new, load = measure(gap, x, target, s, count)
        now = 0.0 if free else energy(order, law, gap, x, s, closed, count)
        stalled = False
        if length > 0.0:
            falls = not free and now < before and now <= before + ARMIJO * length * slope
            if not (falls or new <= (1.0 - 0.5 * length) * residual or new <= TOLERANCE) and cuts < MAX_CUTS:
                cuts += 1
                length *= 0.5
                for i in range(gap.size):
                    s[Z, i] = s[START_Z, i] + length * s[STEP, i]
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
                s[Z, i] = x - gap[i]
            continue
        steps += 1
        used = refresh(field, order, self_term, s, closed, count, matrix, always)
        for i in range(gap.size):
            s[RHS, i] = (x - gap[i]) - s[INDENTATION, i] - s[DISPLACEMENT, i]
        leave = largest(s[INDENTATION]) * max(INNER * min(residual, 1.0), 0.3 * goal)
        shift, good = solve(used, s, closed, count, target - load, free, leave, False)
        if order == 1 and not (good or free):  # a non-convex energy of order 3 has no minimum
            shift, good = downhill(self_term, used, s, closed, count, leave)
        if not good:
            residual = max(residual, 1.0)
            break
        rates(s, shift, s[STEP])
        slope = -dot(s[RHS], s[STEP_LOADS])
        before, origin, length, cuts, lifted = now, x, 1.0, 0, False
        x += shift
        for i in range(gap.size):
            s[START_Z, i] = s[Z, i]
            s[Z, i] += s[STEP, i]
    for i in range(gap.size):  # set z of open asperities to minus their gap, as predictions need
        if s[Z, i] <= 0.0:
            s[Z, i] = min(x - gap[i] - s[DISPLACEMENT, i], 0.0)
            s[INDENTATION, i] = s[Z, i]
    return x, count, load, residual


@inlined
def downhill(self_term, matrix, s, closed, count, leave):
    """Solve for a step at fixed approach, with softer contacts that make the matrix positive definite.

    Return the change of the approach, 0, and whether the step was found.
    """
    raised = 1.0
    shift, good = 0.0, False
    for k in range(count):
        if s[DIAGONAL, closed[k]] <= 0.0:  # possible on a thin layer: no minimum exists
            return shift, good
    for _ in range(MOST_SOFTENINGS):
        raised *= SOFTER
        for k in range(count):
            i = closed[k]
            s[DIAGONAL, i] = self_term[i] + SOFTER * (s[DIAGONAL, i] - self_term[i])
        shift, good = solve(matrix, s, closed, count, 0.0, False, leave, False)
        if good:
            break
    for k in range(count):
        i = closed[k]
        s[DIAGONAL, i] = self_term[i] + (s[DIAGONAL, i] - self_term[i]) / raised
    return shift, good


@compiled
def settle(field, order, law, self_term, gap, approach, target, tolerance, rough, s, closed, matrix):
    """Solve by Newton's method at the load `target` or, if this is 0, at the approach.

    If `rough`, the first steps are those of order 1, which are cheaper. If Newton's method does not converge
    at the load, equilibria at fixed approaches bracket the solution, because the load increases with the
    approach and the energy at fixed approach is convex. Bisection continues until Newton's method converges
    at the load. Return the same values as `newton`.
    """
    copy(s[Z], s[SAFE])
    low, high = 0.0, math.inf
    x = following = approach
    goal = target
    first = rough and order > 1
    for _ in range(2 * MAX_BRACKET + 2):
        stage, limit = (1, START) if first else (order, tolerance)
        end, count, load, residual = newton(
            field, stage, law, self_term, gap, x, goal, limit, s, closed, matrix
        )
        if first:
            first = False
            if residual <= START:
                x = following = end
                copy(s[Z], s[SAFE])
            else:
                copy(s[SAFE], s[Z])
            continue
        if target == 0.0 or (goal > 0.0) == (residual <= tolerance):
            break  # converged at the load, or failed at the approach
        if goal > 0.0:
            copy(s[SAFE], s[Z])
            x, goal = following, 0.0
        else:
            if load < target:
                low = x
            else:
                high = x
            copy(s[Z], s[SAFE])
            following = 2.0 * max(low, x) if high == math.inf else 0.5 * (low + high)
            goal = target
    return end, count, load, residual
