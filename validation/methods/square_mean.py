"""Mean displacement of a half-space under a uniform pressure on a square."""

from __future__ import annotations

import numpy as np

# Gauss points in angle and in distance: the integrand is smooth in polar coordinates.
POINTS = 40


def mean_influence() -> float:
    """Return c of the mean displacement c p sqrt(A)/E*: the mean of 1/(pi r) over all pairs of points.

    Differences of two points of the unit square have the density (1 - |x|)(1 - |y|). In polar coordinates r
    cancels: 8/pi int_0^(pi/4) int_0^(1/cos t) (1 - r cos t)(1 - r sin t) dr dt.
    """
    node, weight = np.polynomial.legendre.leggauss(POINTS)
    angle = 0.125 * np.pi * (node + 1.0)
    reach = 1.0 / np.cos(angle)
    r = 0.5 * reach[:, None] * (node + 1.0)
    values = (1.0 - r * np.cos(angle)[:, None]) * (1.0 - r * np.sin(angle)[:, None])
    along = 0.5 * reach * (values @ weight)
    return float(8.0 / np.pi * 0.125 * np.pi * (along @ weight))
