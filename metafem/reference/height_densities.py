"""Equations S3 to S8 as printed by Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234.

For small arguments the equations lose digits by cancellation; `metafem.inversion.height_density` evaluates
them without cancellation. Lengths are in mm.
"""

from __future__ import annotations

from math import erf, exp, pi, sqrt


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
