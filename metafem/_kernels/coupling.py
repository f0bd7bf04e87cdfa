"""Elastic coupling of Hertzian contacts, all in rescaled load p = P/E* [mm^2].

Order 3 is the gradient of one complementary energy of the loads,

    W(p) = sum_i 3/5 p_i d_i + 1/2 p.G p - 1/2 sum_i p_i R_i |g_i|^2 - e.p

with the curvature k_i = 1/R_i + 1/2 sum_j p_j lap_i G_ij, the slope g_i = sum_j p_j grad_i G_ij and
Hertz's d_i = (3 p_i/4)^(2/3) k_i^(1/3). Its derivative by k is the finite size of the sources,
v_j = p_j a_j^2/10, and the derivative of the last term is the shift of the contacts by -R g: the
three corrections belong together, and the Jacobian is symmetric.

The unknown of a contact is z with p = 4/3 sqrt(R) z^(3/2), so that d = z (k R)^(1/3). Where z < 0 the
asperity is open, with the gap -z.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels.compiled import compiled, inner
from metafem._kernels.contact import hertz
from metafem._kernels.vectors import add

# Smallest k R: neighbours that flatten a summit further are outside the range of the expansion.
LEAST_CURVATURE = 0.1


class Coupling(NamedTuple):
    """Influence of the asperities on each other, (n, n), row j for the source j, zero diagonals allowed.

    The plain matrices hold derivatives at the source, those marked `at` derivatives at the asperity
    that is displaced; for order 1 all but `influence` may be empty.
    """

    influence: np.ndarray
    slope_x: np.ndarray
    slope_y: np.ndarray
    laplacian: np.ndarray
    slope_x_at: np.ndarray
    slope_y_at: np.ndarray
    laplacian_at: np.ndarray


class State(NamedTuple):
    """One iterate, arrays (n,)."""

    z: np.ndarray  # nominal indentation [mm]
    load: np.ndarray  # p [mm^2]
    indentation: np.ndarray  # d [mm]
    displacement: np.ndarray  # u at the contact [mm]
    bend: np.ndarray  # (k R)^(1/3)
    square: np.ndarray  # a^2 [mm^2]
    slope_x: np.ndarray
    slope_y: np.ndarray
    curvature: np.ndarray  # sum of p lap G [1/mm], twice what the neighbours add to 1/R
    part: np.ndarray  # scratch
    other: np.ndarray  # scratch
    closed: np.ndarray  # indices of the asperities in contact


def empty_state(count: int) -> State:
    """Return a state of `count` asperities without contact."""
    return State._make([*np.zeros((len(State._fields) - 1, count)), np.zeros(count, dtype=np.int64)])


@compiled
def copy(source, target):
    """Copy an array (n,); assignment to a slice takes seconds to compile."""
    for i in range(target.size):
        target[i] = source[i]


@inner
def add_rows(matrix, closed, count, weight, out):
    """Add sum_j weight[j] matrix[j] over the closed j to `out`."""
    n = out.size
    k = 0
    while k + 4 <= count:
        a, b, c, d = closed[k], closed[k + 1], closed[k + 2], closed[k + 3]
        row_a, row_b, row_c, row_d = matrix[a], matrix[b], matrix[c], matrix[d]
        w_a, w_b, w_c, w_d = weight[a], weight[b], weight[c], weight[d]
        for i in range(n):
            out[i] += (w_a * row_a[i] + w_b * row_b[i]) + (w_c * row_c[i] + w_d * row_d[i])
        k += 4
    while k < count:
        row = matrix[closed[k]]
        w = weight[closed[k]]
        for i in range(n):
            out[i] += w * row[i]
        k += 1


@compiled
def respond(field, order, radius, self_term, state):
    """Fill the state that follows from its z; return the number of contacts."""
    z, load, closed = state.z, state.load, state.closed
    n = z.size
    count = 0
    for i in range(n):
        load[i] = 0.0
        if z[i] > 0.0:
            load[i] = hertz.load(radius[i], z[i])
            closed[count] = i
            count += 1
    u = state.displacement
    for i in range(n):
        u[i] = self_term[i] * load[i]
    add_rows(field.influence, closed, count, load, u)
    if order == 1:
        for i in range(n):
            state.bend[i] = 1.0
            state.indentation[i] = z[i]
            state.square[i] = radius[i] * max(z[i], 0.0)
        return count
    gx, gy, curvature = state.slope_x, state.slope_y, state.curvature
    gx[:] = 0.0
    gy[:] = 0.0
    curvature[:] = 0.0
    add_rows(field.slope_x_at, closed, count, load, gx)
    add_rows(field.slope_y_at, closed, count, load, gy)
    add_rows(field.laplacian_at, closed, count, load, curvature)
    for i in range(n):
        state.bend[i] = 1.0
        state.indentation[i] = z[i]
        state.square[i] = 0.0
        u[i] -= 0.5 * radius[i] * (gx[i] * gx[i] + gy[i] * gy[i])
    size = state.part
    for k in range(count):
        i = closed[k]
        bend = np.cbrt(max(1.0 + 0.5 * radius[i] * curvature[i], LEAST_CURVATURE))
        state.bend[i] = bend
        state.indentation[i] = z[i] * bend
        state.square[i] = radius[i] * z[i] / (bend * bend)
        size[i] = 0.1 * load[i] * state.square[i]
    add_rows(field.laplacian, closed, count, size, u)
    moment_x, moment_y = state.part, state.other
    for k in range(count):
        i = closed[k]
        moment_x[i] = -load[i] * radius[i] * gx[i]
        moment_y[i] = -load[i] * radius[i] * gy[i]
    add_rows(field.slope_x, closed, count, moment_x, u)
    add_rows(field.slope_y, closed, count, moment_y, u)
    return count


@inner
def assemble(field, radius, state, count, matrix):
    """Fill the rows of contacts of dF/dp, without the diagonal of Hertz and `self_term`.

    Two terms are left out, squares of the order-3 corrections; the residual contains them.
    """
    n = radius.size
    tilt_x, tilt_y, third = state.part, state.other, state.square
    for i in range(n):
        tilt_x[i] = radius[i] * state.slope_x[i]
        tilt_y[i] = radius[i] * state.slope_y[i]
    for k in range(count):
        j = state.closed[k]
        bend, x, y = third[j] / 6.0, tilt_x[j], tilt_y[j]
        row, point = matrix[j], field.influence[j]
        lap, lap_at = field.laplacian[j], field.laplacian_at[j]
        gx, gx_at = field.slope_x[j], field.slope_x_at[j]
        gy, gy_at = field.slope_y[j], field.slope_y_at[j]
        for i in range(n):
            row[i] = (
                point[i]
                + (bend * lap[i] + third[i] / 6.0 * lap_at[i])
                - (x * gx[i] + tilt_x[i] * gx_at[i])
                - (y * gy[i] + tilt_y[i] * gy_at[i])
            )


@inner
def quadratic_form(field, order, radius, self_term, state, count, y, out, rate):
    """Return y.(d2W/dp2) y with every term; y vanishes on open asperities. out, rate: scratch."""
    closed = state.closed
    out[:] = 0.0
    add_rows(field.influence, closed, count, y, out)
    total = 0.0
    for k in range(count):
        i = closed[k]
        compliance = state.bend[i] / hertz.stiffness(radius[i], state.z[i])
        total += y[i] * (out[i] + (compliance + self_term[i]) * y[i])
    if order == 1:
        return total
    rate[:] = 0.0
    add_rows(field.laplacian_at, closed, count, y, rate)
    for k in range(count):
        i = closed[k]
        square, bend = state.square[i], state.bend[i]
        # k R = bend^3; v = p a^2/10 falls as k^(-2/3)
        curved = state.load[i] * square * radius[i] / (30.0 * bend * bend * bend)
        total += rate[i] * (square / 3.0 * y[i] - curved * rate[i])
    for axis in range(2):
        rate[:] = 0.0
        matrix = field.slope_x_at if axis == 0 else field.slope_y_at
        slope = state.slope_x if axis == 0 else state.slope_y
        add_rows(matrix, closed, count, y, rate)
        for k in range(count):
            i = closed[k]
            total -= radius[i] * rate[i] * (2.0 * y[i] * slope[i] + state.load[i] * rate[i])
    return total


@inner
def energy(order, radius, gap, approach, state, count):
    """Return the complementary energy W [mm^3] of the state."""
    total = 0.0
    for k in range(count):
        i = state.closed[k]
        p = state.load[i]
        total += p * (0.6 * state.indentation[i] + 0.5 * state.displacement[i] - (approach - gap[i]))
        if order > 1:
            slope = state.slope_x[i] ** 2 + state.slope_y[i] ** 2
            total += p * (0.25 * radius[i] * slope - 0.05 * state.square[i] * state.curvature[i])
    return total


@inner
def measure(order, radius, gap, approach, target, state, count):
    """Return the residual of the equations, and the load.

    The residual is the largest |d + u - e| of a contact or overlap of an open asperity, over the largest d,
    and the relative error of the load if `target` is positive.
    """
    worst = largest = load = rest = 0.0
    for i in range(radius.size):
        error = state.indentation[i] + state.displacement[i] - (approach - gap[i])
        if state.z[i] > 0.0:
            worst = max(worst, abs(error))
            largest = max(largest, state.indentation[i])
            load, rest = add(load, rest, state.load[i])
            if order > 1 and 1.0 + 0.5 * radius[i] * state.curvature[i] <= LEAST_CURVATURE:
                worst = math.inf
        else:
            worst = max(worst, state.z[i] - error)
    load += rest
    nothing = 1.0 if worst > 0.0 else 0.0  # open summits that overlap the plane
    residual = nothing if count == 0 else worst / largest
    if target > 0.0:
        residual = max(residual, abs(load - target) / target)
    return residual, load
