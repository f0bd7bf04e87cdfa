"""Correlation of successive errors of measurement: its test, its size, and what it does to a fit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ndtr

from metafem._validate import FloatArray

# Largest correlation of successive errors that is told from a drift, and the tolerance of its value.
LARGEST, TOLERANCE = 0.99, 1e-6


@dataclass(frozen=True, eq=False)
class Succession:
    """Points of several tests, each in the order in which they were measured, and the law fitted to them.

    Attributes
    ----------
    test : sequence, (k,)
        Test of each point.
    regressor : ndarray, (k, p)
        Change of the fitted quantity with each parameter, over the standard deviations of the points: the
        covariance of independent errors is the inverse of X^T X.
    """

    test: Sequence[str]
    regressor: FloatArray

    @cached_property
    def leverage(self) -> FloatArray:
        """Leverage of each point: the share of its variance removed by the fit, (k,)."""
        share: FloatArray = (np.linalg.qr(self.regressor)[0] ** 2).sum(axis=1)
        return share

    @cached_property
    def _order(self) -> NDArray[np.intp]:
        """Numbers of the points test by test."""
        number: NDArray[np.intp] = np.unique(np.asarray(self.test), return_inverse=True)[1]
        order: NDArray[np.intp] = np.asarray(np.argsort(number, kind="stable"))
        return order

    @cached_property
    def _joined(self) -> FloatArray:
        """1 where a point follows one of its own test, else 0, (k - 1,)."""
        test = np.asarray(self.test)[self._order]
        return np.array(test[1:] == test[:-1], dtype=float)

    @cached_property
    def _basis(self) -> FloatArray:
        """Orthonormal regressors Q (k, p)."""
        return np.asarray(np.linalg.qr(self.regressor[self._order])[0])

    def lag_one(self, residual: FloatArray) -> tuple[float, float]:
        """Return the correlation of successive residuals (k,), and the probability of one as large.

        Residuals e of independent errors have ``e^T W e/e^T e`` with the moments of Durbin and Watson,
        Biometrika 37, 409 (1950), doi:10.1093/biomet/37.3-4.409: W holds 1/2 beside its diagonal. The
        distribution is taken as normal.
        """
        ordered, pairs = residual[self._order], self._joined.sum()
        freedom = len(ordered) - self._basis.shape[1]
        square = float(ordered @ ordered)
        if not square or not pairs or freedom < 2:  # one residual direction has one correlation
            return 0.0, 1.0
        found = float(ordered @ self._beside(ordered[:, None])[:, 0]) / square
        beside = self._beside(self._basis)
        inner = self._basis.T @ beside
        taken = float(np.trace(inner))
        second = 0.5 * pairs - 2.0 * (beside**2).sum() + (inner**2).sum()
        variance = 2.0 * (second * freedom - taken**2) / (freedom**2 * (freedom + 2))
        if variance <= 0.0:
            return found, 1.0
        return found, float(ndtr(-(found + taken / freedom) / math.sqrt(variance)))

    def of_errors(self, lag_one: float) -> float:
        """Return the correlation rho of successive errors whose residuals have this one.

        A fit removes part of slow errors, so that residuals are less correlated than errors.
        """

        def excess(rho: float) -> float:
            turned, beside = self._correlated(self._basis, rho), self._beside(self._basis)
            inner = self._basis.T @ turned
            top = self._joined.sum() * rho - 2.0 * (beside * turned).sum()
            top += np.trace((self._basis.T @ beside) @ inner)
            return float(top / (len(self.test) - np.trace(inner))) - lag_one

        if excess(LARGEST) <= 0.0:
            return LARGEST
        return 0.0 if excess(0.0) >= 0.0 else float(brentq(excess, 0.0, LARGEST, xtol=TOLERANCE))

    def covariance(self, rho: float) -> FloatArray:
        """Return the covariance (p, p) of least squares under errors with this correlation.

        Errors m points apart are correlated by rho^m. With regressors ``X = Q T`` it is
        ``T^-1 Q^T R Q T^-T``, of independent errors ``T^-1 T^-T = (X^T X)^-1``.
        """
        back = np.linalg.inv(np.linalg.qr(self.regressor[self._order])[1])
        return np.asarray(back @ self._basis.T @ self._correlated(self._basis, rho) @ back.T)

    def _beside(self, values: FloatArray) -> FloatArray:
        """Return half the sums of the neighbours of values (k, m) in their tests."""
        half, found = 0.5 * self._joined[:, None], np.zeros(values.shape)
        found[1:] += half * values[:-1]
        found[:-1] += half * values[1:]
        return found

    def _correlated(self, values: FloatArray, rho: float) -> FloatArray:
        """Return the product of the correlation matrix of the errors and values (k, m)."""
        before, after = values.copy(), values.copy()
        for i, joined in enumerate(self._joined.tolist()):
            before[i + 1] += rho * joined * before[i]
        for i, joined in reversed(list(enumerate(self._joined.tolist()))):
            after[i] += rho * joined * after[i + 1]
        return before + after - values
