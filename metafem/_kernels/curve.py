"""Curves of coupled contacts; each equilibrium is predicted from the previous ones.

Each nominal indentation z is nearly linear in the approach x, and exactly linear without interaction. The
prediction is the parabola through the last three equilibria.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels import law as contact
from metafem._kernels.compiled import compiled, inlined
from metafem._kernels.equations import FOOTPRINT, INDENTATION, LOAD, SQUARE, Z, copy, linearise, spread
from metafem._kernels.newton import (
    DIAGONAL,
    IMAGE,
    KEPT,
    ON_CURVE,
    READY,
    RHS,
    STEP_LOADS,
    TOLERANCE,
    refresh,
    settle,
    solve,
)
from metafem._kernels.vectors import largest, total_of

# Relative residual of the tangent. The stiffness is stationary at the tangent and has twice as many correct
# digits.
TANGENT = 1e-4

# Number of equilibria of which a prediction is made, and largest distance beyond the last of them, divided by
# the distance of the last two, at which more than two are used.
REMEMBERED = 3
REACH = 3.0

# Maximum number of Newton steps for the approach of a prediction.
PREDICTOR_STEPS = 2


# Rows of the results of equilibria, (6, k) for one surface: the approach [mm], the load P/E* [mm^2], the area
# [mm^2], dP/dx [mm], the residual, and the radius of the largest contact [mm].
APPROACH, CARRIED, AREA, STIFFNESS, RESIDUAL, RADIUS = range(6)

# The memory of a curve is its last equilibria, the latest first: approaches (REMEMBERED,), z (REMEMBERED, n).


def empty_memory(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return an empty memory for `count` asperities."""
    return np.zeros(REMEMBERED), np.zeros((REMEMBERED, count))


@inlined
def load_and_rate(law, i, z):
    """Return the load of asperity i at a nominal indentation z > 0 and its derivative."""
    if law.data.size == 0:
        a = contact.contact_radius(law.radius[i], z)
        return contact.LOAD * a * z, contact.STIFFNESS * a
    return contact.load_and_rate(law.data, law.which[i], law.scale[i], z)


@compiled
def uniform_approach(gap, law, load):
    """Return the approach [mm] at which independent asperities carry `load` within 10 %."""
    x = math.inf
    for i in range(gap.size):  # asperity i needs this approach to carry the load by itself: an upper bound
        x = min(x, gap[i] + contact.alone(law, i, load))
    low, high = gap.min(), math.inf
    for _ in range(60):
        p = slope = 0.0
        for i in range(gap.size):
            if x > gap[i]:
                own, rate = load_and_rate(law, i, x - gap[i])
                p += own
                slope += rate
        if 0.9 * load <= p <= 1.01 * load:
            break
        if p < load:
            low = x
        else:
            high = x
        # if the load is convex, Newton's method does not overshoot from the right; a plastic load is concave
        x = x - (p - load) / slope if slope > 0.0 else low
        if not low < x < high:
            x = 0.5 * (low + high)
    return x


@compiled
def remember(memory, x, z):
    """Let an equilibrium become the latest in the memory."""
    at, kept = memory
    for k in range(REMEMBERED - 1, 0, -1):
        at[k] = at[k - 1]
        copy(kept[k - 1], kept[k])
    at[0] = x
    copy(z, kept[0])


@compiled
def extrapolate(memory, points, x, law, z):
    """Fill the z predicted at the approach x from the last `points` equilibria; return load and dP/dx."""
    at, kept = memory
    near = x - at[0]
    bend = turn = 0.0
    if points == REMEMBERED and near <= REACH * (at[0] - at[1]):
        bend = 1.0 / (at[0] - at[2])
    load = slope = 0.0
    first, second = 0.0, 0.0
    if points > 1:
        first, second = 1.0 / (at[0] - at[1]), 1.0 / (at[1] - at[2]) if bend > 0.0 else 0.0
    for i in range(z.size):  # Newton's form of the interpolating polynomial
        rate = 1.0
        if points > 1:
            rate = first * (kept[0, i] - kept[1, i])
            turn = bend * (rate - second * (kept[1, i] - kept[2, i]))
        ahead = x - at[1]
        z[i] = kept[0, i] + near * (rate + ahead * turn)
        if z[i] > 0.0:
            own, own_rate = load_and_rate(law, i, z[i])
            load += own
            slope += own_rate * (rate + (ahead + near) * turn)
    return load, slope


@compiled
def predict(memory, points, x, target, law, z):
    """Fill the predicted z; return the approach: x or, if `target` > 0, that of this load, from x."""
    load, slope = extrapolate(memory, points, x, law, z)
    if target > 0.0:
        for _ in range(PREDICTOR_STEPS):
            if not slope > 0.0 or abs(load - target) <= 1e-4 * target:  # below the error of the prediction
                break
            x = max(memory[0][0], x - (load - target) / slope)
            load, slope = extrapolate(memory, points, x, law, z)
    return x


@inlined
def tangent(field, order, self_term, s, closed, count, warm, matrix):
    """Return dP/dx [mm], or infinity if unstable, and leave dp/dP in s[STEP_LOADS]: warm, the last one."""
    used = refresh(field, order, self_term, s, closed, count, matrix, False)
    load_rate = s[STEP_LOADS]
    compliance = 0.0
    for i in range(load_rate.size):
        load_rate[i] = load_rate[i] if s[Z, i] > 0.0 else 0.0
        s[RHS, i] = 0.0
    for k in range(count):
        compliance += 1.0 / abs(s[DIAGONAL, closed[k]])
    total = total_of(load_rate)
    warm = warm and total > 0.5
    if warm:
        for i in range(load_rate.size):
            load_rate[i] /= total
    _, good = solve(used, s, closed, count, 1.0, True, TANGENT / compliance, warm)
    form = linearise(field, order, self_term, s, closed, count, load_rate, s[IMAGE])
    return 1.0 / form if good and form > 0.0 else math.inf


@compiled
def curves(field, order, law, self_term, gap, control, by_load, found, s, closed, matrix, all_z):
    """Fill `found` (6, m, k), the results of m surfaces, and `all_z` (k, n), z of the last one, unless empty.

    self_term, gap and the arrays of the law are (m, n); control (k,) has increasing loads or approaches. The
    last equilibrium of a surface is solved to TOLERANCE, the others to ON_CURVE. s: block of `equations`;
    matrix: (n, n), empty for order 1.
    """
    n = gap.shape[1]
    reached = np.zeros(REMEMBERED)
    memory = reached, s[KEPT : KEPT + REMEMBERED]
    load_rate = np.zeros(n)
    for row in range(gap.shape[0]):
        points = 0
        for i in range(n):
            s[READY, i] = 0.0  # each surface has a matrix of its own
        law_of_row = contact.part(law, row)
        for j in range(control.size):
            found[APPROACH, row, j] = 0.0 if by_load else control[j]
            if control[j] <= 0.0:
                for i in range(n):
                    s[Z, i] = min(found[APPROACH, row, j], 0.0) - gap[row, i]
                    s[INDENTATION, i] = s[Z, i]
                    s[LOAD, i] = s[SQUARE, i] = s[FOOTPRINT, i] = 0.0
                if all_z.size > 0:
                    copy(s[Z], all_z[j])
                continue
            target = control[j] if by_load else 0.0
            tolerance = ON_CURVE if j + 1 < control.size else TOLERANCE
            alone = points == 0
            while True:
                if alone:
                    start = uniform_approach(gap[row], law_of_row, target) if by_load else control[j]
                    for i in range(n):
                        s[Z, i] = start - gap[row, i]
                else:
                    x = control[j]
                    if by_load:
                        ahead = (target - found[CARRIED, row, j - 1]) / found[STIFFNESS, row, j - 1]
                        x = reached[0] + ahead
                    start = predict(memory, points, x, target, law_of_row, s[Z])
                new, count, load, residual = settle(
                    field, order, law_of_row, self_term[row], gap[row], start, target, tolerance, alone, s,
                    closed, matrix,
                )  # fmt: skip
                if residual <= tolerance or alone:
                    break
                alone = True  # a prediction can fail if new contacts form
            if all_z.size > 0:
                copy(s[Z], all_z[j])
            found[APPROACH, row, j] = new
            found[CARRIED, row, j] = load
            found[RESIDUAL, row, j] = residual
            found[AREA, row, j], found[RADIUS, row, j] = areas(order, law_of_row, s)
            if residual > tolerance or count == 0:
                points = 0
                continue
            if points > 0 and not new > reached[0]:
                points = 0
            remember(memory, new, s[Z])
            copy(load_rate, s[STEP_LOADS])
            stiffness = tangent(field, order, self_term[row], s, closed, count, points > 0, matrix)
            found[STIFFNESS, row, j] = stiffness
            if stiffness == math.inf:  # the equilibrium is not a minimum of the energy
                found[RESIDUAL, row, j] = 1.0
                points = 0
                continue
            copy(s[STEP_LOADS], load_rate)
            points = min(REMEMBERED, points + 1)


@inlined
def areas(order, law, s):
    """Fill the areas; return their sum [mm^2], and the largest contact radius [mm]."""
    if order > 1 and law.data.size > 0:
        spread(order, law, s)
    else:
        copy(s[SQUARE], s[FOOTPRINT])
    return math.pi * total_of(s[FOOTPRINT]), math.sqrt(largest(s[SQUARE]))
