"""Sensitivity of A0 to each height for interacting asperities.

At an equilibrium dW/dp = 0, with the energy W of `_kernels.coupling`. A change dh of the heights changes the
loads of the asperities in contact by dp, with ``H dp = dh - d delta`` and H = d2W/dp2. The change d delta of
the separation is such that the sum of the loads is constant. With the gradient c = dA0/dp,
l = H^-1 c and m = H^-1 1,

    dA0/dh = l - (1.l / 1.m) m.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg.lapack import dgesv

from metafem._kernels import interacting as kernel
from metafem._kernels.contact.tabulated import Law
from metafem._kernels.coupling import Coupling, State, empty_state, respond, spread
from metafem._validate import FloatArray, IntArray
from metafem.models._resources import run_rows

# Largest number of asperities for which the kernel is faster than LAPACK: 2.7 times with 64, 1.2 times with
# 400.
FEW = 400

# Number of pairs of asperities, times loads, below which a second thread saves no time: about a millisecond.
PAIRS_PER_THREAD = 100_000


def area_gradients(
    field: Coupling,
    order: int,
    law: Law,
    self_term: FloatArray,
    indentation: FloatArray,
) -> FloatArray:
    """Return dA0/dh at fixed load [mm], (k, n), for equilibria with nominal indentations z (k, n)."""
    rows, count = indentation.shape
    if count > FEW:
        return general_gradients(field, order, law, self_term, indentation)
    gradients = np.zeros_like(indentation)

    def run(part: slice) -> None:
        state, matrix, scratch = empty_state(count), np.empty((count, count)), np.empty((6, count))
        z, found = indentation[part], gradients[part]
        solved = kernel.area_gradients(field, order, law, self_term, z, state, matrix, scratch, found)
        if solved < len(z):  # an equilibrium of overlapping contacts may be a saddle point of the energy
            found[solved:] = general_gradients(field, order, law, self_term, z[solved:])

    run_rows(run, rows, rows * count**2, PAIRS_PER_THREAD)
    return gradients


def general_gradients(
    field: Coupling,
    order: int,
    law: Law,
    self_term: FloatArray,
    indentation: FloatArray,
) -> FloatArray:
    """Return the result of `area_gradients` by a general solver, without a positive definite matrix."""
    gradients = np.zeros_like(indentation)
    state = empty_state(indentation.shape[1])
    influences = influences_of(field, order)
    for row, z in enumerate(indentation):
        state.z[:] = z
        count = respond(field, order, law, self_term, state)
        if count == 0:
            continue
        spread(order, law, state)
        closed = state.closed[:count]
        hessian, by_load = contact_system(influences, self_term, state, closed)
        _, _, found, failed = dgesv(hessian, np.column_stack([by_load, np.ones(count)]), overwrite_a=True)
        if failed:
            raise np.linalg.LinAlgError("the contact system of an equilibrium is singular")
        by_area, by_approach = found.T
        change = by_area - by_area.sum() / by_approach.sum() * by_approach
        gradients[row, closed] = change
    return gradients


def influences_of(field: Coupling, order: int) -> FloatArray:
    """Return displacements at i per unit load of j, and for order 3 Laplacians and slopes, (m, n, n)."""
    if order == 1:
        return np.asarray(field.influence[None])
    at = (field.laplacian_at, field.slope_x_at, field.slope_y_at)
    return np.stack([field.influence, *(matrix.T for matrix in at)])


def contact_system(
    influences: FloatArray, self_term: FloatArray, state: State, closed: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return d2W/dp2 [1/mm] and dA0/dp [-] for the asperities in contact.

    d2W/dp2 has all the terms of `coupling.quadratic_form`. A load changes the area of its own contact and,
    through the curvature and the slope of its field, the areas of other contacts.
    """
    part = influences.take(closed, axis=1).take(closed, axis=2)
    matrix, rates = part[0], part[1:]
    by_load, square = state.by_load[closed], state.square[closed]
    matrix[np.diag_indices(len(closed))] += state.bend[closed] / state.rate[closed] + self_term[closed]
    if not len(rates):
        return matrix, math.pi * by_load
    slope_x, slope_y, lever = state.slope_x[closed], state.slope_y[closed], state.lever[closed]
    tilt = -2.0 * state.lever_rate[closed]
    weights = np.stack([square / 3.0, tilt * slope_x, tilt * slope_y])
    mixed = np.einsum("ki,kij->ij", weights, rates)
    matrix += 0.5 * (mixed + mixed.T)
    cube = square * np.sqrt(square)
    weights = np.stack([2.0 / 45.0 * square * cube, lever, lever])
    stacked = rates.reshape(-1, len(closed))
    matrix -= stacked.T @ (weights[:, :, None] * rates).reshape(-1, len(closed))
    matrix[np.diag_indices(len(closed))] -= 0.5 * state.lever_bend[closed] * (slope_x**2 + slope_y**2)
    sloping = 2.0 * state.by_slope[closed]
    weights = np.stack([0.5 * state.by_curvature[closed], sloping * slope_x, sloping * slope_y])
    return matrix, math.pi * (by_load + stacked.T @ weights.ravel())
