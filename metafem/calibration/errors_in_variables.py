"""Least squares with errors of all quantities: the true abscissae of the points are unknowns of the fit.

A Gauss-Newton step solves for the parameters after the abscissae of each point are eliminated, so that the
work grows in proportion to the number of points, and many fits are solved at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray

# SHARES are the lengths of the steps. The iteration ends when the change of the parameters, over their
# standard deviations, is below ENOUGH. A full step reduces the change by a factor of about 100; smaller steps
# are needed if the errors of the abscissae are as large as the abscissae.
SHARES, ENOUGH = (1.0,) * 15 + (0.5,) * 45 + (0.2,) * 140, 1e-9

# Returns the quantities at parameters (..., q) and abscissae (..., k, n): values (..., k, c), and their
# derivatives with respect to the parameters (..., k, c, q) and the abscissae (..., k, c, n).
Model = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray, FloatArray]]


@dataclass(frozen=True, eq=False)
class Fit:
    """Fits of parameters to one or many sets of points.

    Attributes
    ----------
    parameter : ndarray, (..., q)
    covariance : ndarray, (..., q, q)
        Inverse of half the curvature of chi-square, minimised over the abscissae.
    abscissa : ndarray, (..., k, n)
        Fitted abscissae.
    chi_square : ndarray, (..., k)
        Chi-square of each point.
    converged : ndarray of bool, (...,)
    """

    parameter: FloatArray
    covariance: FloatArray
    abscissa: FloatArray
    chi_square: FloatArray
    converged: NDArray[np.bool_]


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # some of many fits may not exist
def fit(
    model: Model,
    measured: FloatArray,
    deviation: Callable[[FloatArray], FloatArray],
    parameter: FloatArray,
    abscissa: FloatArray,
    bounds: tuple[float | FloatArray, float | FloatArray] = (-np.inf, np.inf),
) -> Fit:
    """Return the least-squares fit of a model to measured quantities (..., k, c), nan where not measured.

    The sum over all measured quantities of ``((y - f(p, x)) / s)^2`` is minimised over the parameters p and
    the abscissae x of all points. `deviation` returns the standard deviations s at the values of the model.
    If they were computed from measured values, values that are too small by chance would have too much weight
    and bias the parameters. `parameter` and `abscissa` are initial guesses, and the abscissae stay within
    `bounds`. York, Earth Planet. Sci. Lett. 5, 320 (1968), doi:10.1016/S0012-821X(68)80059-7.
    """
    known = np.isfinite(measured)
    y = np.where(known, measured, 0.0)
    p, x = parameter, abscissa
    covariance, square = np.empty(0), np.empty(0)
    done: NDArray[np.bool_] = np.zeros(p.shape[:-1], dtype=np.bool_)
    for step, share in enumerate(SHARES):
        value, by_p, by_x = model(p, x)
        weight = known / deviation(value) ** 2
        off = y - value
        square = (weight * off**2).sum(axis=-1)
        weighted = weight[..., None] * by_x
        normal = np.swapaxes(weighted, -1, -2) @ by_x
        # an abscissa on which no quantity depends is held
        inverse = _inverse(normal + (normal == 0.0) * np.eye(normal.shape[-1]))
        mixed = np.swapaxes(weighted, -1, -2) @ by_p
        right_x = (weighted * off[..., None]).sum(axis=-2)
        curvature = (np.swapaxes(by_p, -1, -2) @ (weight[..., None] * by_p)).sum(axis=-3)
        reduced = np.swapaxes(mixed, -1, -2) @ inverse
        curvature = curvature - (reduced @ mixed).sum(axis=-3)
        right = (by_p * (weight * off)[..., None]).sum(axis=(-3, -2))
        right = right - (reduced @ right_x[..., None])[..., 0].sum(axis=-2)
        covariance = _inverse(curvature)
        change = (covariance @ right[..., None])[..., 0]
        moved = (inverse @ (right_x[..., None] - mixed @ change[..., None, :, None]))[..., 0]
        sd = np.sqrt(np.einsum("...ii->...i", covariance))
        done = np.asarray((np.abs(change) <= ENOUGH * sd).all(axis=-1) & (step > 0))
        if (done | ~np.isfinite(change).all(axis=-1)).all():
            break
        p = p + share * change
        x = np.clip(x + share * moved, *bounds)
    return Fit(p, covariance, x, square, done)


def _inverse(matrix: FloatArray) -> FloatArray:
    """Return inverse matrices, nan for singular ones."""
    singular = np.linalg.det(matrix) == 0.0
    return np.linalg.inv(np.where(singular[..., None, None], np.nan, matrix))
