"""Lattice sums of an influence over all periods of a rectangular cell, with their derivatives.

With the lattice vectors R, the area A of the cell and the wave vectors q of its Fourier series, the influence
``1/(pi r) + g(r)`` has by Ewald's method the sum

    S(x) = sum_R erfc(alpha |x - R|) / (pi |x - R|) - 2/(sqrt(pi) alpha A)
           + 1/A sum_q [2/q erfc(q/(2 alpha)) + T(q)] exp(i q.x),

where T is the transform of the regular part g, and the term of 1/(pi r) with q = 0 is left out: its mean
diverges. The sum is thus relative to the mean displacement of a half-space, whereas T(0) contains the mean of
a layer. At x = 0 the influence 1/(pi r) of the source itself is subtracted; its smooth part is
``erf(alpha r)/(pi r) = 2 alpha/pi^(3/2) (1 - alpha^2 r^2/3 + ...)``.

Ewald, Annalen der Physik 369, 253 (1921), doi:10.1002/andp.19213690304.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.special import erfc

from metafem._validate import FloatArray
from metafem.material import PeriodicCell

# Argument u beyond which erfc(u) is zero to rounding: erfc(6) is 2e-17.
LAST = 6.0

# Number of points for which the sums are computed at once.
BATCH = 2**14


class LatticeSum(NamedTuple):
    """Displacement S [1/mm] by all periods of a source, its gradient [1/mm^2] and Laplacian [1/mm^3]."""

    value: FloatArray
    slope_x: FloatArray
    slope_y: FloatArray
    laplacian: FloatArray


def lattice_sum(
    cell: PeriodicCell,
    x: FloatArray,
    y: FloatArray,
    transform: Callable[[FloatArray], FloatArray],
    last_wavenumber: float,
    splitting: float = 1.0,
) -> LatticeSum:
    """Return the sums at points x, y [mm] from a source, arrays of any one shape.

    transform: T(q) [mm] at wavenumbers q [1/mm], zero beyond `last_wavenumber`; T(0) is the mean.
    splitting: factor of alpha, on which the sums do not depend; the default balances the two parts.
    """
    alpha = splitting * math.sqrt(math.pi / cell.area)
    series = _Series.of(cell, alpha, transform, max(2.0 * LAST * alpha, last_wavenumber))
    flat_x, flat_y = cell.nearest(np.ravel(x), np.ravel(y))
    found = np.empty((4, flat_x.size))
    for start in range(0, flat_x.size, BATCH):
        part = slice(start, start + BATCH)
        found[:, part] = series.at(flat_x[part], flat_y[part])
        found[:, part] += _images(cell, alpha, flat_x[part], flat_y[part])
    found[1:3, (flat_x == 0.0) & (flat_y == 0.0)] = 0.0  # by symmetry; the series has rounding
    found[0] -= 2.0 / (math.sqrt(math.pi) * alpha * cell.area)
    return LatticeSum(*(line.reshape(np.shape(x)) for line in found))


class _Series(NamedTuple):
    """Fourier series of the smooth part: wavenumbers along x and y from 0, and their coefficients."""

    along_x: FloatArray
    along_y: FloatArray
    coefficient: FloatArray  # with the weights of negative wavenumbers

    @classmethod
    def of(
        cls, cell: PeriodicCell, alpha: float, transform: Callable[[FloatArray], FloatArray], last: float
    ) -> _Series:
        qx, qy = (
            2.0 * math.pi / side * np.arange(int(last * side / (2.0 * math.pi)) + 1.0)
            for side in (cell.width, cell.length)
        )
        q = np.hypot(qx[:, None], qy)
        q[0, 0] = 1.0
        value = 2.0 / q * erfc(q / (2.0 * alpha))
        q[0, 0] = value[0, 0] = 0.0
        value += transform(q)
        weight = np.multiply.outer(*(np.where(np.arange(k.size) == 0, 1.0, 2.0) for k in (qx, qy)))
        return cls(qx, qy, np.where(q <= last, weight * value / cell.area, 0.0))

    def at(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the series, its gradient and its Laplacian at points, (4, k)."""
        qx, qy, f = self
        phase_x, phase_y = np.outer(x, qx), np.outer(y, qy)
        cos_x, cos_y = np.cos(phase_x), np.cos(phase_y)
        square = qx[:, None] ** 2 + qy**2
        return np.array(
            [
                ((cos_x @ f) * cos_y).sum(axis=1),
                ((np.sin(phase_x) @ (-qx[:, None] * f)) * cos_y).sum(axis=1),
                ((cos_x @ (-qy * f)) * np.sin(phase_y)).sum(axis=1),
                ((cos_x @ (-square * f)) * cos_y).sum(axis=1),
            ]
        )


def _images(cell: PeriodicCell, alpha: float, x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the sum of erfc(alpha r)/(pi r) over all periods, its gradient and its Laplacian, (4, k)."""
    total = np.zeros((4, x.size))
    most_x, most_y = (math.ceil(LAST / (alpha * side) + 0.5) for side in (cell.width, cell.length))
    for i in range(-most_x, most_x + 1):
        for j in range(-most_y, most_y + 1):
            dx, dy = x - i * cell.width, y - j * cell.length
            r = np.hypot(dx, dy)
            used = np.flatnonzero((r > 0.0) & (r < LAST / alpha))
            if not used.size:
                continue
            dx, dy, r = dx[used], dy[used], r[used]
            value = erfc(alpha * r) / r
            gauss = 2.0 * alpha / math.sqrt(math.pi) * np.exp(-((alpha * r) ** 2))
            first = -(value + gauss) / r  # derivative of erfc(alpha r)/r
            laplacian = -first / r + 2.0 * alpha**2 * gauss
            terms = value, first * dx / r, first * dy / r, laplacian
            total[:, used] += np.array(terms) / math.pi
    own = np.flatnonzero((x == 0.0) & (y == 0.0))
    total[0, own] -= 2.0 * alpha / math.pi**1.5
    total[3, own] += 8.0 * alpha**3 / (3.0 * math.pi**1.5)
    return total
