"""Surface displacement of a bonded elastic layer, by quadrature of its Hankel integral."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import j0, jn_zeros

from metafem._validate import FloatArray

# Upper limit of the integrals, beyond which 1 - M is below 1e-38. With 12 Gauss points in each of 250 panels,
# J0(x r/t) is integrated to rounding up to r = 30 t, where a panel contains about one period of J0.
LAST, PANELS, POINTS = 50.0, 250, 12

# Lattice sums end at this number of thicknesses, where the displacement of the layer has decayed to about
# 1e-8: for nu = 0.5 it decays as exp(-0.739 r/t).
LATTICE_EXTENT = 24.0

# Number of terms of the Dini series; the last terms are 1e-11 of the sum.
TERMS = 100_000


def multiplier(x: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return M(x) [-] of a layer on a rigid base, (k,); M is 1 for a half-space.

    ``(2 k sinh 2x - 4x)/(2 k cosh 2x + 4 x^2 + 1 + k^2)``, k = 3 - 4 nu; Johnson, Contact Mechanics
    (1985), section 5.8, doi:10.1017/CBO9781139171731.
    """
    k = 3.0 - 4.0 * poisson_ratio
    small = np.exp(-2.0 * x)
    above = k * (1.0 - small**2) - 4.0 * x * small
    return np.asarray(above / (k * (1.0 + small**2) + (4.0 * x**2 + 1.0 + k**2) * small))


def regular_influence(r: ArrayLike, thickness: float, poisson_ratio: float) -> FloatArray:
    """Return the influence of the layer minus that of the half-space, 1/(pi r) [1/mm]; finite at r = 0.

    ``1/(pi t) int_0^inf (M(x) - 1) J0(x r/t) dx``, for r up to 30 t.
    """
    return _integral(np.asarray(r, dtype=np.float64), thickness, poisson_ratio, 0)


def regular_laplacian(r: ArrayLike, thickness: float, poisson_ratio: float) -> FloatArray:
    """Return the surface Laplacian of `regular_influence`, ``-1/(pi t^3) int (M - 1) x^2 J0 dx`` [1/mm^3]."""
    return -_integral(np.asarray(r, dtype=np.float64), thickness, poisson_ratio, 2) / thickness**2


def influence(r: ArrayLike, thickness: float, poisson_ratio: float) -> FloatArray:
    """Return the surface displacement of the layer per unit P/E* at distances r > 0 [1/mm]."""
    distance = np.asarray(r, dtype=np.float64)
    return 1.0 / (math.pi * distance) + regular_influence(distance, thickness, poisson_ratio)


def lattice_sums(pitch: float, thickness: float, poisson_ratio: float) -> tuple[float, float]:
    """Return the influence [1/mm] and its Laplacian [1/mm^3] of an infinite square lattice at one site.

    The influence is the sum over all sites, with the regular part of the site itself. The Laplacian is the
    sum over all other sites.
    """
    count = math.ceil(LATTICE_EXTENT * thickness / pitch)
    index = np.arange(-count, count + 1)
    square = (index[:, None] ** 2 + index**2).ravel()
    square, number = np.unique(square[(square > 0) & (square <= count**2)], return_counts=True)
    r = pitch * np.sqrt(square)
    laplacian = 1.0 / (math.pi * r**3) + regular_laplacian(r, thickness, poisson_ratio)
    regular = float(regular_influence(0.0, thickness, poisson_ratio))
    return regular + math.fsum(number * influence(r, thickness, poisson_ratio)), math.fsum(number * laplacian)


def cell_influence(
    contact_radius: float, cell_radius: float, thickness: float, poisson_ratio: float
) -> float:
    """Return the central displacement of a Hertzian load on a cylinder minus that on a half-space [1/mm].

    Both are displacements per unit P/E*; on a half-space it is ``3/(4 a)``. The wall of the cylinder has no
    radial displacement and no shear. The displacement is a Dini series over the zeros of J1(k b):
    ``2/(pi b^2) sum M(k t) F(k a)/(k J0(k b)^2)``, F(x) = 3 (sin x - x cos x)/x^3.
    """
    zeros = jn_zeros(1, TERMS)
    k = zeros / cell_radius
    x = k * contact_radius
    source = 3.0 * (np.sin(x) - x * np.cos(x)) / x**3
    terms = multiplier(k * thickness, poisson_ratio) * source / (k * j0(zeros) ** 2)
    return 2.0 / (math.pi * cell_radius**2) * math.fsum(terms) - 0.75 / contact_radius


def _integral(r: FloatArray, thickness: float, poisson_ratio: float, power: int) -> FloatArray:
    y, w = np.polynomial.legendre.leggauss(POINTS)
    step = LAST / PANELS
    x = (step * (np.arange(PANELS)[:, None] + 0.5 * (y + 1.0))).ravel()
    weight = np.tile(0.5 * step * w, PANELS) * (multiplier(x, poisson_ratio) - 1.0) * x**power
    waves = j0(np.multiply.outer(r / thickness, x))
    return np.asarray(waves @ weight / (math.pi * thickness))
