"""The equations of coupled contacts; all loads are rescaled, p = P/E* [mm^2].

The equations of order 3 are the gradient of one complementary energy of the loads,

    W(p) = sum_i w_i(p_i, k_i) + 1/2 p.G p - sum_i T_i(p_i) |g_i|^2 - e.p

with e_i = x - gap_i at the approach x, the extra curvature k_i = 1/2 sum_j p_j lap_i G_ij, the slope
g_i = sum_j p_j grad_i G_ij, and the complementary energy w of the contact law. The derivatives of w with
respect to p and k are the indentation d and half the second moment M of the pressure. The finite size of a
source j enters as M_j/4, and T = 2/3 a^3 is the moment of a tilted contact. Since the three corrections
derive from one energy, the Jacobian is symmetric. For Hertz's law w = 3/5 p d, M/4 = p a^2/10, T = 1/2 p R,
and the contact is shifted by -R g. Order 1 has k = g = 0.

The unknown of a contact is its nominal indentation z: the indentation at which the law without extra
curvature has the load p. If z < 0 the asperity is open, with the gap -z. `law` evaluates all
laws except Hertz's.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels import law as hertz
from metafem._kernels import law as tabulated
from metafem._kernels.compiled import compiled, inlined
from metafem._kernels.vectors import largest, total_of

# Largest product of curvature and radius for which one step of Halley's method from the third-order series of
# the cube root is exact to rounding.
NEAR_ONE = 0.1


class Coupling(NamedTuple):
    """Influence of n asperities on each other: G and, for order 3, its Laplacian and two slopes.

    Row j of `source`, (n, 4 n), has the four fields of a unit load at j, one after another, with the
    derivatives with respect to the place of the load. `displaced` has, instead, the derivatives at the other
    end, the slopes with opposite signs: if G depends on distances alone, both are one array. Order 1 has G
    alone, (n, n).
    """

    source: np.ndarray
    displaced: np.ndarray

    @property
    def influence(self) -> np.ndarray:
        """G, (n, n)."""
        return self.source[:, : len(self.source)]

    @property
    def fields(self) -> np.ndarray:
        """The parts of `source`: G, Laplacian and the slopes along x and y, (4 or 1, n, n)."""
        count = len(self.source)
        return self.source.reshape(count, -1, count).swapaxes(0, 1)


class State(NamedTuple):
    """The contacts at nominal indentations z; arrays (n,)."""

    z: np.ndarray  # nominal indentation [mm]
    load: np.ndarray  # p [mm^2]
    rate: np.ndarray  # dp/dz [mm]
    square: np.ndarray  # a^2 [mm^2]
    widening: np.ndarray  # da^2/dp [-], not filled for Hertz contacts
    indentation: np.ndarray  # d [mm]
    bend: np.ndarray  # dd/dz [-]; (1 + k R)^(1/3) for Hertz's law
    moment: np.ndarray  # M/4 [mm^4]
    lever: np.ndarray  # 2 T [mm^3]
    lever_rate: np.ndarray  # 2 dT/dp [mm]
    lever_bend: np.ndarray  # 2 d2T/dp2 [1/mm]
    footprint: np.ndarray  # A/pi [mm^2], filled by `spread` as are its derivatives
    by_load: np.ndarray  # derivative of A/pi with respect to p [-]
    by_curvature: np.ndarray  # derivative of A/pi with respect to k [mm^3]
    by_slope: np.ndarray  # derivative of A/pi with respect to |g|^2 [mm^2]
    outside: np.ndarray  # 1 if z or the extra curvature is outside the range of the law, else 0
    field: (
        np.ndarray
    )  # the four fields at the asperities, one after another (4 n,), of which these are parts:
    displacement: np.ndarray  # u [mm]
    curvature: np.ndarray  # 2 k, the sum of p lap G [1/mm]
    slope_x: np.ndarray  # -g [-]
    slope_y: np.ndarray
    changes: np.ndarray  # the same four fields of changes of the loads (4 n,)
    size: (
        np.ndarray
    )  # second moment over 4 [mm^4] and first moments [mm^3], or their changes, as sources of u
    turn_x: np.ndarray
    turn_y: np.ndarray
    closed: np.ndarray  # indices of the asperities in contact


# Number of rows of a block that hold a state.
ROWS = 27


@inlined
def state_in(block, closed):
    """Return the state in the first rows of a block (rows, n), with the indices `closed` (n,)."""
    n = block.shape[1]
    return State(
        block[0], block[1], block[2], block[3], block[4], block[5], block[6], block[7], block[8], block[9],
        block[10], block[11], block[12], block[13], block[14], block[15],
        block[16:20].reshape(4 * n), block[16], block[17], block[18], block[19],
        block[20:24].reshape(4 * n), block[24], block[25], block[26], closed,
    )  # fmt: skip


def empty_state(count: int) -> State:
    """Return a zero state of `count` asperities."""
    state: State = state_in.py_func(np.zeros((ROWS, count)), np.zeros(count, np.int64))
    return state


@compiled
def copy(source, target):
    """Copy an array (n,) by a loop; slice assignment would take seconds to compile."""
    for i in range(target.size):
        target[i] = source[i]


@compiled
def add_rows(matrix, rows, count, weight, out):
    """Add the sum over the first `count` rows j of weight[j] matrix[j] to `out`."""
    n = out.size
    k = 0
    while k + 4 <= count:
        a, b, c, d = rows[k], rows[k + 1], rows[k + 2], rows[k + 3]
        row_a, row_b, row_c, row_d = matrix[a], matrix[b], matrix[c], matrix[d]
        w_a, w_b, w_c, w_d = weight[a], weight[b], weight[c], weight[d]
        for i in range(n):
            out[i] += (w_a * row_a[i] + w_b * row_b[i]) + (w_c * row_c[i] + w_d * row_d[i])
        k += 4
    while k < count:
        row = matrix[rows[k]]
        w = weight[rows[k]]
        for i in range(n):
            out[i] += w * row[i]
        k += 1


@compiled
def add_moments(source, closed, count, size, turn_x, turn_y, u):
    """Add the fields of second and first moments of the contacts to u (n,)."""
    n = u.size
    k = 0
    while k < count:
        i, j = closed[k], closed[min(k + 1, count - 1)]
        last = 1.0 if k + 1 < count else 0.0
        one, two = source[i], source[j]
        m_i, x_i, y_i = size[i], turn_x[i], turn_y[i]
        m_j, x_j, y_j = last * size[j], last * turn_x[j], last * turn_y[j]
        lap_i, gx_i, gy_i = one[n : 2 * n], one[2 * n : 3 * n], one[3 * n :]
        lap_j, gx_j, gy_j = two[n : 2 * n], two[2 * n : 3 * n], two[3 * n :]
        for m in range(n):
            first = m_i * lap_i[m] + (x_i * gx_i[m] + y_i * gy_i[m])
            u[m] += first + (m_j * lap_j[m] + (x_j * gx_j[m] + y_j * gy_j[m]))
        k += 2


@inlined
def press(law, order, state):
    """Fill the quantities that depend only on z; return the number of contacts."""
    radius, which, scale, data = law
    count = 0
    for i in range(state.z.size):
        state.indentation[i] = state.z[i]
        state.bend[i] = 1.0
        state.closed[count] = i  # overwritten by the next asperity unless this one is in contact
        count += 1 if state.z[i] > 0.0 else 0
    if data.size == 0:
        for i in range(state.z.size):
            d = state.z[i] if state.z[i] > 0.0 else 0.0
            a = hertz.contact_radius(radius[i], d)
            state.square[i] = radius[i] * d
            state.rate[i] = hertz.STIFFNESS * a
            state.load[i] = hertz.LOAD * a * d
            state.lever[i] = state.load[i] * radius[i]
            state.lever_rate[i] = radius[i]
        return count
    for i in range(state.z.size):
        at, z = which[i], state.z[i]
        if not z > 0.0:
            state.load[i] = state.square[i] = 0.0
            state.lever_rate[i] = 2.0 * data[at, 2] * scale[i]
            continue
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


@inlined
def sharpen(law, state, count):
    """Fill the quantities that depend on the curvature of the neighbours' field."""
    radius, which, scale, data = law
    if data.size == 0:
        far = 0
        for i in range(state.z.size):
            extra = 0.5 * radius[i] * state.curvature[i]
            cube = 1.0 + extra
            y = 1.0 + extra * (1.0 / 3.0 + extra * (extra * (5.0 / 81.0) - 1.0 / 9.0))
            y3 = y * y * y
            closed = state.z[i] > 0.0
            state.bend[i] = y * (y3 + 2.0 * cube) / (2.0 * y3 + cube) if closed else 1.0
            state.outside[i] = 1.0 if closed and not cube > tabulated.LEAST_CURVATURE else 0.0
            far += 1 if closed and abs(extra) > NEAR_ONE else 0
        if far > 0:
            for k in range(count):
                i = state.closed[k]
                cube = 1.0 + 0.5 * radius[i] * state.curvature[i]
                state.bend[i] = np.cbrt(max(cube, tabulated.LEAST_CURVATURE))
        for i in range(state.z.size):
            bend = state.bend[i]
            state.indentation[i] = state.z[i] * bend
            state.square[i] /= bend * bend
            state.moment[i] = 0.1 * state.load[i] * state.square[i]
        return
    for k in range(count):
        i = state.closed[k]
        wide, depth, bend, widening, moment, inside = tabulated.bent(
            data, which[i], scale[i], state.load[i], state.square[i], state.widening[i],
            0.5 * state.curvature[i],
        )  # fmt: skip
        state.square[i], state.indentation[i], state.bend[i] = wide, depth, bend
        state.widening[i], state.moment[i] = widening, moment
        if not inside:
            state.outside[i] = 1.0


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


@inlined
def respond(field, order, law, self_term, state):
    """Fill all quantities of a state from its nominal indentations z; return the number of contacts."""
    load, closed, u = state.load, state.closed, state.displacement
    n = load.size
    count = press(law, order, state)
    for i in range(state.field.size):
        state.field[i] = 0.0
    if order == 1:
        add_rows(field.displaced, closed, count, load, u)
        for i in range(n):
            u[i] += self_term[i] * load[i]
        return count
    add_rows(field.displaced, closed, count, load, state.field)
    gx, gy = state.slope_x, state.slope_y
    for i in range(n):
        u[i] += self_term[i] * load[i] - 0.5 * state.lever_rate[i] * (gx[i] * gx[i] + gy[i] * gy[i])
    sharpen(law, state, count)
    for i in range(n):
        state.size[i] = state.moment[i]
        state.turn_x[i] = state.lever[i] * gx[i]
        state.turn_y[i] = state.lever[i] * gy[i]
    add_moments(field.source, closed, count, state.size, state.turn_x, state.turn_y, u)
    return count


@inlined
def assemble(field, state, count, matrix):
    """Fill the rows of dF/dp of the contacts, without the diagonal terms of the law and of `self_term`.

    Terms quadratic in the order-3 corrections are omitted here; the residual includes them.
    """
    n = state.z.size
    third, tilt_x, tilt_y = state.size, state.turn_x, state.turn_y
    for i in range(n):
        third[i] = state.square[i] / 6.0
        tilt_x[i] = state.lever_rate[i] * state.slope_x[i]
        tilt_y[i] = state.lever_rate[i] * state.slope_y[i]
    for k in range(count):
        j = state.closed[k]
        bend, x, y = third[j], tilt_x[j], tilt_y[j]
        row, own, other = matrix[j], field.source[j], field.displaced[j]
        for i in range(n):
            row[i] = (
                own[i]
                + (bend * own[n + i] + third[i] * other[n + i])
                + (x * own[2 * n + i] - tilt_x[i] * other[2 * n + i])
                + (y * own[3 * n + i] - tilt_y[i] * other[3 * n + i])
            )


@inlined
def linearise(field, order, self_term, state, count, y, image):
    """Return y.(d2W/dp2) y with all terms for changes y of the loads; y is zero for open asperities.

    For the contacts, fill (d2W/dp2) y without the fields of the changes of the moments, which `state` then
    has.
    """
    n = y.size
    changes = state.changes[: n if order == 1 else 4 * n]
    for i in range(changes.size):
        changes[i] = 0.0
    add_rows(field.displaced, state.closed, count, y, changes)
    total = 0.0
    for k in range(count):
        i = state.closed[k]
        own = changes[i] + (state.bend[i] / state.rate[i] + self_term[i]) * y[i]
        if order > 1:
            lap, gx, gy = changes[n + i], changes[2 * n + i], changes[3 * n + i]
            x, square = state.slope_x[i], state.square[i]
            third, tilt = square / 6.0, state.lever_rate[i]
            # dd/dk = a^2/3 and dM/dk = -16/45 a^5 at fixed load, for every elastic law
            state.size[i] = third * y[i] - 2.0 / 45.0 * square * square * math.sqrt(square) * lap
            state.turn_x[i] = tilt * y[i] * x + state.lever[i] * gx
            state.turn_y[i] = tilt * y[i] * state.slope_y[i] + state.lever[i] * gy
            steep = x * x + state.slope_y[i] * state.slope_y[i]
            own += third * lap - tilt * (x * gx + state.slope_y[i] * gy)
            own -= 0.5 * state.lever_bend[i] * steep * y[i]
            total += lap * state.size[i] - (gx * state.turn_x[i] + gy * state.turn_y[i])
        image[i] = own
        total += y[i] * own
    return total


@inlined
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


@inlined
def measure(gap, approach, target, state, count):
    """Return the residual of the equations [-] and the load [mm^2].

    The residual is the largest |d + u - e| of a contact, or the largest overlap of an open asperity with the
    plane, divided by the largest d. If `target` is positive, the residual is at least the relative error of
    the load.
    """
    errors = state.size
    for i in range(gap.size):
        error = state.indentation[i] + state.displacement[i] - (approach - gap[i])
        closed = state.z[i] > 0.0
        errors[i] = abs(error) if closed else max(state.z[i] - error, 0.0)
        errors[i] += math.inf if closed and state.outside[i] > 0.0 else 0.0
    worst, load = largest(errors), total_of(state.load)
    nothing = 1.0 if worst > 0.0 else 0.0  # no contact, but open summits overlap the plane
    residual = nothing if count == 0 else worst / largest(state.indentation)
    if target > 0.0:
        residual = max(residual, abs(load - target) / target)
    return (residual if math.isfinite(total_of(errors)) else math.inf), load
