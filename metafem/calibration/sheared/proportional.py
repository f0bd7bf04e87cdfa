"""Proportional quantities, all measured with errors that grow with the quantity."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray

# The weights of the next step follow from the fitted values; the factors change by less than a thousandth of
# their standard deviations after two or three steps.
STEPS, SETTLED = 50, 1e-10

# Smallest fitted value over the largest. Smaller ones are noise, and their weights would be infinite.
SMALLEST = 1e-6


def proportional(
    measured: FloatArray, deviation: Sequence[Callable[[FloatArray], FloatArray]]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Fit the factors of c quantities that are proportional to the first, ``x_j = q_j x_0`` with q_0 = 1.

    Each point has one unknown x_0. The sum over all measured quantities of ``((y_j - q_j x_0) / s_j)^2`` is
    minimised over the factors and all x_0, with the standard deviations ``s_j(q_j x_0)`` at the fitted
    values: at the measured ones, small values would have small deviations because of their noise, and the
    factors would be biased. The residuals of a point are independent of its fitted x_0, so the weights used
    here cause no bias.

    Parameters
    ----------
    measured : ndarray, (..., c, k)
        Quantities y_j of k points; nan where one was not measured. Each quantity and the previous one were
        both measured at some points. Leading axes are separate fits.
    deviation : sequence of callables
        Standard deviation of each quantity from its value.

    Returns
    -------
    factor : ndarray, (..., c - 1)
        q_1 to q_(c-1).
    covariance : ndarray, (..., c - 1, c - 1)
        Their covariance, the inverse of the curvature of the sum.
    value : ndarray, (..., k)
        Fitted x_0.
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
        # profiled over x_0: W - W q q^T W / (q^T W q), with the rows and columns of the unknown factors
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
    """Return ratios of sums over the points at which a quantity and the previous one were measured."""
    both = known[..., 1:, :] & known[..., :-1, :]
    ratio = (both * y[..., 1:, :]).sum(-1) / (both * y[..., :-1, :]).sum(-1)
    return np.concatenate([np.ones((*y.shape[:-2], 1)), ratio.cumprod(axis=-1)], axis=-1)


def _latent(factor: FloatArray, y: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the x_0 of each point that fit its quantities best."""
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
