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
from metafem._kernels.equations import ROWS, add_moments, copy, linearise, respond, spread, state_in
from metafem._kernels.newton import INNER, refresh, scratch_in, solve
from metafem._kernels.vectors import largest

# Largest change of the gradient by the last correction, relative to the gradient, and maximum number of
# corrections; each reduces the error by the relative size of the omitted terms, 1e-2 or less.
TOLERANCE = 1e-11
MAX_CORRECTIONS = 30


@compiled
def area_gradients(field, order, law, self_term, indentation, work, gradient):
    """Fill dA0/dh (k, n) for equilibria with nominal indentations (k, n); nan if one is not a stable one."""
    n = indentation.shape[1]
    state, scratch = state_in(work.block, work.closed), scratch_in(work.block[ROWS:], work.matrix)
    by_load, size = np.empty(n), np.empty(n)
    for row in range(indentation.shape[0]):
        found = gradient[row]
        copy(indentation[row], state.z)
        count = respond(field, order, law, self_term, state)
        spread(order, law, state)
        for i in range(n):
            found[i] = 0.0
            by_load[i] = math.pi * state.by_load[i]
        if count == 0:
            continue
        if order > 1:
            for i in range(n):
                state.size[i] = 0.5 * math.pi * state.by_curvature[i]
                state.turn_x[i] = -2.0 * math.pi * state.by_slope[i] * state.slope_x[i]
                state.turn_y[i] = -2.0 * math.pi * state.by_slope[i] * state.slope_y[i]
            add_moments(field.source, state.closed, count, state.size, state.turn_x, state.turn_y, by_load)
        matrix = refresh(field, order, self_term, state, count, scratch, True)
        done = False
        for _ in range(MAX_CORRECTIONS):
            for i in range(n):
                scratch.image[i] = 0.0
            linearise(field, order, self_term, state, count, found, scratch.image)
            if order > 1:
                add_moments(
                    field.source, state.closed, count, state.size, state.turn_x, state.turn_y, scratch.image
                )
            mean = 0.0
            for i in range(n):
                scratch.rhs[i] = by_load[i] - scratch.image[i] if state.z[i] > 0.0 else 0.0
                mean += scratch.rhs[i] / count
            for i in range(n):  # without the mean, a part of x, which would cost digits
                scratch.rhs[i] -= mean if state.z[i] > 0.0 else 0.0
                size[i] = abs(scratch.rhs[i])
            _, good = solve(matrix, state.closed, count, 0.0, True, INNER * largest(size), False, scratch)
            if not good:
                break
            for i in range(n):
                found[i] += scratch.loads[i]
                size[i] = abs(scratch.loads[i])
            change = largest(size)
            for i in range(n):
                size[i] = abs(found[i])
            done = change <= TOLERANCE * largest(size)
            if done:
                break
        if not done:
            for i in range(n):
                found[i] = math.nan
