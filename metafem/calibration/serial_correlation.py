"""Correlation of successive measurement errors: a test for it, its estimate, and its effect on a fit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from metafem._validate import FloatArray

# Largest estimate of the correlation of successive errors, and the tolerance of the estimate. A larger
# correlation cannot be distinguished from a drift.
LARGEST, TOLERANCE = 0.99, 1e-6


@dataclass(frozen=True, eq=False)
class Succession:
    """Points of several tests in the order of measurement, and the derivatives of the law fitted to them.

    Attributes
    ----------
    test : sequence, (k,)
        Test of each point.
    regressor : ndarray, (k, p)
        Derivatives X of the fitted quantity with respect to each parameter, over the standard deviations of
        the points. If the errors are independent, the covariance of the parameters is the inverse of X^T X.
    """

    test: Sequence[str]
    regressor: FloatArray

    @cached_property
    def leverage(self) -> FloatArray:
        """Leverage of each point, the fraction of its variance that the fit removes, (k,)."""
        return np.asarray((self._basis**2).sum(axis=1))

    @cached_property
    def _basis(self) -> FloatArray:
        """Orthonormal basis Q of the regressors, (k, p)."""
        return np.asarray(np.linalg.qr(self.regressor)[0])

    @cached_property
    def _lag(self) -> FloatArray:
        """Number of steps between two points of one test, (k, k); infinite for points of different tests."""
        test = np.asarray(self.test)
        same = test[:, None] == test
        place = np.tril(same, -1).sum(axis=1)
        return np.where(same, np.abs(place[:, None] - place), np.inf)

    @cached_property
    def _half(self) -> FloatArray:
        """Matrix W (k, k) with 1/2 for successive points of a test and 0 elsewhere."""
        return np.where(self._lag == 1.0, 0.5, 0.0)

    def lag_one(self, residual: FloatArray) -> tuple[float, float]:
        """Return the correlation of successive residuals (k,), and the probability of a larger value.

        The correlation of the residuals e is ``e^T W e/e^T e``. For independent errors, its moments follow
        from Durbin and Watson, Biometrika 37, 409 (1950), doi:10.1093/biomet/37.3-4.409. A normal
        distribution approximates its distribution.
        """
        pairs, freedom = self._half.sum(), len(residual) - self._basis.shape[1]
        square = float(residual @ residual)
        if not square or not pairs or freedom < 2:  # with one degree of freedom the correlation is fixed
            return 0.0, 1.0
        found = float(residual @ self._half @ residual) / square
        successive = self._half @ self._basis
        inner = self._basis.T @ successive
        trace = float(np.trace(inner))
        second = 0.5 * pairs - 2.0 * (successive**2).sum() + (inner**2).sum()
        variance = 2.0 * (second * freedom - trace**2) / (freedom**2 * (freedom + 2))
        if variance <= 0.0:
            return found, 1.0
        return found, float(ndtr(-(found + trace / freedom) / math.sqrt(variance)))

    def of_errors(self, lag_one: float) -> float:
        """Return the correlation rho of successive errors from the correlation of successive residuals.

        A fit absorbs part of the slowly varying errors, so the residuals are less correlated than the errors.
        """
        successive = self._half @ self._basis

        def excess(rho: float) -> float:
            correlated = rho**self._lag @ self._basis
            inner = self._basis.T @ correlated
            top = self._half.sum() * rho - 2.0 * (successive * correlated).sum()
            top += np.trace((self._basis.T @ successive) @ inner)
            return float(top / (len(self.test) - np.trace(inner))) - lag_one

        if excess(LARGEST) <= 0.0:
            return LARGEST
        return 0.0 if excess(0.0) >= 0.0 else float(brentq(excess, 0.0, LARGEST, xtol=TOLERANCE))

    def covariance(self, rho: float) -> FloatArray:
        """Return the covariance of least-squares parameters, (p, p), for errors with this correlation.

        Errors m points apart have the correlation rho^m; R is the matrix of these correlations. With the
        regressors ``X = Q T``, the covariance is ``T^-1 Q^T R Q T^-T``. For independent errors it becomes
        ``T^-1 T^-T = (X^T X)^-1``.
        """
        back = np.linalg.inv(np.linalg.qr(self.regressor)[1])
        return np.asarray(back @ self._basis.T @ (rho**self._lag @ self._basis) @ back.T)
