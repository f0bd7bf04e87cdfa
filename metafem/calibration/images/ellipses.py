"""Ellipses with the moments of contacts, and contacts that are no ellipses."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.images.boundary import Contours


def semi_axes(shape: Contours, total: float) -> tuple[FloatArray, FloatArray]:
    """Return the semi-axes (n, 2) and the angles (n,) of the ellipses with the same moments.

    The contour lies s_t²/2 times its curvature inside of the boundary. The integral of x² over that strip is
    pi s_t² a³/(a + b) for an ellipse with the semi-axes a along x and b along y.
    """
    xx, yy, xy = shape.moment.T
    middle, half = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    moments = np.stack([middle + half, np.maximum(middle - half, 0.0)], axis=1)
    axes = 2.0 * np.sqrt(moments / shape.area[:, None])
    lost = math.pi * total**2
    added = lost * axes**3 / axes.sum(axis=1, keepdims=True)
    whole = 2.0 * np.sqrt((moments + added) / (shape.area[:, None] + lost))
    return whole, 0.5 * np.arctan2(2.0 * xy, xx - yy)


def compactness(area: FloatArray, moment: FloatArray) -> FloatArray:
    """Return the area over that of the ellipse with the same moments, squared: 1 for ellipses, else less.

    An ellipse has the area A with A² = 4 pi sqrt(M_xx M_yy - M_xy²), and no region of this area has smaller
    moments. Two circles that touch have 0.89, or 0.94 if the radius of one is 0.3 of the other's.
    """
    xx, yy, xy = moment.T
    return np.asarray(area**2 / (4.0 * math.pi * np.sqrt(np.maximum(xx * yy - xy**2, np.finfo(float).tiny))))
