"""Closed-form solutions for comparison with computed results; no solver uses them.

- One frictionless contact, and the displacement of a layer around it. The composite modulus is 1. The
  formulas for elastic-plastic contacts are those published, including their jumps: indentation w* = w/w_c,
  load P/P_c and area A/A_c are relative to those of a Hertz contact at first yield. The displacement of a
  layer is computed by quadrature of its Hankel integral.
- Equations S3 to S8 as printed by Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234. For
  small arguments they lose digits by cancellation; `metafem.inversion.density` evaluates them without.
"""

from __future__ import annotations

import math
from math import erf, exp, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import j0, jn_zeros

from metafem._validate import FloatArray

# Lattice sums end at this number of thicknesses, where the displacement of the layer has decayed to about
# 1e-8: for nu = 0.5 it decays as exp(-0.739 r/t).
LATTICE_EXTENT = 24.0


def hertz(contact_radius: float, radius: float) -> tuple[float, float]:
    """Return the load P/E* = ``4 a^3/(3 R)`` [mm^2] and the indentation ``a^2/R`` [mm] of a paraboloid.

    Hertz (1882), doi:10.1515/crll.1882.92.156.
    """
    return 4.0 / 3.0 * contact_radius**3 / radius, contact_radius**2 / radius


def hertz_pressure(r: FloatArray, contact_radius: float, radius: float) -> FloatArray:
    """Return the pressure over E*, ``2 a/(pi R) sqrt(1 - r^2/a^2)`` [-], and 0 outside the contact, (k,)."""
    square = np.maximum(1.0 - (r / contact_radius) ** 2, 0.0)
    return np.asarray(2.0 * contact_radius / (math.pi * radius) * np.sqrt(square))


def hertz_displacement(r: FloatArray, contact_radius: float, radius: float) -> FloatArray:
    """Return the surface displacement at distances r >= a, (k,) [mm].

    ``p0/(2 E* a) [(2 a^2 - r^2) asin(a/r) + a sqrt(r^2 - a^2)]``, Johnson, Contact Mechanics (1985),
    eq. 3.42a, doi:10.1017/CBO9781139171731.
    """
    a, peak = contact_radius, 2.0 * contact_radius / (math.pi * radius)
    root = a * np.sqrt((r - a) * (r + a))
    return np.asarray(0.5 * peak / a * ((2.0 * a**2 - r**2) * np.arcsin(a / r) + root))


def sneddon_sphere(contact_radius: float, radius: float) -> tuple[float, float]:
    """Return the load P/E* [mm^2] and the indentation [mm] of a spherical punch, for a < R.

    ``(a^2 + R^2)/2 ln((R + a)/(R - a)) - a R`` and ``a/2 ln((R + a)/(R - a))``,
    Sneddon, Int. J. Eng. Sci. 3, 47 (1965), doi:10.1016/0020-7225(65)90019-4.
    """
    a, half = contact_radius, math.atanh(contact_radius / radius)
    return (a**2 + radius**2) * half - a * radius, a * half


def jkr_contact_radius(load: float, radius: float, adhesion_energy: float) -> float:
    """Return the contact radius [mm] of an adhesive paraboloid.

    `load` is P/E* [mm^2], and `adhesion_energy` is w/E* [mm].
    ``a^3 = 3 R/4 [P/E* + 3 pi R w/E* + sqrt(6 pi R w/E* P/E* + (3 pi R w/E*)^2)]``, Johnson, Kendall and
    Roberts, Proc. R. Soc. A 324, 301 (1971), doi:10.1098/rspa.1971.0141.
    """
    pull = 3.0 * math.pi * radius * adhesion_energy
    force = load + pull + math.sqrt(2.0 * pull * load + pull**2)
    return math.cbrt(0.75 * radius * force)


def power_law(contact_radius: float, coefficient: float, exponent: float) -> tuple[float, float]:
    """Return the load P/E* [mm^2] and the indentation [mm] of a punch with the profile ``c r^n``.

    c is the `coefficient` and n the `exponent`. ``d = c a^n sqrt(pi) Gamma(n/2 + 1)/Gamma(n/2 + 1/2)``,
    ``P/E* = 2 a d n/(n + 1)``, Sneddon (1965), cited in `sneddon_sphere`.
    """
    n = exponent
    rise = math.sqrt(math.pi) * math.gamma(0.5 * n + 1.0) / math.gamma(0.5 * n + 0.5)
    indentation = coefficient * contact_radius**n * rise
    return 2.0 * contact_radius * indentation * n / (n + 1.0), indentation


def conductance(stiffness: float, composite_modulus: float, resistivity: float) -> float:
    """Return the conductance of contacts on a half-space, ``G = 2 k/(E* rho)``, from their stiffness k.

    `stiffness` is in N/mm and `composite_modulus` in MPa. `resistivity` is the sum of those of both bodies
    [ohm mm] or [mm K/W]; G is then in S or W/K. The identity holds for all elastic contacts without adhesion:
    Barber, Proc. R. Soc. A 459, 53 (2003), doi:10.1098/rspa.2002.1038.

    >>> conductance(stiffness=4.0, composite_modulus=2.0, resistivity=1.0)
    4.0
    """
    return 2.0 * stiffness / (composite_modulus * resistivity)


def kogut_etsion(w: float, poisson_ratio: float) -> tuple[float, float]:
    """Return the load P/P_c and the area A/A_c [-] at an indentation w/w_c [-].

    Kogut and Etsion, J. Appl. Mech. 69, 657 (2002), doi:10.1115/1.1490373. Beyond 110 w_c the contact is
    fully plastic: ``P = H A``, ``A = 2 pi R w``, with ``P_c = 2/3 K H pi w_c R`` and ``K = 0.454 + 0.41 nu``.
    """
    if w <= 1.0:
        return w**1.5, w
    if w <= 6.0:
        return 1.03 * w**1.425, 0.93 * w**1.136
    if w <= 110.0:
        return 1.40 * w**1.263, 0.94 * w**1.146
    return 3.0 / (0.454 + 0.41 * poisson_ratio) * w, 2.0 * w


def jackson_green(w: float, poisson_ratio: float, strain: float) -> tuple[float, float]:
    """Return the load P/P_c and the area A/A_c [-] at an indentation w/w_c [-]; `strain` is S_y/E* [-].

    Jackson and Green, J. Tribol. 127, 343 (2005), doi:10.1115/1.1866166.
    """
    if w <= 1.9:
        return w**1.5, w
    factor = 1.295 * math.exp(0.736 * poisson_ratio)  # C
    area = w * (w / 1.9) ** (0.14 * math.exp(23.0 * strain))
    yielding = 0.5 * math.pi * factor * strain  # sqrt(w_c/R)
    hardness = 2.84 * (1.0 - math.exp(-0.82 * (yielding * area**0.5) ** -0.7))  # H/S_y
    elastic = math.exp(-(w ** (5.0 / 12.0)) / 4.0) * w**1.5
    plastic = 4.0 * hardness / factor * (1.0 - math.exp(-(w ** (5.0 / 9.0)) / 25.0)) * w
    return elastic + plastic, area


def layer_multiplier(x: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return M(x) [-] of a layer on a rigid base, (k,); M is 1 for a half-space.

    ``(2 k sinh 2x - 4x)/(2 k cosh 2x + 4 x^2 + 1 + k^2)``, k = 3 - 4 nu; Johnson, Contact Mechanics
    (1985), section 5.8, doi:10.1017/CBO9781139171731.
    """
    k = 3.0 - 4.0 * poisson_ratio
    small = np.exp(-2.0 * x)
    above = k * (1.0 - small**2) - 4.0 * x * small
    return np.asarray(above / (k * (1.0 + small**2) + (4.0 * x**2 + 1.0 + k**2) * small))


def layer_regular(r: ArrayLike, thickness: float, poisson_ratio: float) -> FloatArray:
    """Return the influence of the layer minus that of the half-space, 1/(pi r) [1/mm]; finite at r = 0.

    ``1/(pi t) int_0^inf (M(x) - 1) J0(x r/t) dx``, for r up to 30 t.
    """
    return _layer_integral(np.asarray(r, dtype=np.float64), thickness, poisson_ratio, 0)


def layer_laplacian(r: ArrayLike, thickness: float, poisson_ratio: float) -> FloatArray:
    """Return the surface Laplacian of `layer_regular`, ``-1/(pi t^3) int (M - 1) x^2 J0 dx`` [1/mm^3]."""
    return -_layer_integral(np.asarray(r, dtype=np.float64), thickness, poisson_ratio, 2) / thickness**2


def layer_influence(r: ArrayLike, thickness: float, poisson_ratio: float) -> FloatArray:
    """Return the surface displacement of the layer per unit P/E* at distances r > 0 [1/mm]."""
    return layer_regular(r, thickness, poisson_ratio) + 1.0 / (math.pi * np.asarray(r))


def layer_lattice_sums(pitch: float, thickness: float, poisson_ratio: float) -> tuple[float, float]:
    """Return the influence [1/mm] and its Laplacian [1/mm^3] of an infinite square lattice at one site.

    The influence is the sum over all sites, with the regular part of the site itself. The Laplacian is the
    sum over all other sites.
    """
    count = math.ceil(LATTICE_EXTENT * thickness / pitch)
    index = np.arange(-count, count + 1)
    square = (index[:, None] ** 2 + index**2).ravel()
    square, number = np.unique(square[(square > 0) & (square <= count**2)], return_counts=True)
    r = pitch * np.sqrt(square)
    laplacian = 1.0 / (math.pi * r**3) + layer_laplacian(r, thickness, poisson_ratio)
    total = math.fsum(number * layer_influence(r, thickness, poisson_ratio))
    return total + float(layer_regular(0.0, thickness, poisson_ratio)), math.fsum(number * laplacian)


def layer_cell(contact_radius: float, cell_radius: float, thickness: float, poisson_ratio: float) -> float:
    """Return the central displacement of a Hertzian load on a cylinder minus that on a half-space [1/mm].

    Both are displacements per unit P/E*; on a half-space it is ``3/(4 a)``. The wall of the cylinder has no
    radial displacement and no shear. The displacement is a Dini series over the zeros of J1(k b):
    ``2/(pi b^2) sum M(k t) F(k a)/(k J0(k b)^2)``, F(x) = 3 (sin x - x cos x)/x^3.
    """
    zeros = jn_zeros(1, 100_000)  # the last terms are 1e-11 of the sum
    k = zeros / cell_radius
    x = k * contact_radius
    source = 3.0 * (np.sin(x) - x * np.cos(x)) / x**3
    terms = layer_multiplier(k * thickness, poisson_ratio) * source / (k * j0(zeros) ** 2)
    return 2.0 / (math.pi * cell_radius**2) * math.fsum(terms) - 0.75 / contact_radius


def _layer_integral(r: FloatArray, thickness: float, poisson_ratio: float, power: int) -> FloatArray:
    # up to x = 50, beyond which 1 - M is below 1e-38, in 250 panels, one of which contains about a period of
    # J0 at r = 30 t
    y, w = np.polynomial.legendre.leggauss(12)
    x = (0.2 * (np.arange(250)[:, None] + 0.5 * (y + 1.0))).ravel()
    weight = np.tile(0.1 * w, 250) * (layer_multiplier(x, poisson_ratio) - 1.0) * x**power
    waves = j0(np.multiply.outer(r / thickness, x))
    return np.asarray(waves @ weight / (math.pi * thickness))


def k(x: float) -> float:
    """Return the function k(x) of equation S5 [-]."""
    return erf(sqrt(x)) - 2.0 / sqrt(pi) * sqrt(x) * exp(-x)  # eq. S5


def g(x: float) -> float:
    """Return the function g(x) of equation S4 [-]."""
    return (1.0 - exp(-x)) / k(x)  # eq. S4


def slope(scale: float, radius: float, max_height: float) -> float:
    """Return the asymptotic slope m [-] of equations S3 and S7."""
    return sqrt(pi * radius / scale) * g(max_height / scale)  # eq. S3


def smallest_slope(radius: float, max_height: float) -> float:
    """Return the slope m = ``3 pi/4 sqrt(R/h_m)`` [-] of a uniform density, the limit for large lambda."""
    return 0.75 * pi * sqrt(radius / max_height)


def slope_series(x: float) -> float:
    """Return the relative excess of m over `smallest_slope`, ``x/10 + 13 x^2/1050`` [-], for small x.

    It follows from the series of ``1 - exp(-x)`` and of k(x) in equation S4, with x = h_m/lambda. The next
    term is of order x^3.
    """
    return x / 10.0 + 13.0 * x**2 / 1050.0


def intercept(scale: float, radius: float, max_height: float, count: int) -> float:
    """Return the intercept alpha of the asymptote [mm^2]."""
    x = max_height / scale
    gamma = x * exp(-x) / (1.0 - exp(-x)) * (4.0 / (3.0 * sqrt(pi)) * sqrt(x) * g(x) - 1.0)
    return pi * count * radius * scale * gamma


def branch_factors(scale: float, max_height: float, crossover: float, weight: float) -> tuple[float, float]:
    """Return the factors alpha_1 and alpha_2 [1/mm] of equation S8."""
    second = weight / (scale * (1.0 - exp(-max_height / scale)))
    rest = 1.0 - scale * second * (exp(-crossover / scale) - exp(-max_height / scale))
    return rest / (scale * (1.0 - exp(-crossover / scale))), second


def second_slope(scale: float, radius: float, max_height: float, crossover: float, weight: float) -> float:
    """Return the asymptotic slope m_2 [-] of the second branch, first line of equation S8."""
    first, second = branch_factors(scale, max_height, crossover, weight)
    top, middle = exp(-max_height / scale), exp(-crossover / scale)
    above = first - second * top - (first - second) * middle
    below = (first - second) * k(crossover / scale) + second * k(max_height / scale)
    return sqrt(pi * radius / scale) * above / below  # eq. S8, m_2


def crossover_load(
    scale: float, radius: float, max_height: float, crossover: float, weight: float, count: int
) -> float:
    """Return the load P_c/E* [mm^2] when the plane reaches the crossover height, second line of eq. S8."""
    _, second = branch_factors(scale, max_height, crossover, weight)
    depth = max_height - crossover
    inner = 0.75 * sqrt(pi * scale) * scale**2 * exp(-crossover / scale) * erf(sqrt(depth / scale))
    outer = scale * exp(-max_height / scale) * 0.5 * sqrt(depth)
    outer *= 2.0 * crossover - 3.0 * scale - 2.0 * max_height
    return 4.0 / 3.0 * count * sqrt(radius) * second * (inner + outer)  # eq. S8, P_c/E*
