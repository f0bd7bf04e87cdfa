"""Correlation of successive errors of measurement: its test, its size, and its effect on a fit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from metafem._validate import FloatArray

# Largest correlation of successive errors (larger ones are a drift), and the tolerance of its value.
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
        return np.asarray((self._basis**2).sum(axis=1))

    @cached_property
    def _basis(self) -> FloatArray:
        """Orthonormal regressors Q (k, p)."""
        return np.asarray(np.linalg.qr(self.regressor)[0])

    @cached_property
    def _lag(self) -> FloatArray:
        """Distance between two points of one test, in points, (k, k); infinite between tests."""
        test = np.asarray(self.test)
        same = test[:, None] == test
        place = np.tril(same, -1).sum(axis=1)
        return np.where(same, np.abs(place[:, None] - place), np.inf)

    @cached_property
    def _half(self) -> FloatArray:
        """The matrix W (k, k), 1/2 between successive points of a test."""
        return np.where(self._lag == 1.0, 0.5, 0.0)

    def lag_one(self, residual: FloatArray) -> tuple[float, float]:
        """Return the correlation of successive residuals (k,), and the probability of a value as large.

        Residuals e of independent errors have ``e^T W e/e^T e`` with the moments of Durbin and Watson,
        Biometrika 37, 409 (1950), doi:10.1093/biomet/37.3-4.409. The distribution is taken as normal.
        """
        pairs, freedom = self._half.sum(), len(residual) - self._basis.shape[1]
        square = float(residual @ residual)
        if not square or not pairs or freedom < 2:  # with one residual direction the correlation is fixed
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
        """Return the correlation rho of successive errors from that of their residuals.

        A fit removes part of slow errors, so that residuals are less correlated than errors.
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
        """Return the covariance (p, p) of least squares under errors with this correlation.

        Errors m points apart are correlated by rho^m. With regressors ``X = Q T`` it is
        ``T^-1 Q^T R Q T^-T``; for independent errors it is ``T^-1 T^-T = (X^T X)^-1``.
        """
        back = np.linalg.inv(np.linalg.qr(self.regressor)[1])
        return np.asarray(back @ self._basis.T @ (rho**self._lag @ self._basis) @ back.T)
