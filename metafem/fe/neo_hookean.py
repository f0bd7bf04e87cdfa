"""Incompressible neo-Hookean rubber under axisymmetric deformation."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray

# Derivative of the determinant F11 F22 - F12 F21 by F, as a matrix on (F11, F12, F21, F22).
TURN = np.array([[0, 0, 0, 1], [0, 0, -1, 0], [0, -1, 0, 0], [1, 0, 0, 0]], dtype=np.float64)


def volume_ratio(gradient: FloatArray) -> FloatArray:
    """Return ``J = (F11 F22 - F12 F21) F33`` of deformation gradients (..., 5).

    The components are F11, F12, F21, F22 by (r, z), and the hoop stretch F33.
    """
    f11, f12, f21, f22, hoop = np.moveaxis(gradient, -1, 0)
    return np.asarray((f11 * f22 - f12 * f21) * hoop)


def volume_slope(gradient: FloatArray) -> FloatArray:
    """Return dJ/dF, (..., 5)."""
    four, hoop = gradient[..., :4], gradient[..., 4:]
    cofactor = four @ TURN
    plane = 0.5 * np.sum(four * cofactor, axis=-1, keepdims=True)
    return np.concatenate([hoop * cofactor, plane], axis=-1)


def stress(gradient: FloatArray, pressure: FloatArray, shear_modulus: float) -> FloatArray:
    """Return the first Piola-Kirchhoff stress dW/dF, (..., 5).

    ``W = mu/2 (F:F - 3 - 2 ln J) - p (J - 1)``. The logarithm vanishes in an incompressible body; it makes
    p the whole of the mean stress at rest.
    """
    slope = volume_slope(gradient)
    inverse = slope / volume_ratio(gradient)[..., None]
    return np.asarray(shear_modulus * (gradient - inverse) - pressure[..., None] * slope)


def tangent(gradient: FloatArray, pressure: FloatArray, shear_modulus: float) -> FloatArray:
    """Return d^2 W/dF^2 at fixed p, (..., 5, 5)."""
    slope, volume = volume_slope(gradient), volume_ratio(gradient)
    inverse = slope / volume[..., None]
    bend = np.zeros((*volume.shape, 5, 5))
    bend[..., :4, :4] = gradient[..., 4, None, None] * TURN
    bend[..., :4, 4] = bend[..., 4, :4] = gradient[..., :4] @ TURN
    share = (shear_modulus / volume + pressure)[..., None, None]
    return np.asarray(
        shear_modulus * (np.eye(5) + inverse[..., :, None] * inverse[..., None, :]) - share * bend
    )
