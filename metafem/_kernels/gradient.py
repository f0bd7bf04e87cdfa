"""Sensitivity of A0 to the heights of coupled contacts.

At an equilibrium dW/dp = 0, with the energy W of `equations`. A change dh of the heights changes the loads of
the contacts by dp, with ``H dp = dh - d delta`` and H = d2W/dp2. The change d delta of the separation is such
that the sum of the loads is constant. With the gradient c = dA0/dp, dA0/dh is the solution l of

    H l = c + x 1,  sum l = 0.

The matrix of Newton's method, which omits small terms of H, corrects l until it solves this with H itself.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.equations import (
    BY_CURVATURE,
    BY_LOAD,
    BY_SLOPE,
    SIZE,
    SLOPE_X,
    SLOPE_Y,
    TURN_X,
    TURN_Y,
    Z,
    add_moments,
    copy,
    linearise,
    respond,
    spread,
)
from metafem._kernels.newton import IMAGE, INNER, RHS, STEP_LOADS, refresh, solve
from metafem._kernels.vectors import largest

# Largest change of the gradient by the last correction, relative to the gradient, and maximum number of
# corrections; each reduces the error by the relative size of the omitted terms, 1e-2 or less.
TOLERANCE = 1e-11
MAX_CORRECTIONS = 30


@compiled
def area_gradients(field, order, law, self_term, indentation, s, closed, matrix, gradient):
    """Fill dA0/dh (k, n) for equilibria with nominal indentations (k, n); nan if one is not a stable one."""
    n = indentation.shape[1]
    by_load, size = np.empty(n), np.empty(n)
    for row in range(indentation.shape[0]):
        found = gradient[row]
        copy(indentation[row], s[Z])
        count = respond(field, order, law, self_term, s, closed)
        spread(order, law, s)
        for i in range(n):
            found[i] = 0.0
            by_load[i] = math.pi * s[BY_LOAD, i]
        if count == 0:
            continue
        if order > 1:
            for i in range(n):
                s[SIZE, i] = 0.5 * math.pi * s[BY_CURVATURE, i]
                s[TURN_X, i] = -2.0 * math.pi * s[BY_SLOPE, i] * s[SLOPE_X, i]
                s[TURN_Y, i] = -2.0 * math.pi * s[BY_SLOPE, i] * s[SLOPE_Y, i]
            add_moments(field[0], closed, count, s[SIZE], s[TURN_X], s[TURN_Y], by_load)
        used = refresh(field, order, self_term, s, closed, count, matrix, True)
        done = False
        for _ in range(MAX_CORRECTIONS):
            for i in range(n):
                s[IMAGE, i] = 0.0
            linearise(field, order, self_term, s, closed, count, found, s[IMAGE])
            if order > 1:
                add_moments(field[0], closed, count, s[SIZE], s[TURN_X], s[TURN_Y], s[IMAGE])
            mean = 0.0
            for i in range(n):
                s[RHS, i] = by_load[i] - s[IMAGE, i] if s[Z, i] > 0.0 else 0.0
                mean += s[RHS, i] / count
            for i in range(n):  # without the mean, a part of x, which would cost digits
                s[RHS, i] -= mean if s[Z, i] > 0.0 else 0.0
                size[i] = abs(s[RHS, i])
            _, good = solve(used, s, closed, count, 0.0, True, INNER * largest(size), False)
            if not good:
                break
            for i in range(n):
                found[i] += s[STEP_LOADS, i]
                size[i] = abs(s[STEP_LOADS, i])
            change = largest(size)
            for i in range(n):
                size[i] = abs(found[i])
            done = change <= TOLERANCE * largest(size)
            if done:
                break
        if not done:
            for i in range(n):
                found[i] = math.nan
