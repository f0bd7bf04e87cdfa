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

import numpy as np
from scipy.special import erfc

from metafem._validate import FloatArray
from metafem.material import PeriodicCell

# Number of points for which the sums are computed at once.
BATCH = 2**14


def lattice_sum(
    cell: PeriodicCell,
    x: FloatArray,
    y: FloatArray,
    transform: Callable[[FloatArray], FloatArray],
    last_wavenumber: float,
    splitting: float = 1.0,
) -> FloatArray:
    """Return S [1/mm], its two slopes [1/mm^2] and its Laplacian [1/mm^3], (4, ...), at x, y [mm].

    transform: T(q) [mm] at wavenumbers q [1/mm], zero beyond `last_wavenumber`; T(0) is the mean.
    splitting: factor of alpha, on which the sums do not depend; the default balances the two parts.
    """
    alpha = splitting * math.sqrt(math.pi / cell.area)
    end = 6.0  # erfc(6) is 2e-17, zero to rounding

    def screened(r: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return erfc(alpha r)/(pi r) and its first two derivatives."""
        value = erfc(alpha * r) / (math.pi * r)
        gauss = 2.0 * alpha / math.pi**1.5 * np.exp(-((alpha * r) ** 2))
        first = -(value + gauss) / r
        return value, first, 2.0 * (alpha**2 * gauss - first / r)

    own = -2.0 * alpha / math.pi**1.5, 8.0 * alpha**3 / (3.0 * math.pi**1.5)
    found = image_sum(cell, x, y, screened, end / alpha, own).reshape(4, -1)
    found[0] -= 2.0 / (math.sqrt(math.pi) * alpha * cell.area)
    last = max(2.0 * end * alpha, last_wavenumber)
    qx, qy = (
        2.0 * math.pi / side * np.arange(int(last * side / (2.0 * math.pi)) + 1.0)
        for side in (cell.width, cell.length)
    )
    square = qx[:, None] ** 2 + qy**2
    q = np.sqrt(square)
    q[0, 0] = 1.0
    smooth = 2.0 / q * erfc(q / (2.0 * alpha))
    q[0, 0] = smooth[0, 0] = 0.0
    # every wave stands for those with negative wavenumbers, too
    number = np.multiply.outer(*(np.where(k > 0.0, 2.0, 1.0) for k in (qx, qy)))
    f = np.where(q <= last, number * (smooth + transform(q)) / cell.area, 0.0)
    series = f, -qx[:, None] * f, -qy * f, -square * f
    flat_x, flat_y = cell.nearest(np.ravel(x), np.ravel(y))
    for start in range(0, flat_x.size, BATCH):
        part = slice(start, start + BATCH)
        phase_x, phase_y = np.outer(flat_x[part], qx), np.outer(flat_y[part], qy)
        cos_x, cos_y = np.cos(phase_x), np.cos(phase_y)
        factors = (cos_x, cos_y), (np.sin(phase_x), cos_y), (cos_x, np.sin(phase_y)), (cos_x, cos_y)
        for line, terms, (along_x, along_y) in zip(found, series, factors, strict=True):
            line[part] += ((along_x @ terms) * along_y).sum(axis=1)
    found[1:3, (flat_x == 0.0) & (flat_y == 0.0)] = 0.0  # by symmetry; the series has rounding
    return found.reshape(4, *np.shape(x))


def image_sum(
    cell: PeriodicCell,
    x: FloatArray,
    y: FloatArray,
    radial: Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]],
    reach: float,
    own: tuple[float, float],
) -> FloatArray:
    """Return the sum of a function of r, its gradient and Laplacian, (4, ...), over all periods within reach.

    radial: the function with its first two derivatives; own: its value and its Laplacian at r = 0.
    """
    flat_x, flat_y = cell.nearest(np.ravel(x), np.ravel(y))
    total = np.zeros((4, flat_x.size))
    most_x, most_y = (math.ceil(reach / side + 0.5) for side in (cell.width, cell.length))
    for i in range(-most_x, most_x + 1):
        for j in range(-most_y, most_y + 1):
            dx, dy = flat_x - i * cell.width, flat_y - j * cell.length
            r = np.hypot(dx, dy)
            used = np.flatnonzero((r > 0.0) & (r < reach))
            if used.size:
                dx, dy, r = dx[used], dy[used], r[used]
                value, first, second = radial(r)
                total[:, used] += np.array([value, first * dx / r, first * dy / r, second + first / r])
    at_source = (flat_x == 0.0) & (flat_y == 0.0)
    total[0, at_source] += own[0]
    total[3, at_source] += own[1]
    return total.reshape(4, *np.shape(x))
