"""Contact laws for kernels, for unit E*: Hertz's law in closed form, and other laws from tables.

The nominal indentation z of a contact with load p is the indentation at which the law without extra curvature
has this load. A table contains, as functions of ln z, ln p, ln a^2, the logarithm of the complementary energy
``int_0^z z dp`` and, for elastic laws, that of the second moment M of the pressure. All lengths are divided
by a scale. z is then the integral D(a) of the cap (`metafem.caps.Cap`), with loads P(a), and the table is
read at other a as well. The logarithm of a power law is a straight line, so straight lines continue the table
beyond both ends.

If the neighbours add the curvature k, a contact with load p has the radius a with ``P(a) + 4/3 k a^3 = p``.
Then ``d = D + k a^2``, ``M = M(a) + 8/15 k a^5``, ``dd/dp = 1/(2 a)`` and ``da^2/dp = 1/(D' + 2 k a)``. A
slope g adds the energy ``-T g^2`` with ``T(p) = 2/3 a^3``, where a is the contact radius without curvature.

The slope also changes the area. A circular contact of any radius a, indented by d, moves on the slope by the
distance e that makes the energy stationary,

    U(a, e) = int_0^a (d - g e - D - e^2 D''/4)^2 ds + 1/2 int_0^a (e D' + 2 g s)^2 ds + constant,

which is ``e = -2 a g/D'`` for any d. Then ``U = int_0^a (d - D)^2 ds + g^2 (2/3 a^3 + 2 a^2 (d - D(a))/D')``
to second order in g, and dU/da = 0 gives d, and with P = dU/dd the load. At a given load the area is
``pi a^2 (1 - 2 y)`` with ``y = (a D''/D' - 1) (g/D')^2``, where the curvature k is part of D. It is unchanged
for paraboloids.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels.compiled import compiled

# Hertz's law: P = LOAD a d and dP/dd = STIFFNESS a. Sums over contacts are multiplied once, at the end.
LOAD, STIFFNESS = 4.0 / 3.0, 2.0

# Smallest curvature of a summit flattened by its neighbours, divided by its own curvature. Below it the
# expansion is not valid. For Hertz's law the ratio is 1 + k R.
LEAST_CURVATURE = 0.1

# Maximum number of steps for a contact radius or an indentation; few are needed, as logarithms are nearly
# linear.
MAX_STEPS = 40

# Coefficients of a quintic polynomial, and the place of each function in those of a panel, after ln p.
COEFFICIENTS = 6
SQUARE, ENERGY, MOMENT, PANEL = 6, 12, 18, 24

# Number of values before the segments of a table.
HEADER = 5


class Law(NamedTuple):
    """Contact laws of the asperities of one surface, arrays (n,), or of many surfaces, arrays (m, n).

    A row of `data` is a table. It begins with the largest indentation, three numbers for T (the load up to
    which it is proportional to p, its slope there, and its offset above) and the number of segments. A
    segment is a range of ln z with panels of equal width: the smallest ln z, the width, the number of panels,
    and where the first panel begins. A panel has the polynomials of ln p, ln a^2, and the logarithms of the
    complementary energy and of M, of the distance from its lower edge, the constant term first.
    """

    radius: np.ndarray  # radius of each summit [mm]
    which: np.ndarray  # row in `data` of the table of each asperity; -1 for Hertz's law
    scale: np.ndarray  # length [mm] by which lengths in the table of each asperity are divided
    data: np.ndarray  # tables; empty for Hertz's law


def hertz_law(radius: np.ndarray) -> Law:
    """Return Hertz's law for radii (..., n) [mm]."""
    return Law(radius, np.full(radius.shape, -1), radius, np.empty((0, 0)))


@compiled
def contact_radius(radius, indentation):
    """Return a = sqrt(R d) [mm] of Hertz's law."""
    return math.sqrt(radius * indentation)


@compiled
def part(law, row):
    """Return the law of surface `row`, from the law of many surfaces."""
    return Law(law.radius[row], law.which[row], law.scale[row], law.data)


@compiled
def panel(data, at, x):
    """Return where the panel of x begins, and the distance of x from its lower edge.

    The distance is limited to the width of the panel; a third number is the distance of x beyond it.
    """
    low, high = 0, int(data[at, HEADER - 1])
    while high - low > 1:
        middle = (low + high) // 2
        if x >= data[at, HEADER + 4 * middle]:
            low = middle
        else:
            high = middle
    first = HEADER + 4 * low
    t, width = x - data[at, first], data[at, first + 1]
    k = int(min(max(t / width, 0.0), data[at, first + 2] - 1.0))
    t -= k * width
    inside = min(max(t, 0.0), width)
    return int(data[at, first + 3]) + PANEL * k, inside, t - inside


@compiled
def line(data, at, first, t, beyond):
    """Return a polynomial at t, continued by a straight line over `beyond`, and its derivative."""
    f = f1 = 0.0
    for j in range(COEFFICIENTS - 1, -1, -1):
        f1 = f1 * t + f
        f = f * t + data[at, first + j]
    return f + f1 * beyond, f1


@compiled
def curve(data, at, first, t, beyond):
    """Return the results of `line`, and the second and third derivatives, which are 0 beyond the table."""
    f = f1 = f2 = f3 = 0.0
    for j in range(COEFFICIENTS - 1, -1, -1):
        f3 = f3 * t + f2
        f2 = f2 * t + f1
        f1 = f1 * t + f
        f = f * t + data[at, first + j]
    inside = 1.0 if beyond == 0.0 else 0.0
    return f + f1 * beyond, f1, 2.0 * f2 * inside, 6.0 * f3 * inside


@compiled
def covers(data, at, scale, z):
    """Return whether a table includes a nominal indentation."""
    return z <= data[at, 0] * scale


@compiled
def load_and_rate(data, at, scale, z):
    """Return p [mm^2] and dp/dz [mm] at z > 0."""
    first, t, beyond = panel(data, at, math.log(z / scale))
    f, f1 = line(data, at, first, t, beyond)
    p = math.exp(f) * scale * scale
    return p, p * f1 / z


@compiled
def pressed(data, at, scale, z):
    """Return p, dp/dz, a^2 and da^2/dp at a nominal indentation z > 0."""
    first, t, beyond = panel(data, at, math.log(z / scale))
    f, f1 = line(data, at, first, t, beyond)
    g, g1 = line(data, at, first + SQUARE, t, beyond)
    p, square = math.exp(f) * scale * scale, math.exp(g) * scale * scale
    return p, p * f1 / z, square, square * g1 / (p * f1)


@compiled
def tilted(data, at, scale, z):
    """Return p, dp/dz, a^2, da^2/dp, 2 T, 2 dT/dp and 2 d2T/dp2 at a nominal indentation z > 0."""
    first, t, beyond = panel(data, at, math.log(z / scale))
    f, f1, f2, _ = curve(data, at, first, t, beyond)
    g, g1, g2, _ = curve(data, at, first + SQUARE, t, beyond)
    p, square = math.exp(f), math.exp(g)
    inverse = 1.0 / (p * f1)
    widening = square * g1 * inverse
    area = scale * scale
    if p <= data[at, 1]:
        rate, bend = data[at, 2], 0.0
        lever = rate * p
    else:
        a = math.sqrt(square)
        rate = a * widening
        bend = rate * (1.5 * g1 - f1 + (g2 / g1 - f2 / f1)) * inverse
        lever = 2.0 / 3.0 * square * a + data[at, 3]
    return (
        p * area, p * area * f1 / z, square * area, widening,
        2.0 * lever * area * scale, 2.0 * rate * scale, 2.0 * bend / scale,
    )  # fmt: skip


@compiled
def bent(data, at, scale, load, square, widening, curvature):
    """Return a^2, d, dd/dz, da^2/dp and M/4 of a contact with extra curvature k, and whether k is in range.

    load, square, widening: values at the nominal indentation; curvature: k [1/mm].
    """
    per_scale = 1.0 / scale
    k, p, a0 = curvature * scale, load * per_scale * per_scale, math.sqrt(square) * per_scale
    # d ln a/d ln P = (P/2 a) da^2/dP; for a local power law of exponent n this is 1/(n + 1)
    share = 0.5 * load * widening / square
    exponent = 1.0 / share - 1.0
    inside = True
    if k < 0.0:
        # D' = (dP/da)/(2 a)
        least = (LEAST_CURVATURE - 1.0) * 0.25 * p / (share * a0 * a0 * a0)
        # a flat summit that just touches is flattened by any small field: its k is always in range
        inside = k > least or p <= data[at, 1]
        k = max(k, least)
    extra = 4.0 / 3.0 * k * a0 * a0 * a0 / p
    if abs(extra) <= 0.1:  # a good first guess: ln a to second order in `extra`, for a local power law
        wider = -share * extra * (1.0 + extra * (0.5 - 3.0 * share))
    else:  # both P(a) = p and 4/3 k a^3 = p give larger radii than their sum
        wider = min(0.0, -math.log(extra) / 3.0) if k > 0.0 else 0.0
    y = math.log(0.5 * p / (a0 * (1.0 - share))) + exponent * wider  # ln D, exact for a power law with k = 0
    for _ in range(MAX_STEPS):
        first, t, beyond = panel(data, at, y)
        f, f1, f2, _ = curve(data, at, first, t, beyond)
        g, g1, g2, _ = curve(data, at, first + SQUARE, t, beyond)
        own, extra = math.exp(f), 4.0 / 3.0 * k * math.exp(1.5 * g)
        total = own + extra
        step = 0.5
        if total > 0.0:  # Chebyshev's method, of third order
            h1 = (own * f1 + 1.5 * extra * g1) / total
            h2 = (own * (f1 * f1 + f2) + extra * (2.25 * g1 * g1 + 1.5 * g2)) / total - h1 * h1
            step = math.log(total / p) / h1
            step = min(max(-step * (1.0 + 0.5 * step * h2 / h1), -0.5 * exponent), 0.5 * exponent)
        y += step
        if abs(step) <= 1e-5:  # the next step, about the cube, is below rounding
            break
    t += step
    g, g1 = line(data, at, first + SQUARE, t, beyond)
    w, _ = line(data, at, first + MOMENT, t, beyond)
    depth, wide = math.exp(y), math.exp(g)
    a = math.sqrt(wide)
    slope = 2.0 * depth / (g1 * a) + 2.0 * k * a
    moment = math.exp(w) + 8.0 / 15.0 * k * wide * wide * a
    area = scale * scale
    return (
        wide * area, (depth + k * wide) * scale, a0 / a, 1.0 / slope, 0.25 * moment * area * area, inside
    )  # fmt: skip


@compiled
def at_square(data, at, square, start):
    """Return ln D and the panel of a contact radius, from a^2 and a first guess of D, all over the scale."""
    x, goal = math.log(start), math.log(square)
    for _ in range(MAX_STEPS):
        first, t, beyond = panel(data, at, x)
        g, g1 = line(data, at, first + SQUARE, t, beyond)
        step = (goal - g) / g1
        x += step
        if abs(step) <= 1e-8:  # the next step, about the square, is below rounding
            break
    return x, first, t + step, beyond


@compiled
def on_slope(data, at, scale, square, widening, steepness):
    """Return A/pi of a contact on a slope g, and its derivatives with respect to p, k and g^2.

    square, widening: a^2 [mm^2] and da^2/dp = 1/(D' + 2 k a), without the slope; steepness: g^2.
    ``A/pi = a^2 F(y)``, with y from the head of the module. For D convex in a^2 (y > 0), F = 1/sqrt(1 + 4 y),
    which is ``1 - 2 y`` to first order and positive for any slope; else F = 1 - 2 y.
    """
    a = math.sqrt(square) / scale
    x, first, t, beyond = at_square(data, at, a * a, 0.5 * a / widening)
    _, g1, g2, g3 = curve(data, at, first + SQUARE, t, beyond)
    # derivatives of ln D with respect to ln a, the inverse of half the logarithm of a^2
    f1, depth = 2.0 / g1, math.exp(x)
    f2 = -g2 / g1 * f1 * f1
    f3 = (3.0 * (g2 / g1) ** 2 - g3 / g1) * f1**3
    # E = a^2 D'' - a D', and a dE/da; both are without k, as for every paraboloid
    bend = depth * (f1 * f1 + f2 - 2.0 * f1)
    bend_rate = depth * (f1 * (f1 * f1 + 3.0 * f2) + f3 - 2.0 * (f1 * f1 + f2))
    per_slope = widening**3 / a  # 1/(a (D' + 2 k a)^3)
    y_rate = bend * per_slope  # dy/dg^2
    y = y_rate * steepness
    y_radius = bend_rate * per_slope * steepness - y * (4.0 + 3.0 * bend * widening / a)  # a dy/da at fixed k
    factor = 1.0 / math.sqrt(1.0 + 4.0 * y) if y > 0.0 else 1.0 - 2.0 * y
    rate = -2.0 * factor**3 if y > 0.0 else -2.0  # dF/dy
    by_load = widening * (factor + 0.5 * rate * y_radius)
    # at given p, da^2/dk = -4/3 a^3 da^2/dp
    by_curvature = scale * a * (-4.0 / 3.0 * a * a * scale * scale * by_load)
    by_curvature += square * rate * (-6.0 * y * a * widening * scale)
    return square * factor, by_load, by_curvature, square * rate * y_rate


@compiled
def complementary(data, at, scale, order, z, square, curvature):
    """Return the complementary energy int_0^p d dp [mm^3] of a contact with the extra curvature k."""
    k, a, x = curvature * scale, math.sqrt(square) / scale, math.log(z / scale)
    first, t, beyond = panel(data, at, x)
    if order > 1:
        x, first, t, beyond = at_square(data, at, a * a, z / scale)
    energy = math.exp(line(data, at, first + ENERGY, t, beyond)[0])
    if order == 1:
        return energy * scale**3
    moment, depth = math.exp(line(data, at, first + MOMENT, t, beyond)[0]), math.exp(x)
    # w = a d^2 - int_0^a (D + k s^2)^2 ds
    squares = a * depth * depth - energy
    mixed = (a**3 * depth - 0.75 * moment) / 3.0
    d = depth + k * a * a
    return (a * d * d - squares - 2.0 * k * mixed - 0.2 * k * k * a**5) * scale**3


@compiled
def indentation_at_load(data, at, scale, load):
    """Return the nominal indentation z [mm] at a load [mm^2]."""
    goal = math.log(load / scale**2)
    x = data[at, HEADER]
    for _ in range(MAX_STEPS):
        first, t, beyond = panel(data, at, x)
        f, f1 = line(data, at, first, t, beyond)
        step = (f - goal) / f1
        x -= step
        if abs(step) <= 1e-8:  # the next step, about the square, is below rounding
            break
    return math.exp(x) * scale


@compiled
def alone(law, i, load):
    """Return the indentation [mm] at which asperity i carries a load [mm^2] by itself."""
    if law.data.size > 0:
        return indentation_at_load(law.data, law.which[i], law.scale[i], load)
    return (load / (LOAD * math.sqrt(law.radius[i]))) ** (2.0 / 3.0)
