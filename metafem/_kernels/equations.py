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
curvature has the load p. If z < 0 the asperity is open, with the gap -z. In the order of evaluation:

- `press`: p, dp/dz, a and T from z, by Hertz's law here and by all other laws in `law`;
- `respond`: u = G p, k and g, the fields of the loads, and -dT/dp |g|^2, by which a slope raises a contact;
- `sharpen`: a, d and M under the extra curvature k, for Hertz's law with 1/R + k in place of 1/R;
- `add_moments`: M/4 lap G and the field of the tilted contacts, added to u;
- `measure`: the residuals d + u - e, and sum p - P if the load is given;
- `assemble`, `linearise`: the derivatives d2W/dp2, without and with the terms of second order;
- `spread`: the areas and their derivatives.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels import law as contact
from metafem._kernels.compiled import compiled
from metafem._kernels.vectors import largest, total_of

# The influence of n asperities on each other is a pair `field` of arrays (n, 4 n), or (n, n) of G for order
# 1. Row j of the first, the source, has the four fields of a unit load at j, one after another: G, its
# Laplacian and its two slopes, with the derivatives with respect to the place of the load. Row j of the
# second, the displaced, has the derivatives at the other end, the slopes with opposite signs: if G depends on
# distances alone, both are one array.
Coupling = tuple[np.ndarray, np.ndarray]

# Rows of the block `s` (rows, n) that holds the contacts at nominal indentations z, and scratch of solvers.
ROWS = (
    "z",  # nominal indentation [mm]
    "load",  # p [mm^2]
    "rate",  # dp/dz [mm]
    "square",  # a^2 [mm^2]
    "widening",  # da^2/dp [-], not filled for Hertz contacts
    "indentation",  # d [mm]
    "bend",  # dd/dz [-]; (1 + k R)^(1/3) for Hertz's law
    "moment",  # M/4 [mm^4]
    "lever",  # 2 T [mm^3]
    "lever_rate",  # 2 dT/dp [mm]
    "lever_bend",  # 2 d2T/dp2 [1/mm]
    "footprint",  # A/pi [mm^2], filled by `spread` as are its derivatives
    "by_load",  # derivative of A/pi with respect to p [-]
    "by_curvature",  # derivative of A/pi with respect to k [mm^3]
    "by_slope",  # derivative of A/pi with respect to |g|^2 [mm^2]
    "outside",  # 1 if z or the extra curvature is outside the range of the law, else 0
    "displacement",  # u at the contact [mm]
    "curvature",  # 2 k, the sum of p lap G [1/mm]
    "slope_x",  # -g [-]
    "slope_y",
    "change",  # the same four fields of changes of the loads
    *("change of curvature", "change of slope_x", "change of slope_y"),
    "size",  # second moment over 4 [mm^4] and first moments [mm^3], or their changes, as sources of u
    "turn_x",
    "turn_y",
    *(f"scratch {k}" for k in range(14)),
)
(
    Z, LOAD, RATE, SQUARE, WIDENING, INDENTATION, BEND, MOMENT, LEVER, LEVER_RATE, LEVER_BEND, FOOTPRINT,
    BY_LOAD, BY_CURVATURE, BY_SLOPE, OUTSIDE, DISPLACEMENT, CURVATURE, SLOPE_X, SLOPE_Y, CHANGE, _, _, _,
    SIZE, TURN_X, TURN_Y, SCRATCH,
) = range(28)  # fmt: skip


class State:
    """The contacts at nominal indentations z, with each row of `ROWS` as an attribute (n,)."""

    def __init__(self, count: int) -> None:
        self.block = np.zeros((len(ROWS), count))
        self.closed = np.zeros(count, np.int64)  # indices of the asperities in contact

    def __getattr__(self, name: str) -> np.ndarray:
        """Return a row of the block."""
        if name not in ROWS:
            raise AttributeError(name)
        return np.asarray(self.block[ROWS.index(name)])


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


@compiled
def press(law, order, s, closed):
    """Fill the quantities that depend only on z; return the number of contacts."""
    radius, which, scale, data = law
    count = 0
    for i in range(s.shape[1]):
        s[INDENTATION, i] = s[Z, i]
        s[BEND, i] = 1.0
        closed[count] = i  # overwritten by the next asperity unless this one is in contact
        count += 1 if s[Z, i] > 0.0 else 0
    if data.size == 0:
        for i in range(s.shape[1]):
            d = s[Z, i] if s[Z, i] > 0.0 else 0.0
            a = contact.contact_radius(radius[i], d)
            s[SQUARE, i] = radius[i] * d
            s[RATE, i] = contact.STIFFNESS * a
            s[LOAD, i] = contact.LOAD * a * d
            s[LEVER, i] = s[LOAD, i] * radius[i]
            s[LEVER_RATE, i] = radius[i]
            s[OUTSIDE, i] = 0.0
        return count
    for i in range(s.shape[1]):
        at, z = which[i], s[Z, i]
        if not z > 0.0:
            s[LOAD, i] = s[SQUARE, i] = 0.0
            s[LEVER_RATE, i] = 2.0 * data[at, 2] * scale[i]  # dT/dp of a flat summit that just touches
            continue
        s[OUTSIDE, i] = 0.0 if contact.covers(data, at, scale[i], z) else 1.0
        if order == 1:
            s[LOAD, i], s[RATE, i], s[SQUARE, i], s[WIDENING, i] = contact.pressed(data, at, scale[i], z)
        else:
            (
                s[LOAD, i], s[RATE, i], s[SQUARE, i], s[WIDENING, i],
                s[LEVER, i], s[LEVER_RATE, i], s[LEVER_BEND, i],
            ) = contact.tilted(data, at, scale[i], z)  # fmt: skip
    return count


@compiled
def sharpen(law, s, closed, count):
    """Fill the quantities that depend on the curvature of the neighbours' field."""
    radius, which, scale, data = law
    if data.size == 0:
        far = 0
        for i in range(s.shape[1]):
            extra = 0.5 * radius[i] * s[CURVATURE, i]
            cube = 1.0 + extra
            y = 1.0 + extra * (1.0 / 3.0 + extra * (extra * (5.0 / 81.0) - 1.0 / 9.0))
            y3 = y * y * y
            touching = s[Z, i] > 0.0
            s[BEND, i] = y * (y3 + 2.0 * cube) / (2.0 * y3 + cube) if touching else 1.0
            s[OUTSIDE, i] = 1.0 if touching and not cube > contact.LEAST_CURVATURE else 0.0
            # up to .1 Halley's method from the series is exact to rounding
            far += 1 if touching and abs(extra) > 0.1 else 0
        if far > 0:
            for k in range(count):
                i = closed[k]
                cube = 1.0 + 0.5 * radius[i] * s[CURVATURE, i]
                s[BEND, i] = np.cbrt(max(cube, contact.LEAST_CURVATURE))
        for i in range(s.shape[1]):
            bend = s[BEND, i]
            s[INDENTATION, i] = s[Z, i] * bend
            s[SQUARE, i] /= bend * bend
            s[MOMENT, i] = 0.1 * s[LOAD, i] * s[SQUARE, i]
        return
    for k in range(count):
        i = closed[k]
        wide, depth, bend, widening, moment, inside = contact.bent(
            data, which[i], scale[i], s[LOAD, i], s[SQUARE, i], s[WIDENING, i],
            0.5 * s[CURVATURE, i],
        )  # fmt: skip
        s[SQUARE, i], s[INDENTATION, i], s[BEND, i] = wide, depth, bend
        s[WIDENING, i], s[MOMENT, i] = widening, moment
        if not inside:
            s[OUTSIDE, i] = 1.0


@compiled
def spread(order, law, s):
    """Fill the areas of the contacts and their derivatives; only results and sensitivities need them."""
    radius, which, scale, data = law
    plain = data.size == 0
    for i in range(s.shape[1]):
        square = s[SQUARE, i]
        s[FOOTPRINT, i] = s[BY_LOAD, i] = s[BY_CURVATURE, i] = s[BY_SLOPE, i] = 0.0
        if not square > 0.0:
            continue
        s[FOOTPRINT, i] = square
        # for Hertz's law da^2/dp = R/(2 sqrt(R z) b^2), with b = dd/dz
        wider = radius[i] / (s[RATE, i] * s[BEND, i] * s[BEND, i]) if plain else s[WIDENING, i]
        if order > 1 and not plain:
            slope = s[SLOPE_X, i] * s[SLOPE_X, i] + s[SLOPE_Y, i] * s[SLOPE_Y, i]
            (
                s[FOOTPRINT, i], s[BY_LOAD, i], s[BY_CURVATURE, i], s[BY_SLOPE, i]
            ) = contact.on_slope(data, which[i], scale[i], square, wider, slope)  # fmt: skip
            continue
        s[BY_LOAD, i] = wider
        if order > 1:
            s[BY_CURVATURE, i] = -4.0 / 3.0 * square * math.sqrt(square) * wider


@compiled
def respond(field, order, law, self_term, s, closed):
    """Fill all quantities of a state from its nominal indentations z; return the number of contacts."""
    load, u = s[LOAD], s[DISPLACEMENT]
    n = load.size
    fields = s[DISPLACEMENT : SLOPE_Y + 1].reshape(4 * n)
    count = press(law, order, s, closed)
    for i in range(4 * n):
        fields[i] = 0.0
    if order == 1:
        add_rows(field[1], closed, count, load, u)
        for i in range(n):
            u[i] += self_term[i] * load[i]
        return count
    add_rows(field[1], closed, count, load, fields)
    gx, gy = s[SLOPE_X], s[SLOPE_Y]
    for i in range(n):
        u[i] += self_term[i] * load[i] - 0.5 * s[LEVER_RATE, i] * (gx[i] * gx[i] + gy[i] * gy[i])
    sharpen(law, s, closed, count)
    for i in range(n):
        s[SIZE, i] = s[MOMENT, i]
        s[TURN_X, i] = s[LEVER, i] * gx[i]
        s[TURN_Y, i] = s[LEVER, i] * gy[i]
    add_moments(field[0], closed, count, s[SIZE], s[TURN_X], s[TURN_Y], u)
    return count


@compiled
def assemble(field, s, closed, count, matrix):
    """Fill the rows of dF/dp of the contacts, without the diagonal terms of the law and of `self_term`.

    Terms quadratic in the order-3 corrections are omitted here; the residual includes them.
    """
    n = s.shape[1]
    third, tilt_x, tilt_y = s[SIZE], s[TURN_X], s[TURN_Y]
    for i in range(n):
        third[i] = s[SQUARE, i] / 6.0
        tilt_x[i] = s[LEVER_RATE, i] * s[SLOPE_X, i]
        tilt_y[i] = s[LEVER_RATE, i] * s[SLOPE_Y, i]
    for k in range(count):
        j = closed[k]
        bend, x, y = third[j], tilt_x[j], tilt_y[j]
        row, own, other = matrix[j], field[0][j], field[1][j]
        for i in range(n):
            row[i] = (
                own[i]
                + (bend * own[n + i] + third[i] * other[n + i])
                + (x * own[2 * n + i] - tilt_x[i] * other[2 * n + i])
                + (y * own[3 * n + i] - tilt_y[i] * other[3 * n + i])
            )


@compiled
def linearise(field, order, self_term, s, closed, count, y, image):
    """Return y.(d2W/dp2) y with all terms for changes y of the loads; y is zero for open asperities.

    For the contacts, fill (d2W/dp2) y without the fields of the changes of the moments, which the block
    then has.
    """
    n = y.size
    changes = s[CHANGE:SIZE].reshape(4 * n)[: n if order == 1 else 4 * n]
    for i in range(changes.size):
        changes[i] = 0.0
    add_rows(field[1], closed, count, y, changes)
    total = 0.0
    for k in range(count):
        i = closed[k]
        own = changes[i] + (s[BEND, i] / s[RATE, i] + self_term[i]) * y[i]
        if order > 1:
            lap, gx, gy = changes[n + i], changes[2 * n + i], changes[3 * n + i]
            x, square = s[SLOPE_X, i], s[SQUARE, i]
            third, tilt = square / 6.0, s[LEVER_RATE, i]
            # dd/dk = a^2/3 and dM/dk = -16/45 a^5 at fixed load, for every elastic law
            s[SIZE, i] = third * y[i] - 2.0 / 45.0 * square * square * math.sqrt(square) * lap
            s[TURN_X, i] = tilt * y[i] * x + s[LEVER, i] * gx
            s[TURN_Y, i] = tilt * y[i] * s[SLOPE_Y, i] + s[LEVER, i] * gy
            steep = x * x + s[SLOPE_Y, i] * s[SLOPE_Y, i]
            own += third * lap - tilt * (x * gx + s[SLOPE_Y, i] * gy)
            own -= 0.5 * s[LEVER_BEND, i] * steep * y[i]
            total += lap * s[SIZE, i] - (gx * s[TURN_X, i] + gy * s[TURN_Y, i])
        image[i] = own
        total += y[i] * own
    return total


@compiled
def energy(order, law, gap, approach, s, closed, count):
    """Return the complementary energy W [mm^3] of a state."""
    total = 0.0
    plain = law.data.size == 0
    for k in range(count):
        i = closed[k]
        p, extra = s[LOAD, i], 0.5 * s[CURVATURE, i] if order > 1 else 0.0
        if plain:
            total += 0.6 * p * s[INDENTATION, i]
        else:
            total += contact.complementary(
                law.data, law.which[i], law.scale[i], order, s[Z, i], s[SQUARE, i], extra
            )
        total += p * (0.5 * s[DISPLACEMENT, i] - (approach - gap[i]))
        if order > 1:
            slope = s[SLOPE_X, i] ** 2 + s[SLOPE_Y, i] ** 2
            total += 0.25 * p * s[LEVER_RATE, i] * slope - extra * s[MOMENT, i]
    return total


@compiled
def measure(gap, approach, target, s, count):
    """Return the residual of the equations [-] and the load [mm^2].

    The residual is the largest |d + u - e| of a contact, or the largest overlap of an open asperity with the
    plane, divided by the largest d. If `target` is positive, the residual is at least the relative error of
    the load.
    """
    errors = s[SIZE]
    for i in range(gap.size):
        error = s[INDENTATION, i] + s[DISPLACEMENT, i] - (approach - gap[i])
        touching = s[Z, i] > 0.0
        errors[i] = abs(error) if touching else max(s[Z, i] - error, 0.0)
        errors[i] += math.inf if touching and s[OUTSIDE, i] > 0.0 else 0.0
    worst, load = largest(errors), total_of(s[LOAD])
    nothing = 1.0 if worst > 0.0 else 0.0  # no contact, but open summits overlap the plane
    residual = nothing if count == 0 else worst / largest(s[INDENTATION])
    if target > 0.0:
        residual = max(residual, abs(load - target) / target)
    return (residual if math.isfinite(total_of(errors)) else math.inf), load
