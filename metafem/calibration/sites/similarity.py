"""Shift, rotation and scale between the sites of a design and their image, as complex numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray

ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class Similarity:
    """The map w -> factor w + shift of the plane, with points x + iy as complex numbers."""

    factor: complex
    shift: complex

    def image(self, sites: ComplexArray) -> ComplexArray:
        """Return the images of sites."""
        return self.factor * sites + self.shift

    def sites(self, points: ComplexArray) -> ComplexArray:
        """Return the points of the design whose images are given."""
        return (points - self.shift) / self.factor


def complex_points(points: FloatArray, mirrored: bool = False) -> ComplexArray:
    """Return points (n, 2) as x + iy, or as -x + iy."""
    x, y = np.asarray(points, dtype=np.float64).T
    return np.asarray((-x if mirrored else x) + 1j * y, dtype=np.complex128)


def real_points(points: ComplexArray) -> FloatArray:
    """Return complex numbers as points (n, 2)."""
    return np.column_stack([points.real, points.imag])


def fitted(points: ComplexArray, sites: ComplexArray) -> Similarity:
    """Return the similarity with the least squares of ``points - image(sites)``; two pairs are enough."""
    middle, origin = points.mean(), sites.mean()
    away = sites - origin
    factor = np.vdot(away, points - middle) / np.vdot(away, away).real
    return Similarity(complex(factor), complex(middle - factor * origin))
