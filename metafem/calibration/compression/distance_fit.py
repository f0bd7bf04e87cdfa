"""Fit of E* and adhesion energy to loads and areas with errors on both axes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.calibration.joint import propagated
from metafem.contact import JKR
from metafem.material import Material

# Step lengths for the fitted areas, and the change of the parameters over their standard deviations at which
# the iteration ends. A full step reduces the change by a factor of about 100; smaller steps are needed if
# errors of areas are as large as the areas.
SHARES, ENOUGH = (1.0,) * 15 + (0.5,) * 45 + (0.2,) * 140, 1e-9

# Smallest fitted area over the measured one during the iteration: the area of a contact stays positive.
SMALLEST_PART = 0.1

# Residuals, in standard deviations, beyond which the weights of a robust fit fall (Huber) and are 0 (Tukey):
# both have 95 % of the efficiency of least squares; the first steps with Huber's weights lead to Tukey's.
HUBER, TUKEY, APPROACHING = 1.345, 4.685, 5

# Variance of the parameters of Tukey's fit over the inverse of the weighted normal matrix, for normal errors:
# E[psi^2] E[w]/E[psi']^2, with psi = w r.
TUKEY_VARIANCE = 0.963

# Adhesion with w = 1 N/mm and E* = 1 MPa.
UNIT = JKR(1.0, material=Material(1.0))

# Load P/E* [mm^2] and its derivative by the area [-] of contacts of areas (..., n) [mm^2].
Curve = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, eq=False)
class DistanceFit:
    """Fits of ``P = c sum_j (E* q(A_j) - b s(A_j))`` to one or many sets of data.

    Attributes
    ----------
    modulus, product : ndarray, (...,)
        E* [MPa] and b = sqrt(w E*) [N/mm^(3/2)], of either sign.
    covariance : ndarray, (..., 2, 2)
        Of E* and b.
    residual : ndarray, (..., k)
        Distances of the points from the curve over their standard deviations [-].
    area : ndarray, (..., k, n)
        Fitted areas of single contacts [mm^2].
    weight : ndarray, (..., k)
        Weights of the points in addition to their standard deviations, 1 for least squares [-].
    regressor : ndarray, (..., k, 2)
        Change of the loads with E* and b, so that the covariance is the inverse of X^T X.
    converged : ndarray of bool, (...,)
    """

    modulus: FloatArray
    product: FloatArray
    covariance: FloatArray
    residual: FloatArray
    area: FloatArray
    weight: FloatArray
    regressor: FloatArray
    converged: NDArray[np.bool_]

    @property
    def root(self) -> FloatArray:
        """sqrt(w) = b/sqrt(E*) [sqrt(N/mm)], with the sign of b; nan where E* is not positive."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.product / np.sqrt(self.modulus))

    @property
    def root_covariance(self) -> FloatArray:
        """Covariance of E* and sqrt(w), (..., 2, 2)."""
        with np.errstate(invalid="ignore"):
            scale = np.sqrt(self.modulus)
        by_modulus = -0.5 * self.product / (scale * self.modulus)
        return propagated(self.covariance, (1.0, 0.0), (by_modulus, 1.0 / scale))


def adhesive_load(area: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return s = sqrt(8 pi a^3) [mm^(3/2)] of contacts of areas pi a^2, and its derivative by the area.

    `metafem.JKR` with w = E* = 1 lowers the load of a cap by s; the reduction is proportional to sqrt(w E*).
    """
    radius = np.sqrt(area / math.pi)
    lowered = 2.0 * radius * UNIT.deficit(radius)
    return lowered, np.divide(0.75 * lowered, area, np.zeros(area.shape), where=area > 0.0)


@np.errstate(divide="ignore", invalid="ignore")  # draws of one area and points without weight have no fit
def distance_fit(
    load: FloatArray,
    area: FloatArray,
    curve: Curve,
    *,
    contacts: int,
    load_sd: Any,
    area_sd: Callable[[FloatArray], FloatArray],
    largest: float | FloatArray = math.inf,
    robust: bool = False,
) -> DistanceFit:
    """Fit E* and b to loads (..., k) [N] and areas (..., k, n) [mm^2] of single contacts.

    The fit minimises the sum of the squared distances from the curve, over their variances. A load is the sum
    over the n areas, times `contacts` if one area represents that many. `load_sd` [N] is the standard
    deviation of the loads, `area_sd` returns those of areas [mm^2], and `largest` [mm^2] is the end of the
    curve. `robust` multiplies the weights by Tukey's, ``(1 - (r/4.685)^2)^2`` and 0 beyond, for residuals r.
    Beaton and Tukey, Technometrics 16, 147 (1974), doi:10.1080/00401706.1974.10489171.

    In each step the curve is linear about the fitted areas A: ``y = P - c sum_j p'(A_j) (A_measured - A_j)``
    is regressed on q(A) and s(A) with the variances ``V = load_sd^2 + sum_j (c p' area_sd)^2``, and
    ``A_j = A_measured + c p' area_sd^2 r/V`` with the residual r. Regressors and weights are evaluated at A,
    whose error is independent of that of r. Regressors at the measured areas would bias E* in proportion to
    the variances of the areas, by a thirtieth of its standard deviation at the usual errors. York, Earth
    Planet. Sci. Lett. 5, 320 (1968), doi:10.1016/S0012-821X(68)80059-7.
    """
    variance = np.broadcast_to(np.asarray(load_sd, dtype=np.float64) ** 2, load.shape)
    fitted = area
    sloped: FloatArray = np.zeros(area.shape)  # c p'
    spread: FloatArray = np.zeros(area.shape)  # variances of the areas
    known = np.zeros((*load.shape[:-1], 2))
    done: NDArray[np.bool_] = np.zeros(load.shape[:-1], dtype=np.bool_)
    residual, first = np.zeros(load.shape), APPROACHING if robust else 0
    for step in range(len(SHARES)):
        rescaled, slope = curve(fitted)
        lowered, steepness = adhesive_load(fitted)
        q, s = contacts * rescaled.sum(axis=-1), -contacts * lowered.sum(axis=-1)
        y = load - (sloped * (area - fitted)).sum(axis=-1)
        total = variance + (sloped**2 * spread).sum(axis=-1)
        weight = 1.0 / total
        robustness = _robust(residual * np.sqrt(weight), step) if robust else np.ones(load.shape)
        found, covariance = _regression(q, s, y, weight * robustness)
        deviation = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
        done = np.asarray((np.abs(found - known) <= ENOUGH * deviation).all(axis=-1) & (step > first))
        known = found
        residual = y - found[..., :1] * q - found[..., 1:] * s
        if done.all():
            break
        sloped = contacts * (found[..., :1, None] * slope - found[..., 1:, None] * steepness)
        spread = area_sd(fitted) ** 2
        total = variance + (sloped**2 * spread).sum(axis=-1)
        moved = area + sloped * spread * (residual / total)[..., None]
        moved = np.minimum(np.maximum(moved, SMALLEST_PART * area), largest)
        fitted = fitted + SHARES[step] * (moved - fitted)
    variance_of = TUKEY_VARIANCE if robust else 1.0
    regressor = np.stack([q, s], axis=-1) * np.sqrt(weight * robustness / variance_of)[..., None]
    normal, covariance = residual * np.sqrt(weight), variance_of * covariance
    return DistanceFit(known[..., 0], known[..., 1], covariance, normal, fitted, robustness, regressor, done)


def _robust(residual: FloatArray, step: int) -> FloatArray:
    """Return the weights of residuals over their standard deviations (..., k) in a step of a robust fit."""
    if step < APPROACHING:
        return np.asarray(HUBER / np.maximum(np.abs(residual), HUBER))
    return np.asarray((1.0 - np.minimum(np.abs(residual) / TUKEY, 1.0) ** 2) ** 2)


def _regression(
    q: FloatArray, s: FloatArray, y: FloatArray, weight: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the weighted least squares of y on q and s, (..., 2), and their covariance (..., 2, 2)."""
    pairs = (q, q), (q, s), (s, s), (q, y), (s, y)
    qq, qs, ss, qy, sy = ((weight * one * two).sum(axis=-1) for one, two in pairs)
    determinant = qq * ss - qs**2
    found = np.stack([ss * qy - qs * sy, qq * sy - qs * qy], axis=-1) / determinant[..., None]
    inverse = np.stack([ss, -qs, -qs, qq], axis=-1) / determinant[..., None]
    return found, inverse.reshape(*determinant.shape, 2, 2)
