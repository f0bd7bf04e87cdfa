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

from metafem._kernels.compiled import compiled
from metafem._kernels.contact import hertz

# Smallest sharpness of a summit that neighbours flatten, in parts of its own: beyond is outside the range of
# the expansion. Without tables it is that of the curvature, k R.
LEAST_CURVATURE = 0.1

# Largest number of Newton steps for a contact radius or indentation; the logarithms are nearly linear.
MAX_STEPS = 40

# A step of Newton's method in a logarithm below which the next one is below rounding.
SETTLED = 1e-8


class Law(NamedTuple):
    """Contact law of the asperities (n,), with T tables of m panels and polynomials of K coefficients."""

    radius: np.ndarray  # of the summits [mm]
    which: np.ndarray  # table of each asperity; negative for Hertz's law
    scale: np.ndarray  # length of its table [mm]
    depth_edge: np.ndarray  # edges of the panels in ln z, (T, m + 1), increasing
    depth_value: np.ndarray  # ln p, ln a^2 and ln energy, (T, m, 3, K)
    radius_edge: np.ndarray  # edges in ln a, (T, m + 1); empty for laws of order 1
    radius_value: np.ndarray  # ln D, ln P and ln M
    deepest: np.ndarray  # largest indentation over the scale, (T,)
    panels: np.ndarray  # numbers of panels, (T, 2)
    lever_edge: np.ndarray  # load below which T is proportional to the load, (T,)
    lever_start: np.ndarray  # T/p there, (T,)
    lever_offset: np.ndarray  # what is added to 2/3 a^3 beyond, (T,)


@compiled
def part(law, row):
    """Return the law of one surface of many, whose radius, which and scale are (m, n)."""
    return Law(
        law.radius[row], law.which[row], law.scale[row], law.depth_edge, law.depth_value, law.radius_edge,
        law.radius_value, law.deepest, law.panels, law.lever_edge, law.lever_start, law.lever_offset,
    )  # fmt: skip


@compiled
def panel(edge, x):
    """Return the panel of x, the half of its width, and the place of x in it from -1 to 1, clipped."""
    low, high = 0, edge.size - 1
    while high - low > 1:
        middle = (low + high) // 2
        if x < edge[middle]:
            high = middle
        else:
            low = middle
    half = 0.5 * (edge[high] - edge[low])
    t = (x - 0.5 * (edge[high] + edge[low])) / half
    return low, half, min(max(t, -1.0), 1.0), t


@compiled
def value(polynomial, t):
    """Return a polynomial and its first two derivatives by t."""
    v = s = b = 0.0
    for k in range(polynomial.size):
        b = b * t + s
        s = s * t + v
        v = v * t + polynomial[k]
    return v, s, 2.0 * b


@compiled
def logarithms(edge, polynomial, x):
    """Return the first two functions of a table with two derivatives by x, straight lines beyond its ends."""
    k, half, t, free = panel(edge, x)
    f, f1, f2 = value(polynomial[k, 0], t)
    g, g1, g2 = value(polynomial[k, 1], t)
    if free != t:
        f, g, f2, g2 = f + f1 * (free - t), g + g1 * (free - t), 0.0, 0.0
    return f, f1 / half, f2 / half**2, g, g1 / half, g2 / half**2


@compiled
def third(edge, polynomial, x):
    """Return the third function of a table."""
    k, _, t, free = panel(edge, x)
    f, f1, _ = value(polynomial[k, 2], t)
    return f + f1 * (free - t)


@compiled
def load_and_rate(law, i, z):
    """Return p [mm^2] and dp/dz [mm] at z > 0."""
    at = law.which[i]
    if at < 0:
        a = hertz.contact_radius(law.radius[i], z)
        return hertz.LOAD * a * z, hertz.STIFFNESS * a
    scale = law.scale[i]
    edge, x = law.depth_edge[at, : law.panels[at, 0] + 1], math.log(z / scale)
    k, half, t, free = panel(edge, x)
    f, f1, _ = value(law.depth_value[at, k, 0], t)
    p = math.exp(f + f1 * (free - t)) * scale * scale
    return p, p * f1 / (half * z)


@compiled
def covers(law, i, z):
    """Return whether the table of a contact reaches its nominal indentation."""
    at = law.which[i]
    return at < 0 or z <= law.deepest[at] * law.scale[i]


@compiled
def nominal(law, i, z):
    """Return p, dp/dz, a^2, da^2/dp, 2 T, 2 dT/dp and 2 d2T/dp2 at a nominal indentation z > 0."""
    at = law.which[i]
    if at < 0:
        radius = law.radius[i]
        square = radius * z
        rate = hertz.STIFFNESS * math.sqrt(square)
        load = hertz.load(radius, z)
        return load, rate, square, radius / rate, load * radius, radius, 0.0
    scale = law.scale[i]
    f, f1, f2, g, g1, g2 = logarithms(
        law.depth_edge[at, : law.panels[at, 0] + 1], law.depth_value[at], math.log(z / scale)
    )
    p, square = math.exp(f), math.exp(g)
    widening = square * g1 / (p * f1)
    if p <= law.lever_edge[at]:
        lever, lever_rate, lever_bend = law.lever_start[at] * p, law.lever_start[at], 0.0
    else:
        a = math.sqrt(square)
        lever = 2.0 / 3.0 * square * a + law.lever_offset[at]
        lever_rate = a * widening
        lever_bend = lever_rate * (1.5 * g1 - f1 + g2 / g1 - f2 / f1) / (p * f1)
    return (
        p * scale * scale, p * f1 / z * scale * scale, square * scale * scale, widening,
        2.0 * lever * scale**3, 2.0 * lever_rate * scale, 2.0 * lever_bend / scale,
    )  # fmt: skip


@compiled
def untilted(law, i):
    """Return 2 dT/dp [mm] of an open contact."""
    at = law.which[i]
    return law.radius[i] if at < 0 else 2.0 * law.lever_start[at] * law.scale[i]


@compiled
def bent(law, i, z, load, square, curvature):
    """Return a^2, d, dd/dz, da^2/dp and M/4 of a contact with an extra curvature, and whether it is in range.

    load, square: those of the nominal indentation z; curvature: k [1/mm].
    """
    at = law.which[i]
    if at < 0:
        radius = law.radius[i]
        cube = 1.0 + radius * curvature
        bend = np.cbrt(max(cube, LEAST_CURVATURE))
        wide = radius * z / (bend * bend)
        root = hertz.STIFFNESS * math.sqrt(radius * z)
        return wide, z * bend, bend, radius / (root * bend * bend), 0.1 * load * wide, cube > LEAST_CURVATURE
    scale = law.scale[i]
    k, p, a0 = curvature * scale, load / scale**2, math.sqrt(square) / scale
    y = math.log(a0)
    edge, table = law.radius_edge[at, : law.panels[at, 1] + 1], law.radius_value[at]
    inside = True
    if k < 0.0:
        f, f1, _, _, _, _ = logarithms(edge, table, y)
        least = (LEAST_CURVATURE - 1.0) * 0.5 * math.exp(f) * f1 / (a0 * a0)
        # a flat summit that just touches is flattened by any small field
        inside = k > least or p <= law.lever_edge[at]
        k = max(k, least)
    else:  # each of the two parts alone would have a larger radius
        y = min(y, math.log(0.75 * p / k) / 3.0) if k > 0.0 else y
    for _ in range(MAX_STEPS):
        a = math.exp(y)
        _, _, _, g, g1, _ = logarithms(edge, table, y)
        own, extra = math.exp(g), 4.0 / 3.0 * k * a**3
        total = own + extra
        step = math.log(total / p) * total / (own * g1 + 3.0 * extra) if total > 0.0 else -0.5
        y -= min(max(step, -0.5), 0.5)
        if abs(step) <= SETTLED:
            break
    a = math.exp(y)
    f, f1, _, _, _, _ = logarithms(edge, table, y)
    depth = math.exp(f)
    slope = depth * f1 / a + 2.0 * k * a
    moment = math.exp(third(edge, table, y)) + 8.0 / 15.0 * k * a**5
    return (
        (a * scale) ** 2, (depth + k * a * a) * scale, a0 / a, 1.0 / slope, 0.25 * moment * scale**4, inside
    )  # fmt: skip


@compiled
def complementary(law, order, i, z, load, indentation, square, curvature):
    """Return the complementary energy int_0^p d dp [mm^3] of a contact with an extra curvature."""
    at = law.which[i]
    if at < 0:
        return 0.6 * load * indentation
    scale = law.scale[i]
    edge, table = law.depth_edge[at, : law.panels[at, 0] + 1], law.depth_value[at]
    if order == 1:
        return math.exp(third(edge, table, math.log(z / scale))) * scale**3
    k, a = curvature * scale, math.sqrt(square) / scale
    y = math.log(a)
    f, _, _, _, _, _ = logarithms(law.radius_edge[at, : law.panels[at, 1] + 1], law.radius_value[at], y)
    moment = math.exp(third(law.radius_edge[at, : law.panels[at, 1] + 1], law.radius_value[at], y))
    depth = math.exp(f)
    # w = a d^2 - int_0^a (D + k s^2)^2 ds
    squares = a * depth * depth - math.exp(third(edge, table, f))
    mixed = (a**3 * depth - 0.75 * moment) / 3.0
    d = depth + k * a * a
    return (a * d * d - squares - 2.0 * k * mixed - 0.2 * k * k * a**5) * scale**3


@compiled
def indentation_at_load(law, i, load):
    """Return the nominal indentation z [mm] of a load [mm^2]."""
    at = law.which[i]
    if at < 0:
        return hertz.indentation_at_load(law.radius[i], load)
    scale = law.scale[i]
    goal = math.log(load / scale**2)
    edge, table = law.depth_edge[at, : law.panels[at, 0] + 1], law.depth_value[at]
    x = edge[0]
    for _ in range(MAX_STEPS):
        f, f1, _, _, _, _ = logarithms(edge, table, x)
        step = (f - goal) / f1
        x -= step
        if abs(step) <= SETTLED:
            break
    return math.exp(x) * scale
