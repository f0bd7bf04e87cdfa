"""Fit of E* and the adhesion energy to loads and areas that both have errors."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.calibration.covariance import propagated
from metafem.contact import JKR
from metafem.material import Material

# SHARES are the step lengths for the fitted areas. The iteration ends when the change of the parameters, over
# their standard deviations, is below ENOUGH. A full step reduces the change by a factor of about 100; smaller
# steps are needed if the errors of the areas are as large as the areas.
SHARES, ENOUGH = (1.0,) * 15 + (0.5,) * 45 + (0.2,) * 140, 1e-9

# Smallest ratio of a fitted to a measured area during the iteration, which keeps the areas positive.
SMALLEST_PART = 0.1

# JKR law with w = 1 N/mm and E* = 1 MPa.
UNIT = JKR(1.0, material=Material(1.0))

# Returns P/E* [mm^2] and its derivative with respect to the area [-] for contact areas (..., n) [mm^2].
Curve = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, eq=False)
class DistanceFit:
    """Fits of ``P = c sum_j (E* q(A_j) - b s(A_j))`` to one or many sets of data.

    Attributes
    ----------
    modulus, product : ndarray, (...,)
        E* [MPa] and b = sqrt(w E*) [N/mm^(3/2)], of either sign.
    covariance : ndarray, (..., 2, 2)
        Covariance of E* and b.
    residual : ndarray, (..., k)
        Distances of the points from the curve over their standard deviations [-].
    area : ndarray, (..., k, n)
        Fitted areas of single contacts [mm^2].
    converged : ndarray of bool, (...,)
    """

    modulus: FloatArray
    product: FloatArray
    covariance: FloatArray
    residual: FloatArray
    area: FloatArray
    converged: NDArray[np.bool_]

    @property
    def root(self) -> FloatArray:
        """Root sqrt(w) = b/sqrt(E*) [sqrt(N/mm)], with the sign of b; nan where E* is not positive."""
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
    """Return s = sqrt(8 pi a^3) [mm^(3/2)] at areas pi a^2, and its derivative with respect to the area.

    Adhesion (`metafem.JKR`) lowers the load of a cap by ``sqrt(w E*) s``.
    """
    radius = np.sqrt(area / math.pi)
    lowered = 2.0 * radius * UNIT.deficit(radius)
    return lowered, np.divide(0.75 * lowered, area, np.zeros(area.shape), where=area > 0.0)


@np.errstate(divide="ignore", invalid="ignore")  # draws with equal areas or without weights have no fit
def distance_fit(
    load: FloatArray,
    area: FloatArray,
    curve: Curve,
    *,
    contacts: int,
    load_sd: Any,
    area_sd: Callable[[FloatArray], FloatArray],
    largest: float | FloatArray = math.inf,
) -> DistanceFit:
    """Return the fit of E* and b to loads (..., k) [N] and areas (..., k, n) [mm^2] of single contacts.

    The fit minimises the sum of the squared distances from the curve, over their variances. A load is the sum
    of the loads at the n areas, multiplied by `contacts`, the number of contacts per area. `load_sd` [N] is
    the standard deviation of the loads, `area_sd` returns the standard deviations of areas [mm^2], and
    `largest` [mm^2] is the largest area of the curve.

    Each step linearises the curve about the fitted areas A. It regresses
    ``y = P - c sum_j p'(A_j) (A_measured - A_j)`` on q(A) and s(A) with the variances
    ``V = load_sd^2 + sum_j (c p' area_sd)^2``. Then ``A_j = A_measured + c p' area_sd^2 r/V`` with the
    residual r. Regressors and weights are evaluated at A, because the errors of A and r are independent. If
    they were evaluated at the measured areas, E* would have a bias in proportion to the variances of the
    areas: 1/30 of its standard deviation for the default errors. York, Earth Planet. Sci. Lett. 5, 320
    (1968), doi:10.1016/S0012-821X(68)80059-7.
    """
    variance = np.broadcast_to(np.asarray(load_sd, dtype=np.float64) ** 2, load.shape)
    fitted = area
    sloped: FloatArray = np.zeros(area.shape)  # c p'
    spread: FloatArray = np.zeros(area.shape)  # variances of the areas
    known = np.zeros((*load.shape[:-1], 2))
    done: NDArray[np.bool_] = np.zeros(load.shape[:-1], dtype=np.bool_)
    residual = np.zeros(load.shape)
    for step in range(len(SHARES)):
        rescaled, slope = curve(fitted)
        lowered, steepness = adhesive_load(fitted)
        q, s = contacts * rescaled.sum(axis=-1), -contacts * lowered.sum(axis=-1)
        y = load - (sloped * (area - fitted)).sum(axis=-1)
        total = variance + (sloped**2 * spread).sum(axis=-1)
        weight = 1.0 / total
        found, covariance = _regression(q, s, y, weight)
        deviation = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
        done = np.asarray((np.abs(found - known) <= ENOUGH * deviation).all(axis=-1) & (step > 0))
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
    normal = residual * np.sqrt(weight)
    return DistanceFit(known[..., 0], known[..., 1], covariance, normal, fitted, done)


def _regression(
    q: FloatArray, s: FloatArray, y: FloatArray, weight: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the least-squares coefficients of q and s, (..., 2), and their covariance, (..., 2, 2)."""
    pairs = (q, q), (q, s), (s, s), (q, y), (s, y)
    qq, qs, ss, qy, sy = ((weight * one * two).sum(axis=-1) for one, two in pairs)
    determinant = qq * ss - qs**2
    found = np.stack([ss * qy - qs * sy, qq * sy - qs * qy], axis=-1) / determinant[..., None]
    inverse = np.stack([ss, -qs, -qs, qq], axis=-1) / determinant[..., None]
    return found, inverse.reshape(*determinant.shape, 2, 2)
