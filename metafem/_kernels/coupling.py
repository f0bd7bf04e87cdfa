"""Elastic coupling of contacts; all loads are rescaled, p = P/E* [mm^2].

The equations of order 3 are the gradient of one complementary energy of the loads,

    W(p) = sum_i w_i(p_i, k_i) + 1/2 p.G p - sum_i T_i(p_i) |g_i|^2 - e.p

with e_i = x - gap_i at the approach x, the extra curvature k_i = 1/2 sum_j p_j lap_i G_ij, the slope
g_i = sum_j p_j grad_i G_ij, and the complementary energy w of the contact law. The derivatives of w with
respect to p and k are the indentation d and half the second moment M of the pressure. The finite size of a
source j enters as M_j/4, and T = 2/3 a^3 is the moment of a tilted contact. Since the three corrections
derive from one energy, the Jacobian is symmetric. For Hertz's law w = 3/5 p d, M/4 = p a^2/10, T = 1/2 p R,
and the contact is shifted by -R g.

The unknown of a contact is its nominal indentation z: the indentation at which the law without extra
curvature has the load p. If z < 0 the asperity is open, with the gap -z. `contact.tabulated` evaluates all
laws except Hertz's.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.contact import hertz, tabulated
from metafem._kernels.vectors import add


class Coupling(NamedTuple):
    """Influence of the asperities on each other, (n, n); row j belongs to the source j.

    Matrices named `_at` contain derivatives at the displaced asperity, the other matrices derivatives at the
    source. For order 1 all except `influence` may be empty.
    """

    influence: np.ndarray
    slope_x: np.ndarray
    slope_y: np.ndarray
    laplacian: np.ndarray
    slope_x_at: np.ndarray
    slope_y_at: np.ndarray
    laplacian_at: np.ndarray


class State(NamedTuple):
    """The contacts at nominal indentations z; arrays (n,)."""

    z: np.ndarray  # nominal indentation [mm]
    load: np.ndarray  # p [mm^2]
    rate: np.ndarray  # dp/dz [mm]
    square: np.ndarray  # a^2 [mm^2]
    widening: np.ndarray  # da^2/dp [-], not filled for Hertz contacts
    indentation: np.ndarray  # d [mm]
    displacement: np.ndarray  # u at the contact [mm]
    bend: np.ndarray  # dd/dz [-]; (1 + k R)^(1/3) for Hertz's law
    moment: np.ndarray  # M/4 [mm^4]
    lever: np.ndarray  # 2 T [mm^3]
    lever_rate: np.ndarray  # 2 dT/dp [mm]
    lever_bend: np.ndarray  # 2 d2T/dp2 [1/mm]
    slope_x: np.ndarray
    slope_y: np.ndarray
    curvature: np.ndarray  # 2 k, the sum of p lap G [1/mm]
    footprint: np.ndarray  # A/pi [mm^2], filled by `spread` as are its derivatives
    by_load: np.ndarray  # derivative of A/pi with respect to p [-]
    by_curvature: np.ndarray  # derivative of A/pi with respect to k [mm^3]
    by_slope: np.ndarray  # derivative of A/pi with respect to |g|^2 [mm^2]
    outside: np.ndarray  # 1 if z or the extra curvature is outside the range of the law, else 0
    part: np.ndarray  # scratch
    other: np.ndarray  # scratch
    closed: np.ndarray  # indices of the asperities in contact


def empty_state(count: int) -> State:
    """Return a zero state of `count` asperities."""
    return State._make([*np.zeros((len(State._fields) - 1, count)), np.zeros(count, dtype=np.int64)])


@compiled
def copy(source, target):
    """Copy an array (n,) by a loop; slice assignment would take seconds to compile."""
    for i in range(target.size):
        target[i] = source[i]


@compiled
def add_rows(matrix, closed, count, weight, out):
    """Add the sum over closed j of weight[j] matrix[j] to `out` (n,)."""
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
def press(law, order, state):
    """Fill the quantities that depend only on z; return the number of contacts."""
    radius, which, scale, data = law
    plain = data.size == 0
    count = 0
    for i in range(state.z.size):
        z = state.z[i]
        state.indentation[i] = z
        state.bend[i] = 1.0
        if not z > 0.0:
            state.load[i] = state.square[i] = 0.0
            if order > 1:
                state.lever_rate[i] = (
                    radius[i] if plain else 2.0 * data[which[i], tabulated.LEVER_START] * scale[i]
                )
            continue
        state.closed[count] = i
        count += 1
        if plain:
            a = hertz.contact_radius(radius[i], z)
            state.square[i] = radius[i] * z
            state.rate[i] = hertz.STIFFNESS * a
            state.load[i] = hertz.LOAD * a * z
            if order > 1:
                state.lever[i] = state.load[i] * radius[i]
                state.lever_rate[i] = radius[i]
            continue
        at = which[i]
        state.outside[i] = 0.0 if tabulated.covers(data, at, scale[i], z) else 1.0
        if order == 1:
            state.load[i], state.rate[i], state.square[i], state.widening[i] = tabulated.pressed(
                data, at, scale[i], z
            )
        else:
            (
                state.load[i], state.rate[i], state.square[i], state.widening[i],
                state.lever[i], state.lever_rate[i], state.lever_bend[i],
            ) = tabulated.tilted(data, at, scale[i], z)  # fmt: skip
    return count


@compiled
def sharpen(law, state, count):
    """Fill the quantities that depend on the curvature of the neighbours' field."""
    radius, which, scale, data = law
    plain = data.size == 0
    for k in range(count):
        i = state.closed[k]
        extra = 0.5 * state.curvature[i]
        if plain:
            cube = 1.0 + radius[i] * extra
            bend = np.cbrt(max(cube, tabulated.LEAST_CURVATURE))
            state.bend[i] = bend
            state.indentation[i] = state.z[i] * bend
            state.square[i] = radius[i] * state.z[i] / (bend * bend)
            state.moment[i] = 0.1 * state.load[i] * state.square[i]
            inside = cube > tabulated.LEAST_CURVATURE
        else:
            wide, depth, bend, widening, moment, inside = tabulated.bent(
                data, which[i], scale[i], state.load[i], state.square[i], state.widening[i], extra
            )
            state.square[i], state.indentation[i], state.bend[i] = wide, depth, bend
            state.widening[i], state.moment[i] = widening, moment
        if not inside:
            state.outside[i] = 1.0
        elif plain:
            state.outside[i] = 0.0


@compiled
def spread(order, law, state):
    """Fill the areas of the contacts and their derivatives; only results and sensitivities need them."""
    radius, which, scale, data = law
    plain = data.size == 0
    for i in range(state.z.size):
        square = state.square[i]
        state.footprint[i] = state.by_load[i] = state.by_curvature[i] = state.by_slope[i] = 0.0
        if not square > 0.0:
            continue
        state.footprint[i] = square
        # for Hertz's law da^2/dp = R/(2 sqrt(R z) b^2), with b = dd/dz
        wider = radius[i] / (state.rate[i] * state.bend[i] * state.bend[i]) if plain else state.widening[i]
        if order > 1 and not plain:
            slope = state.slope_x[i] * state.slope_x[i] + state.slope_y[i] * state.slope_y[i]
            (
                state.footprint[i], state.by_load[i], state.by_curvature[i], state.by_slope[i]
            ) = tabulated.on_slope(data, which[i], scale[i], square, wider, slope)  # fmt: skip
            continue
        state.by_load[i] = wider
        if order > 1:
            state.by_curvature[i] = -4.0 / 3.0 * square * math.sqrt(square) * wider


@compiled
def respond(field, order, law, self_term, state):
    """Fill all quantities of a state from its nominal indentations z; return the number of contacts."""
    load, closed, u = state.load, state.closed, state.displacement
    n = load.size
    count = press(law, order, state)
    for i in range(n):
        u[i] = self_term[i] * load[i]
    add_rows(field.influence, closed, count, load, u)
    if order == 1:
        return count
    gx, gy, curvature = state.slope_x, state.slope_y, state.curvature
    gx[:] = 0.0
    gy[:] = 0.0
    curvature[:] = 0.0
    add_rows(field.slope_x_at, closed, count, load, gx)
    add_rows(field.slope_y_at, closed, count, load, gy)
    add_rows(field.laplacian_at, closed, count, load, curvature)
    for i in range(n):
        u[i] -= 0.5 * state.lever_rate[i] * (gx[i] * gx[i] + gy[i] * gy[i])
    sharpen(law, state, count)
    add_rows(field.laplacian, closed, count, state.moment, u)
    moment_x, moment_y = state.part, state.other
    for k in range(count):
        i = closed[k]
        moment_x[i] = -state.lever[i] * gx[i]
        moment_y[i] = -state.lever[i] * gy[i]
    add_rows(field.slope_x, closed, count, moment_x, u)
    add_rows(field.slope_y, closed, count, moment_y, u)
    return count


@compiled
def assemble(field, state, count, matrix):
    """Fill the rows of dF/dp of the contacts, without the diagonal terms of the law and of `self_term`.

    Terms quadratic in the order-3 corrections are omitted here; the residual includes them.
    """
    tilt_x, tilt_y, third = state.part, state.other, state.square
    n = third.size
    for i in range(n):
        tilt_x[i] = state.lever_rate[i] * state.slope_x[i]
        tilt_y[i] = state.lever_rate[i] * state.slope_y[i]
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


@compiled
def quadratic_form(field, order, self_term, state, count, y, out, rate):
    """Return y.(d2W/dp2) y with all terms; y is zero for open asperities. out, rate: scratch (n,)."""
    closed = state.closed
    out[:] = 0.0
    add_rows(field.influence, closed, count, y, out)
    total = 0.0
    for k in range(count):
        i = closed[k]
        compliance = state.bend[i] / state.rate[i]
        total += y[i] * (out[i] + (compliance + self_term[i]) * y[i])
    if order == 1:
        return total
    rate[:] = 0.0
    add_rows(field.laplacian_at, closed, count, y, rate)
    for k in range(count):
        i = closed[k]
        square = state.square[i]
        # dd/dk = a^2/3 and dM/dk = -16/45 a^5 at fixed load, for every elastic law
        curved = 2.0 / 45.0 * square * square * math.sqrt(square)
        total += rate[i] * (square / 3.0 * y[i] - curved * rate[i])
    for axis in range(2):
        rate[:] = 0.0
        matrix = field.slope_x_at if axis == 0 else field.slope_y_at
        slope = state.slope_x if axis == 0 else state.slope_y
        add_rows(matrix, closed, count, y, rate)
        for k in range(count):
            i = closed[k]
            tilted = state.lever_rate[i] * y[i] * slope[i]
            total -= rate[i] * (2.0 * tilted + state.lever[i] * rate[i])
            if state.lever_bend[i] != 0.0:
                total -= 0.5 * state.lever_bend[i] * (y[i] * slope[i]) ** 2
    return total


@compiled
def energy(order, law, gap, approach, state, count):
    """Return the complementary energy W [mm^3] of a state."""
    total = 0.0
    plain = law.data.size == 0
    for k in range(count):
        i = state.closed[k]
        p, extra = state.load[i], 0.5 * state.curvature[i] if order > 1 else 0.0
        if plain:
            total += 0.6 * p * state.indentation[i]
        else:
            total += tabulated.complementary(
                law.data, law.which[i], law.scale[i], order, state.z[i], state.square[i], extra
            )
        total += p * (0.5 * state.displacement[i] - (approach - gap[i]))
        if order > 1:
            slope = state.slope_x[i] ** 2 + state.slope_y[i] ** 2
            total += 0.25 * p * state.lever_rate[i] * slope - extra * state.moment[i]
    return total


@compiled
def measure(order, gap, approach, target, state, count):
    """Return the residual of the equations [-] and the load [mm^2].

    The residual is the largest |d + u - e| of a contact, or the largest overlap of an open asperity with the
    plane, divided by the largest d. If `target` is positive, the residual is at least the relative error of
    the load.
    """
    worst = largest = load = rest = 0.0
    for i in range(gap.size):
        error = state.indentation[i] + state.displacement[i] - (approach - gap[i])
        if state.z[i] > 0.0:
            worst = max(worst, abs(error))
            largest = max(largest, state.indentation[i])
            load, rest = add(load, rest, state.load[i])
            if state.outside[i] > 0.0:
                worst = math.inf
        else:
            worst = max(worst, state.z[i] - error)
    load += rest
    nothing = 1.0 if worst > 0.0 else 0.0  # no contact, but open summits overlap the plane
    residual = nothing if count == 0 else worst / largest
    if target > 0.0:
        residual = max(residual, abs(load - target) / target)
    return residual, load
