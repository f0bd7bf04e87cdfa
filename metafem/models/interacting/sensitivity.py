"""Sensitivity of A0 to each height for interacting asperities.

At an equilibrium dW/dp = 0, with the energy W of `_kernels.coupling`. A change dh of the heights moves
the loads by ``H dp = dh - d delta`` on the asperities in contact, H = d2W/dp2, and d delta keeps the sum
of the loads. With the gradient c of A0 by the loads, l = H^-1 c and m = H^-1 1,

    dA0/dh = l - (1.l / 1.m) m.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg.lapack import dgesv

from metafem._kernels.coupling import Coupling, State, empty_state, respond
from metafem._validate import FloatArray, IntArray


def area_gradients(
    field: Coupling,
    order: int,
    radius: FloatArray,
    self_term: FloatArray,
    indentation: FloatArray,
) -> FloatArray:
    """Return dA0/dh at fixed load [mm], (k, n), for equilibria of nominal indentations z (k, n)."""
    gradients = np.zeros_like(indentation)
    radius = np.array(radius)  # a read-only array would compile the kernel again
    state = empty_state(len(radius))
    influences = _influences(field, order)
    for row, z in enumerate(indentation):
        state.z[:] = z
        count = respond(field, order, radius, self_term, state)
        if count == 0:
            continue
        closed = state.closed[:count]
        hessian, by_load = _system(influences, radius, self_term, state, closed)
        _, _, found, failed = dgesv(hessian, np.column_stack([by_load, np.ones(count)]), overwrite_a=True)
        if failed:
            raise np.linalg.LinAlgError("the contact system of an equilibrium is singular")
        by_area, by_approach = found.T
        change = by_area - by_area.sum() / by_approach.sum() * by_approach
        gradients[row, closed] = change
    return gradients


def _influences(field: Coupling, order: int) -> FloatArray:
    """Return displacements, and for order 3 curvatures and slopes, at i by the load of j, (m, n, n)."""
    if order == 1:
        return np.asarray(field.influence[None])
    at = (field.laplacian_at, field.slope_x_at, field.slope_y_at)
    return np.stack([field.influence, *(matrix.T for matrix in at)])


def _system(
    influences: FloatArray, radius: FloatArray, self_term: FloatArray, state: State, closed: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return d2W/dp2 on the asperities in contact, every term of `coupling.quadratic_form`, and dA0/dp [-].

    Each load changes the radius of its own contact and, by the curvature, those of the others:
    ``d a^2 = -a^2 R/(3 b^3) dk``.
    """
    R, p, z, bend = radius[closed], state.load[closed], state.z[closed], state.bend[closed]
    part = influences.take(closed, axis=1).take(closed, axis=2)
    matrix, rates = part[0], part[1:]
    root = 2.0 * np.sqrt(R * z)
    matrix[np.diag_indices(len(closed))] += bend / root + self_term[closed]
    widened = R / (root * bend**2)
    if not len(rates):
        return matrix, math.pi * widened
    square, cube = state.square[closed], bend**3
    weights = np.stack([square / 3.0, -2.0 * R * state.slope_x[closed], -2.0 * R * state.slope_y[closed]])
    mixed = np.einsum("ki,kij->ij", weights, rates)
    matrix += 0.5 * (mixed + mixed.T)
    weights = np.stack([p * square * R / (30.0 * cube), R * p, R * p])
    stacked = rates.reshape(-1, len(closed))
    matrix -= stacked.T @ (weights[:, :, None] * rates).reshape(-1, len(closed))
    return matrix, math.pi * (widened - rates[0].T @ (square * R / (3.0 * cube)))
