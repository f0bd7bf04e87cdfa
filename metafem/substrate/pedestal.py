"""The cap below a contact: an elastic pedestal that stands on the block, not in it."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.surface import Surface

# Radius of the caps [mm], their heights [mm] and the compliance c_p [1/mm] that small-strain finite
# elements of the true cap on a block of 1000 mm find beyond Hertz's: d = d_Hertz + c_p P/(pi E*).
CAP_RADIUS = 0.526
CAP_HEIGHT = (0.12, 0.20, 0.27)
COMPLIANCE = (0.27, 0.46, 0.64)


def pedestal_compliance(height: FloatArray, radius: FloatArray) -> FloatArray:
    """Displacement of a summit by its own pedestal, per unit of P/E* [1/mm].

    By similarity ``c_p R`` is a function of ``h/R`` alone, and vanishes with it: a parabola without a
    constant through the three known caps, which it meets to half a unit of their last digit. Known
    for 0.2 < h/R < 0.52; summits at or below the base plane have no pedestal.

    Examples
    --------
    >>> (math.pi * pedestal_compliance(np.array([0.12, 0.27]), np.array([0.526, 0.526]))).round(2)
    array([0.27, 0.64])
    """
    linear, square = _parabola()
    x = np.maximum(height, 0.0) / radius
    return np.asarray(x * (linear + square * x) / (math.pi * radius))


def pedestal_rate(surface: Surface) -> FloatArray:
    """Derivative of `pedestal_compliance` by the height, (n,) [1/mm^2]."""
    linear, square = _parabola()
    x = np.maximum(surface.height, 0.0) / surface.radius
    slope = (linear + 2.0 * square * x) / (math.pi * surface.radius**2)
    return np.asarray(np.where(surface.height > 0.0, slope, 0.0))


def _parabola() -> tuple[float, float]:
    """Return the coefficients of ``c_p R`` by h/R and its square."""
    known = np.array(CAP_HEIGHT) / CAP_RADIUS
    powers = np.column_stack([known, known**2])
    linear, square = np.linalg.lstsq(powers, CAP_RADIUS * np.array(COMPLIANCE), rcond=None)[0]
    return float(linear), float(square)
