"""Any contact law for kernels, all for unit E*: Hertz's in closed form, every other one from tables.

The nominal indentation z of a contact is that at which the law without extra curvature carries its load p.
A table holds ln p, ln a^2 and the logarithm of the complementary energy ``int_0^z z dp`` over ln z; and,
for elastic laws, ln D, ln P and ln M (`metafem.contact.caps`) over ln a, all with lengths over a scale.
Logarithms of powers are straight lines, which continue the table on both sides.

With the curvature k by the neighbours, the contact radius a of a load p follows from
``P(a) + 4/3 k a^3 = p``. Then ``d = D + k a^2``, ``M = M(a) + 8/15 k a^5``, ``dd/dp = 1/(2 a)``,
``da^2/dp = 1/(D' + 2 k a)``. The energy of a slope g is ``-T g^2`` with ``T(p) = 2/3 a^3``, a that without
curvature.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels.compiled import compiled, inner

# Smallest sharpness of a summit that neighbours flatten, in parts of its own: beyond is outside the range of
# the expansion. Without tables it is that of the curvature, k R.
LEAST_CURVATURE = 0.1

# Largest number of steps for a contact radius or indentation; the logarithms are nearly linear.
MAX_STEPS = 40

# A step of Halley's method in a logarithm below which the next one, its cube, is below rounding; and the same
# of Newton's, whose next one is its square.
SETTLED, SETTLED_SQUARE = 1e-5, 1e-8

# Largest part of the load by the curvature of which the first guess of a contact radius uses powers.
MOST_EXTRA = 0.5


# A row of `Law.data` begins with the largest indentation, the three numbers of T, and where the panels over
# ln z and over ln a begin. Each of these two parts holds the number of panels, that of bins of equal width,
# the least argument, the inverse width of a bin, the first panel of each bin, the edges, and for each panel
# three polynomials of the place in it with this number of coefficients, the lowest first.
DEEPEST, LEVER_EDGE, LEVER_START, LEVER_OFFSET, BY_DEPTH, BY_RADIUS, HEADER = range(7)
COEFFICIENTS = 8


class Law(NamedTuple):
    """Contact law of the asperities (n,), or of those of many surfaces (m, n)."""

    radius: np.ndarray  # of the summits [mm]
    which: np.ndarray  # row of the tables of each asperity; negative for Hertz's law
    scale: np.ndarray  # length of its table [mm]
    data: np.ndarray  # tables, one in a row


@compiled
def part(law, row):
    """Return the law of one surface of many."""
    return Law(law.radius[row], law.which[row], law.scale[row], law.data)


@inner
def panel(data, at, part, x):
    """Return where the polynomials of the panel of x begin, half its width, and the place of x in it.

    The place is between -1 and 1; the last number is by how much x is beyond it.
    """
    start = int(data[at, part])
    panels, bins = int(data[at, start]), int(data[at, start + 1])
    place = (x - data[at, start + 2]) * data[at, start + 3]
    k = int(data[at, start + 4 + min(max(int(place), 0), bins - 1)])
    edges = start + 4 + bins
    while k + 1 < panels and x >= data[at, edges + k + 1]:
        k += 1
    lower, upper = data[at, edges + k], data[at, edges + k + 1]
    half = 0.5 * (upper - lower)
    free = (x - lower) / half - 1.0
    t = min(max(free, -1.0), 1.0)
    return edges + panels + 1 + 3 * COEFFICIENTS * k, half, t, free - t


@inner
def line(data, at, first, t, beyond):
    """Return a polynomial and its derivative by t, a straight line beyond the ends of its panel.

    Even and odd powers apart, v = e(t^2) + t o(t^2), which a processor computes at the same time.
    """
    u = t * t
    e = o = e1 = o1 = 0.0
    for k in range(COEFFICIENTS // 2 - 1, -1, -1):
        e1 = e1 * u + e
        o1 = o1 * u + o
        e = e * u + data[at, first + 2 * k]
        o = o * u + data[at, first + 2 * k + 1]
    slope = 2.0 * t * e1 + (o + 2.0 * u * o1)
    return e + t * o + slope * beyond, slope


@inner
def curve(data, at, first, t, beyond):
    """Return the same with the second derivative."""
    u = t * t
    e = o = e1 = o1 = e2 = o2 = 0.0
    for k in range(COEFFICIENTS // 2 - 1, -1, -1):
        e2 = e2 * u + e1
        o2 = o2 * u + o1
        e1 = e1 * u + e
        o1 = o1 * u + o
        e = e * u + data[at, first + 2 * k]
        o = o * u + data[at, first + 2 * k + 1]
    slope = 2.0 * t * e1 + (o + 2.0 * u * o1)
    bend = 2.0 * e1 + 8.0 * u * e2 + t * (6.0 * o1 + 8.0 * u * o2)
    return e + t * o + slope * beyond, slope, bend if beyond == 0.0 else 0.0


@compiled
def covers(data, at, scale, z):
    """Return whether a table reaches a nominal indentation."""
    return z <= data[at, DEEPEST] * scale


@compiled
def load_and_rate(data, at, scale, z):
    """Return p [mm^2] and dp/dz [mm] at z > 0."""
    first, half, t, beyond = panel(data, at, BY_DEPTH, math.log(z / scale))
    f, f1 = line(data, at, first, t, beyond)
    p = math.exp(f) * scale * scale
    return p, p * f1 / (half * z)


@compiled
def pressed(data, at, scale, z):
    """Return p, dp/dz, a^2 and da^2/dp at a nominal indentation z > 0."""
    first, half, t, beyond = panel(data, at, BY_DEPTH, math.log(z / scale))
    f, f1 = line(data, at, first, t, beyond)
    g, g1 = line(data, at, first + COEFFICIENTS, t, beyond)
    p, square = math.exp(f) * scale * scale, math.exp(g) * scale * scale
    return p, p * f1 / (half * z), square, square * g1 / (p * f1)


@compiled
def levers(data, at, scale, z, p, square, widening):
    """Return 2 T, 2 dT/dp and 2 d2T/dp2 of a contact."""
    p, square = p / (scale * scale), square / (scale * scale)
    if p <= data[at, LEVER_EDGE]:
        start = 2.0 * data[at, LEVER_START] * scale
        return start * p * scale * scale, start, 0.0
    first, _, t, beyond = panel(data, at, BY_DEPTH, math.log(z / scale))
    _, f1, f2 = curve(data, at, first, t, beyond)
    _, g1, g2 = curve(data, at, first + COEFFICIENTS, t, beyond)
    a = math.sqrt(square)
    rate = a * widening
    bend = rate * (1.5 * g1 - f1 + (g2 / g1 - f2 / f1)) / (p * f1)
    lever = 2.0 / 3.0 * square * a + data[at, LEVER_OFFSET]
    return 2.0 * lever * scale**3, 2.0 * rate * scale, 2.0 * bend / scale


@compiled
def bent(data, at, scale, load, square, widening, curvature):
    """Return a^2, d, dd/dz, da^2/dp and M/4 of a contact with an extra curvature, and whether it is in range.

    load, square, widening: those of the nominal indentation; curvature: k [1/mm].
    """
    k, p, a0 = curvature * scale, load / scale**2, math.sqrt(square) / scale
    y = math.log(a0)
    # d ln P/d ln a = 2 a dP/da^2
    power = 2.0 * square / (load * widening)
    inside = True
    if k < 0.0:
        # D' = (dP/da)/(2 a)
        least = (LEAST_CURVATURE - 1.0) * 0.5 * (0.5 * p * power / (a0 * a0)) / a0
        # a flat summit that just touches is flattened by any small field
        inside = k > least or p <= data[at, LEVER_EDGE]
        k = max(k, least)
    extra = 4.0 / 3.0 * k * a0 * a0 * a0 / p
    if extra <= MOST_EXTRA:  # Halley's step for powers of a
        total = 1.0 + extra
        h, h1 = math.log(total), (power + 3.0 * extra) / total
        h2 = (power * power + 9.0 * extra) / total - h1 * h1
        y -= 2.0 * h * h1 / (2.0 * h1 * h1 - h * h2)
    else:  # each of the two parts alone would have a larger radius
        y = min(y, math.log(0.75 * p / k) / 3.0)
    for _ in range(MAX_STEPS):
        a = math.exp(y)
        first, half, t, beyond = panel(data, at, BY_RADIUS, y)
        g, g1, g2 = curve(data, at, first + COEFFICIENTS, t, beyond)
        own, extra = math.exp(g), 4.0 / 3.0 * k * a * a * a
        g1, g2 = g1 / half, g2 / (half * half)
        total = own + extra
        if not total > 0.0:
            y += 0.5
            continue
        h, h1 = math.log(total / p), (own * g1 + 3.0 * extra) / total
        h2 = (own * (g1 * g1 + g2) + 9.0 * extra) / total - h1 * h1
        step = -2.0 * h * h1 / (2.0 * h1 * h1 - h * h2)
        y += min(max(step, -0.5), 0.5)
        if abs(step) <= SETTLED:
            break
    t += step / half
    a *= 1.0 + step * (1.0 + 0.5 * step)
    f, f1 = line(data, at, first, t, beyond)
    w, _ = line(data, at, first + 2 * COEFFICIENTS, t, beyond)
    depth, wide = math.exp(f), a * a
    slope = depth * f1 / (half * a) + 2.0 * k * a
    moment = math.exp(w) + 8.0 / 15.0 * k * wide * wide * a
    area = scale * scale
    return (
        wide * area, (depth + k * wide) * scale, a0 / a, 1.0 / slope, 0.25 * moment * area * area, inside
    )  # fmt: skip


@compiled
def complementary(data, at, scale, order, z, square, curvature):
    """Return the complementary energy int_0^p d dp [mm^3] of a contact with an extra curvature."""
    if order == 1:
        first, _, t, beyond = panel(data, at, BY_DEPTH, math.log(z / scale))
        w, _ = line(data, at, first + 2 * COEFFICIENTS, t, beyond)
        return math.exp(w) * scale**3
    k, a = curvature * scale, math.sqrt(square) / scale
    first, _, t, beyond = panel(data, at, BY_RADIUS, math.log(a))
    f, _ = line(data, at, first, t, beyond)
    h, _ = line(data, at, first + 2 * COEFFICIENTS, t, beyond)
    first, _, t, beyond = panel(data, at, BY_DEPTH, f)
    w, _ = line(data, at, first + 2 * COEFFICIENTS, t, beyond)
    depth = math.exp(f)
    # w = a d^2 - int_0^a (D + k s^2)^2 ds
    squares = a * depth * depth - math.exp(w)
    mixed = (a**3 * depth - 0.75 * math.exp(h)) / 3.0
    d = depth + k * a * a
    return (a * d * d - squares - 2.0 * k * mixed - 0.2 * k * k * a**5) * scale**3


@compiled
def indentation_at_load(data, at, scale, load):
    """Return the nominal indentation z [mm] of a load [mm^2]."""
    goal = math.log(load / scale**2)
    x = data[at, int(data[at, BY_DEPTH]) + 2]
    for _ in range(MAX_STEPS):
        first, half, t, beyond = panel(data, at, BY_DEPTH, x)
        f, f1 = line(data, at, first, t, beyond)
        step = (f - goal) * half / f1
        x -= step
        if abs(step) <= SETTLED_SQUARE:
            break
    return math.exp(x) * scale
