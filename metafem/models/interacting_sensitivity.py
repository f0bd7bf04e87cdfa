"""How the law of interacting asperities changes with their heights.

At an equilibrium dW/dp = 0, with the energy W of `_kernels.coupling`. A change dh of the heights moves
the loads by ``H dp = dh - d delta`` on the asperities in contact, H = d2W/dp2, and d delta keeps the sum
of the loads. With the gradient c of A0 by the loads, l = H^-1 c and m = H^-1 1,

    dA0/dh = l - (1.l / 1.m) m.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels.coupling import Field, State, empty_state, respond
from metafem._validate import FloatArray


def area_gradients(
    field: Field,
    order: int,
    radius: FloatArray,
    own: FloatArray,
    trail: FloatArray,
    own_rate: FloatArray,
) -> FloatArray:
    """Return dA0/dh at fixed load [mm], (k, n), for the equilibria z in the rows of `trail`.

    own_rate: derivative of `own` by the height; a summit that moves with its compliance moves less.
    """
    gradients = np.zeros_like(trail)
    state = empty_state(len(radius))
    for row, z in enumerate(trail):
        state.z[:] = z
        count = respond(field, order, radius, own, state)
        if count == 0:
            continue
        closed = state.closed[:count]
        hessian = _hessian(field, order, radius, own, state, closed)
        right = np.column_stack([_area_by_load(field, order, radius, state, closed), np.ones(count)])
        by_area, by_load = np.linalg.solve(hessian, right).T
        change = by_area - by_area.sum() / by_load.sum() * by_load
        gradients[row, closed] = change * (1.0 - own_rate[closed] * state.load[closed])
    return gradients


def _hessian(
    field: Field, order: int, radius: FloatArray, own: FloatArray, state: State, closed: FloatArray
) -> FloatArray:
    """Return d2W/dp2 on the asperities in contact, every term of `coupling.quadratic_form`."""
    pairs = np.ix_(closed, closed)
    R, p, z = radius[closed], state.load[closed], state.z[closed]
    matrix: FloatArray = field.influence[pairs].copy()
    matrix[np.diag_indices(len(closed))] += state.bend[closed] / (2.0 * np.sqrt(R * z)) + own[closed]
    if order == 1:
        return matrix
    square, cube = state.square[closed], state.bend[closed] ** 3
    rate = field.laplacian_at[pairs].T  # curvature of i by the load of j
    matrix += _symmetric(square[:, None] / 3.0 * rate) - rate.T @ (
        (p * square * R / (30.0 * cube))[:, None] * rate
    )
    for at, slope in ((field.slope_x_at, state.slope_x), (field.slope_y_at, state.slope_y)):
        rate = at[pairs].T
        matrix -= _symmetric(2.0 * (R * slope[closed])[:, None] * rate) + rate.T @ ((R * p)[:, None] * rate)
    return matrix


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (matrix + matrix.T))


def _area_by_load(
    field: Field, order: int, radius: FloatArray, state: State, closed: FloatArray
) -> FloatArray:
    """Return dA0/dp [-]: each load widens its own contact, and curves those of the others."""
    R, z, bend = radius[closed], state.z[closed], state.bend[closed]
    own = R / (2.0 * np.sqrt(R * z) * bend**2)
    if order == 1:
        return np.asarray(math.pi * own)
    flattening = -state.square[closed] * R / (3.0 * bend**3)  # d a^2 by the curvature sum p lap G
    return np.asarray(math.pi * (own + field.laplacian_at[np.ix_(closed, closed)] @ flattening))
