"""Smallest possible standard errors of a cap's height, radius and position under correlated roughness."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from validation.scenes.height_maps import Roughness

# Rings of a cap: their width is a fifth of the shortest correlation length that is used, 4 um, or less.
RINGS = 400


def smallest_errors(
    height: float,
    radius: float,
    roughness: Roughness,
    noise: float = 0.3e-3,
    pixel: float = 2e-3,
    steepest: float = 1.0,
    common_radius: bool = False,
) -> FloatArray:
    """Return standard errors of height, radius and one coordinate of generalised least squares [mm].

    By the Gauss-Markov theorem no unbiased linear estimate has smaller ones, and for Gaussian errors no
    unbiased estimate at all. The map is known on the cap down to its foot, or to the slope `steepest`.

    With the covariance ``C(r) = s^2 exp(-r^2 / l^2)`` and white noise of the intensity
    ``W = noise^2 pixel^2`` the problem separates by the angle. Height and radius depend on the means over
    rings, whose covariance is
    ``s^2 exp(-(p^2 + q^2) / l^2) I_0(2 p q / l^2) + W / (2 pi p dp)``, and a coordinate on the amplitudes of
    cos(phi), with ``2 I_1`` and ``W / (pi p dp)`` in place of these.
    """
    reach = math.sqrt(height * (2.0 * radius - height))
    reach = min(reach, radius * steepest / math.hypot(1.0, steepest))
    step = reach / RINGS
    p = step * (np.arange(RINGS) + 0.5)
    root = np.sqrt(radius**2 - p**2)
    by_height, by_radius, by_x = np.ones(RINGS), radius / root - 1.0, p / root
    rings = np.array([by_height] if common_radius else [by_height, by_radius])
    first = _information(rings, p, step, 0, roughness, noise * pixel)
    second = _information(by_x[None], p, step, 1, roughness, noise * pixel)
    errors = np.sqrt(np.diagonal(np.linalg.inv(first)))
    return np.array([errors[0], 0.0 if common_radius else errors[1], 1.0 / math.sqrt(second[0, 0])])


def _information(
    columns: FloatArray, p: FloatArray, step: float, order: int, roughness: Roughness, white: float
) -> FloatArray:
    from scipy.linalg import cho_factor, cho_solve
    from scipy.special import ive

    across = 2.0 * p * p[:, None] / roughness.length**2
    near = np.exp(-((p - p[:, None]) ** 2) / roughness.length**2)
    covariance = (1.0 + order) * roughness.sd**2 * near * ive(order, across)
    covariance += np.diag((1.0 + order) * white**2 / (2.0 * math.pi * p * step))
    return np.asarray(columns @ cho_solve(cho_factor(covariance), columns.T))
