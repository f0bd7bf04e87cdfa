"""Incompressible neo-Hookean rubber under axisymmetric deformation.

The functions take the displacement gradient ``H = F - 1``, because far from the contact H is small and F
would lose its digits. The five components (..., 5) are H11, H12, H21 and H22 in (r, z), and the hoop
component H33.
"""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray

# Matrix that maps (F11, F12, F21, F22) to the derivatives of the determinant F11 F22 - F12 F21.
TURN = np.array([[0, 0, 0, 1], [0, 0, -1, 0], [0, -1, 0, 0], [1, 0, 0, 0]], dtype=np.float64)

# Unit tensor.
ONE = np.array([1.0, 0.0, 0.0, 1.0, 1.0])


def _area_change(h: FloatArray) -> FloatArray:
    """Return F11 F22 - F12 F21 - 1."""
    return np.asarray(h[..., 0] + h[..., 3] + h[..., 0] * h[..., 3] - h[..., 1] * h[..., 2])


def volume_change(h: FloatArray) -> FloatArray:
    """Return J - 1 = det F - 1."""
    area, hoop = _area_change(h), h[..., 4]
    return np.asarray(area + hoop + area * hoop)


def volume_slope(h: FloatArray) -> FloatArray:
    """Return dJ/dF minus the unit tensor, (..., 5)."""
    turned, hoop = h[..., :4] @ TURN, h[..., 4:]
    plane = turned + hoop * (ONE[:4] + turned)
    return np.concatenate([plane, _area_change(h)[..., None]], axis=-1)


def stress(h: FloatArray, pressure: FloatArray, shear_modulus: float) -> FloatArray:
    """Return the first Piola-Kirchhoff stress dW/dF, (..., 5).

    ``W = mu/2 (F:F - 3 - 2 ln J) - p (J - 1)``. The logarithm is zero in an incompressible body. With it, the
    mean stress in the undeformed state is -p.
    """
    slope, volume = volume_slope(h), volume_change(h)[..., None]
    inverse = (slope - volume * ONE) / (1.0 + volume)
    return np.asarray(shear_modulus * (h - inverse) - pressure[..., None] * (ONE + slope))


def tangent(h: FloatArray, pressure: FloatArray, shear_modulus: float) -> FloatArray:
    """Return d^2 W/dF^2 at fixed p, (..., 5, 5)."""
    volume = 1.0 + volume_change(h)
    inverse = (ONE + volume_slope(h)) / volume[..., None]
    bend = np.zeros((*volume.shape, 5, 5))
    bend[..., :4, :4] = (1.0 + h[..., 4, None, None]) * TURN
    bend[..., :4, 4] = bend[..., 4, :4] = (ONE[:4] + h[..., :4]) @ TURN
    factor = (shear_modulus / volume + pressure)[..., None, None]
    return np.asarray(
        shear_modulus * (np.eye(5) + inverse[..., :, None] * inverse[..., None, :]) - factor * bend
    )


def energy(h: FloatArray, shear_modulus: float) -> FloatArray:
    """Return the energy density ``mu/2 (F:F - 3 - 2 ln J)`` per undeformed volume, (...)."""
    square = np.sum(h**2, axis=-1) + 2.0 * (h @ ONE)
    return np.asarray(0.5 * shear_modulus * (square - 2.0 * np.log1p(volume_change(h))))
