"""Displacement by a point load P/E*: ``1/(pi r)`` of a half-space, and a regular part.

The regular part is 0 on a half-space. On a layer of thickness t, bonded to a rigid base, it is an integral
over the wavenumber; in a periodic cell it is the sum over all other periods, relative to the mean
displacement, by Ewald's method.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

erfc = np.vectorize(math.erfc, otypes=[float])

# Points of the integral over the wavenumber up to 25/t, and of the trapezoidal rule for the Bessel function.
WAVES, ANGLES = 240, 160


@dataclass(frozen=True)
class HalfSpace:
    """An elastic half-space."""

    def regular(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the regular part [1/mm] at points relative to the source."""
        return np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y)))


@dataclass(frozen=True)
class Layer:
    """A layer bonded to a rigid base."""

    thickness: float
    poisson_ratio: float = 0.5

    def regular(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the regular part [1/mm], ``int (M(kt) - 1) J0(kr) dk / pi``."""
        distance = np.hypot(x, y)
        r, index = np.unique(distance.round(12), return_inverse=True)
        node, weight = np.polynomial.legendre.leggauss(WAVES)
        q, weight = 12.5 * (node + 1.0), 12.5 * weight
        k = 3.0 - 4.0 * self.poisson_ratio
        m = (2.0 * k * np.sinh(2.0 * q) - 4.0 * q) / (2.0 * k * np.cosh(2.0 * q) + 4.0 * q**2 + 1.0 + k**2)
        angle = np.pi * (np.arange(ANGLES) + 0.5) / ANGLES
        bessel = np.cos(np.multiply.outer(r / self.thickness, np.multiply.outer(q, np.sin(angle))))
        value = bessel.mean(axis=-1) @ (weight * (m - 1.0)) / (np.pi * self.thickness)
        return np.asarray(value[index].reshape(distance.shape))


@dataclass(frozen=True)
class PeriodicHalfSpace:
    """A half-space on which all loads repeat with a rectangular cell."""

    width: float
    length: float

    def regular(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the sum over all periods but the source itself, relative to its mean [1/mm]."""
        x, y = (np.asarray(each, dtype=float) for each in np.broadcast_arrays(x, y))
        cell, alpha = self.width * self.length, math.sqrt(math.pi / (self.width * self.length))
        total = np.full(x.shape, -2.0 / (math.sqrt(math.pi) * alpha * cell))
        reach = [math.ceil(6.0 / (alpha * side)) + 1 for side in (self.width, self.length)]
        for i in range(-reach[0], reach[0] + 1):
            for j in range(-reach[1], reach[1] + 1):
                r = np.hypot(x - i * self.width, y - j * self.length)
                if i or j:
                    near = r < 6.5 / alpha
                    total[near] += erfc(alpha * r[near]) / (np.pi * r[near])
                else:  # erfc - 1 = -erf; at r = 0 its limit
                    erf = np.divide(1.0 - erfc(alpha * r), r, where=r > 0.0, out=np.full(r.shape, np.nan))
                    total -= np.where(r > 0.0, erf, 2.0 * alpha / math.sqrt(math.pi)) / np.pi
        last = [math.ceil(6.0 * alpha * side / np.pi) for side in (self.width, self.length)]
        for i in range(-last[0], last[0] + 1):
            for j in range(-last[1], last[1] + 1):
                q = 2.0 * np.pi * math.hypot(i / self.width, j / self.length)
                if 0.0 < q < 12.0 * alpha:
                    wave = np.cos(2.0 * np.pi * (i * x / self.width + j * y / self.length))
                    total += 2.0 / (q * cell) * math.erfc(q / (2.0 * alpha)) * wave
        return total


Substrate = HalfSpace | Layer | PeriodicHalfSpace


def point_loads(substrate: Substrate, position: np.ndarray) -> np.ndarray:
    """Return the influence matrix (n, n) [1/mm] of point loads, with the regular part on its diagonal."""
    x, y = np.moveaxis(position[:, None, :] - position, -1, 0)
    r = np.hypot(x, y)
    np.fill_diagonal(r, np.inf)
    return 1.0 / (np.pi * r) + substrate.regular(x, y)
