"""Load equation of independent power-law caps with their own exponents; all loads are rescaled, P/E* [mm^2].

A cap of the exponent n has the contact radius ``a = b d^(1/n)`` at the indentation d, the area ``pi a^2`` and
the load ``2 n/(n + 1) a d``. The load of all caps is a convex, increasing function of the approach.
"""

from __future__ import annotations

import math

from metafem._kernels.compiled import compiled

# Maximum number of Newton steps. Far above the root, each step reduces the distance to the root by the factor
# 1/(n + 1) at least; near the root, Newton's method converges quadratically.
MAX_STEPS = 200

# Relative Newton step below which the next step is below rounding.
SETTLED = 1e-9


@compiled
def approach_at_load(gap, exponent, logarithm, load, below):
    """Return the approach [mm] at a load; `below` is a lower bound, such as 0. gap: (n,), 0 of the tallest.

    logarithm: ln b, (n,), of b in mm^(1 - 1/n).
    """
    n = exponent[0]
    # upper bound: the first cap, of gap 0, carries the load by itself
    above = math.exp((math.log(0.5 * load * (n + 1.0) / n) - logarithm[0]) * n / (n + 1.0))
    x = above
    for _ in range(MAX_STEPS):
        total = slope = 0.0
        for i in range(gap.size):
            d = x - gap[i]
            if d > 0.0:
                a = math.exp(logarithm[i] + math.log(d) / exponent[i])
                total += exponent[i] / (exponent[i] + 1.0) * a * d
                slope += a
        new = x - (2.0 * total - load) / (2.0 * slope)
        # the tangent of a convex function lies below it, so that steps from above end above the root
        if new < below:
            new = 0.5 * (below + x)
        if x - new <= SETTLED * x:
            return new
        x = new
    return x


@compiled
def sensitivities(gap, exponent, logarithm, turn, scale, power, load, approach, area, by_height, by_exponent):
    """Fill approach and area (k,) at increasing loads (k,), and dA0/dh and dA0/dn at fixed load, (k, n).

    gap, exponent, logarithm, turn: (n,); gap[0] = 0 is that of the tallest. turn: the derivative of ln b with
    respect to the exponent at fixed ln d = 0. scale, power: the "area" of a contact is ``scale a^power``; pi
    and 2 for its true area.
    """
    x = 0.0
    for j in range(load.size):
        x = approach_at_load(gap, exponent, logarithm, load[j], x)
        approach[j] = x
        total = slope = growth = 0.0
        for i in range(gap.size):
            by_height[j, i] = by_exponent[j, i] = 0.0
            d = x - gap[i]
            if d > 0.0:
                n = exponent[i]
                rest = math.log(d)
                a = math.exp(logarithm[i] + rest / n)
                part = scale * a**power
                total += part
                slope += 2.0 * a
                growth += power * part / (n * d)
        area[j] = total
        ratio = growth / slope
        for i in range(gap.size):
            d = x - gap[i]
            if d > 0.0:
                n = exponent[i]
                rest = math.log(d)
                a = math.exp(logarithm[i] + rest / n)
                part = power * scale * a**power
                by_height[j, i] = part / (n * d) - ratio * 2.0 * a
                wider = turn[i] - rest / (n * n)  # d ln a/dn
                load_change = 2.0 * n / (n + 1.0) * a * d * (wider + 1.0 / (n * (n + 1.0)))
                by_exponent[j, i] = part * wider - ratio * load_change
