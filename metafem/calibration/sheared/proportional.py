"""Fit of proportional quantities that all have errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray

# Largest number of steps, and relative change of the factors at which the iteration ends. Each step computes
# its weights from the fitted values. After two or three steps the factors change by less than a thousandth of
# their standard deviations.
STEPS, SETTLED = 50, 1e-10

# Smallest fitted value over the largest fitted value. Smaller values are noise and would have infinite
# weights.
SMALLEST = 1e-6


def proportional(
    measured: FloatArray, deviation: Sequence[Callable[[FloatArray], FloatArray]]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the factors q_j of proportional quantities ``x_j = q_j x_0``, their covariance, and all x_0.

    The first factor q_0 is 1. Each point has one unknown x_0. The sum over all measured quantities of
    ``((y_j - q_j x_0) / s_j)^2`` is minimised over the factors and all x_0. The standard deviations
    ``s_j(q_j x_0)`` are computed from the fitted values. If they were computed from the measured values,
    values that are too small by chance would have too much weight, and the factors would be biased. The
    residuals of a point are independent of its fitted x_0, so weights from the fitted values cause no bias.

    Parameters
    ----------
    measured : ndarray, (..., c, k)
        Quantities y_j of k points; nan for values that were not measured. For each quantity, some points have
        both this quantity and the previous quantity. Each entry of the leading axes is a separate fit.
    deviation : sequence of callables
        Functions that return the standard deviation of each quantity at its values.

    Returns
    -------
    factor : ndarray, (..., c - 1)
        Factors q_1 to q_(c-1).
    covariance : ndarray, (..., c - 1, c - 1)
        Covariance of the factors, the inverse of the curvature of the sum.
    value : ndarray, (..., k)
        Fitted x_0 of the points.
    """
    known = np.isfinite(measured)
    y = np.where(known, measured, 0.0)
    factor = _first(y, known)
    value = _latent(factor, y, known.astype(float))
    covariance = np.empty(0)
    for _ in range(STEPS):
        weight = _weights(factor, value, known, deviation)
        value = _latent(factor, y, weight)
        residual = y - factor[..., None] * value[..., None, :]
        # curvature after minimisation over x_0: W - W q q^T W / (q^T W q), in the unknown factors
        wq = weight * factor[..., None]
        total = (wq * factor[..., None]).sum(-2)
        square = value**2
        curvature = -np.einsum("...ik,...jk,...k->...ij", wq[..., 1:, :], wq[..., 1:, :], square / total)
        diagonal = np.einsum("...ii->...i", curvature)
        diagonal += (weight[..., 1:, :] * square[..., None, :]).sum(-1)
        covariance = np.linalg.inv(curvature)
        slope = (weight * residual * value[..., None, :]).sum(-1)[..., 1:]
        step = np.einsum("...ij,...j->...i", covariance, slope)
        factor[..., 1:] += step
        if (np.abs(step) <= SETTLED * np.abs(factor[..., 1:])).all():
            break
    return factor[..., 1:], covariance, value


def _first(y: FloatArray, known: NDArray[np.bool_]) -> FloatArray:
    """Return initial factors (..., c), from sums over points with a quantity and the previous quantity."""
    both = known[..., 1:, :] & known[..., :-1, :]
    ratio = (both * y[..., 1:, :]).sum(-1) / (both * y[..., :-1, :]).sum(-1)
    return np.concatenate([np.ones((*y.shape[:-2], 1)), ratio.cumprod(axis=-1)], axis=-1)


def _latent(factor: FloatArray, y: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the best x_0 of each point for fixed factors and weights, (..., k)."""
    weighted = weight * factor[..., None]
    value = (weighted * y).sum(-2) / (weighted * factor[..., None]).sum(-2)
    return np.asarray(np.maximum(value, SMALLEST * value.max(-1, keepdims=True)))


def _weights(
    factor: FloatArray,
    value: FloatArray,
    known: NDArray[np.bool_],
    deviation: Sequence[Callable[[FloatArray], FloatArray]],
) -> FloatArray:
    fitted = factor[..., None] * value[..., None, :]
    deviations = [of(fitted[..., j, :]) for j, of in enumerate(deviation)]
    return np.asarray(known / np.stack(deviations, axis=-2) ** 2)
