"""Correlation of residuals on a grid, and the covariance of a least-squares fit to correlated values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import fft

from metafem._validate import FloatArray


@dataclass(frozen=True, eq=False)
class Correlation:
    """Covariance over the lag in cells, (2 reach + 1, 2 reach + 1), over the variance of the residuals.

    It exceeds 1 at the lag 0: the fit reduces the variance of its residuals.
    """

    relative: FloatArray

    @property
    def cells(self) -> float:
        """Number of cells that count as one independent value."""
        return float(self.relative.sum())


def correlation(sums: Sequence[FloatArray], weights: Sequence[FloatArray], parameters: int) -> Correlation:
    """Return the common correlation of residuals on several grids, each after a fit of some parameters.

    `sums` holds the sum of the residuals in each cell, `weights` their number. The covariance is summed up to
    the first ring of lags at which it vanishes. The fit subtracts ``parameters S / N`` from the covariance at
    each lag, S the sum over all lags and N the number of cells; this is added again.
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
    taken = parameters * len(weights) / count  # of the sum over lags, at each lag
    whole = covariance[inside].sum() / max(1.0 - taken * inside.sum(), taken)
    variance = covariance[reach, reach]
    if not variance > 0.0:  # exact data
        return Correlation(np.ones((1, 1)))
    covariance = np.where(inside, covariance + taken * whole, 0.0)
    keep = slice(reach - cut, reach + cut + 1) if cut <= reach else slice(None)
    return Correlation(covariance[keep, keep] / variance)


def summed(columns: FloatArray, correlation: Correlation) -> FloatArray:
    """Return ``sum_ij X_ik c(i - j) X_jl`` of columns (p, rows, columns) on a grid, (p, p)."""
    reach = len(correlation.relative) // 2
    shape = _padded(columns.shape[1:], reach)
    kernel = np.zeros(shape)
    lag = np.arange(-reach, reach + 1)
    kernel[np.ix_(lag % shape[0], lag % shape[1])] = correlation.relative
    spread = fft.irfft2(fft.rfft2(columns, shape) * fft.rfft2(kernel), shape)
    spread = spread[:, : columns.shape[1], : columns.shape[2]]
    return np.asarray(np.einsum("kij,lij->kl", columns, spread))


def lagged(one: FloatArray, other: FloatArray, reach: int) -> FloatArray:
    """Return ``sum_i a_i b_{i + lag}`` for all lags up to `reach` along both axes."""
    shape = _padded(one.shape, reach)
    whole = fft.irfft2(np.conj(fft.rfft2(one, shape)) * fft.rfft2(other, shape), shape)
    lag = np.arange(-reach, reach + 1)
    return np.asarray(whole[np.ix_(lag % shape[0], lag % shape[1])])


def _padded(shape: tuple[int, ...], reach: int) -> tuple[int, int]:
    """Return a shape in which a shift by `reach` does not wrap around."""
    rows, columns = (int(fft.next_fast_len(max(n, reach + 1) + reach, real=True)) for n in shape)
    return rows, columns
