"""Correlation of residuals on a grid, and the covariance of a least-squares fit to correlated values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.signal import correlate, fftconvolve

from metafem._validate import FloatArray


def correlation(sums: Sequence[FloatArray], weights: Sequence[FloatArray], parameters: int) -> FloatArray:
    """Return the common autocorrelation of residuals on several grids, (2 reach + 1, 2 reach + 1).

    The correlation is the covariance at each lag [cells], divided by the variance of the residuals. At lag 0
    it exceeds 1, because a fit reduces the variance of its residuals. The sum of the correlation over all
    lags is the number of cells per independent value.

    `sums` holds the sum of the residuals in each cell, `weights` their number, and `parameters` the number of
    fitted parameters of each grid. Lags are included up to the first ring of lags with a mean covariance of
    at most 0. The fit reduces the covariance at each lag by ``parameters S / N``, with the sum S over all
    lags and the number N of cells. This reduction is added back.
    """
    reach = max(1, min(max(each.shape) for each in weights) // 2)
    total, pairs = np.zeros((2 * reach + 1,) * 2), np.zeros((2 * reach + 1,) * 2)
    count = 0.0
    for each, weight in zip(sums, weights, strict=True):
        total += lagged(each, each, reach)
        pairs += lagged(weight, weight, reach)
        count += weight.sum() ** 2 / (weight**2).sum()
    covariance = np.divide(total, pairs, out=np.zeros_like(total), where=pairs > 0.5)
    lag = np.arange(-reach, reach + 1)
    ring = np.rint(np.hypot(lag, lag[:, None])).astype(np.intp)
    mean = np.bincount(ring.ravel(), covariance.ravel()) / np.bincount(ring.ravel())
    vanished = np.flatnonzero(mean[: reach + 1] <= 0.0)
    cut = int(vanished[0]) if vanished.size else reach + 1
    inside = ring < cut
    taken = parameters * len(weights) / count  # reduction at each lag, divided by the sum S
    whole = covariance[inside].sum() / max(1.0 - taken * inside.sum(), taken)
    variance = covariance[reach, reach]
    if not variance > 0.0:  # exact data have no residuals
        return np.ones((1, 1))
    covariance = np.where(inside, covariance + taken * whole, 0.0)
    keep = slice(reach - cut, reach + cut + 1) if cut <= reach else slice(None)
    return np.asarray(covariance[keep, keep] / variance)


def summed(columns: FloatArray, correlation: FloatArray) -> FloatArray:
    """Return ``sum_ij X_ik c(i - j) X_jl`` for columns X (p, rows, columns) on a grid, (p, p)."""
    spread = fftconvolve(columns, correlation[None], mode="same", axes=(1, 2))
    return np.asarray(np.einsum("kij,lij->kl", columns, spread))


def lagged(one: FloatArray, other: FloatArray, reach: int) -> FloatArray:
    """Return ``sum_i a_i b_{i + lag}`` for all lags up to `reach` along both axes."""
    return np.asarray(correlate(np.pad(other, reach), one, mode="valid", method="fft"))
