"""Height densities by quadrature, and equations S7 and S8 by a general solver of equations."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq, fsolve


def moment(scale: float, power: float, low: float, high: float) -> float:
    """Integral of ``exp(-h/scale) (h - low)^power`` from low to high, by quadrature."""
    return _between(scale, power, low, low, high)


def load_at_foot(scale: float, top: float, count: int, radius: float) -> float:
    """Load P/E* [mm²] at which the plane reaches height 0 of a truncated exponential density, eq. S2."""
    mass = moment(scale, 0.0, 0.0, top)
    return float(4.0 / 3.0 * count * np.sqrt(radius) * moment(scale, 1.5, 0.0, top) / mass)


def slope_at_foot(parts: list[tuple[float, float, float]], scale: float, radius: float) -> float:
    """Slope dA0/dP [-] with the plane at height 0 of parts (factor, low, high) of an exponential density.

    It is ``(pi sqrt(R)/2) <1>/<sqrt(h)>``, the quotient of the derivatives of eq. S2 to the separation.
    """

    def integral(power: float) -> float:
        return sum(factor * _between(scale, power, 0.0, low, high) for factor, low, high in parts)

    return float(0.5 * np.pi * np.sqrt(radius) * integral(0.0) / integral(0.5))


def scale_of_slope(slope: float, top: float, radius: float) -> float:
    """Scale λ [mm] of a truncated exponential density of a slope, eq. S7."""
    return float(
        brentq(
            lambda scale: slope_at_foot([(1.0, 0.0, top)], scale, radius) / slope - 1.0,
            1e-2 * top, 10.0 * top, xtol=1e-14,
        )
    )  # fmt: skip


def two_branches(
    slopes: tuple[float, float], crossover_load: float, top: float, count: int, radius: float
) -> tuple[float, float, float]:
    """Scale [mm], weight u [-] and crossover height [mm] of two slopes and a crossover load, S7 and S8."""
    scale = scale_of_slope(slopes[0], top, radius)
    whole = moment(scale, 0.0, 0.0, top)

    def residual(unknown: np.ndarray) -> tuple[float, float]:
        weight, height = map(float, unknown)
        second = weight / whole
        above = moment(scale, 0.0, height, top)
        first = (1.0 - second * above) / moment(scale, 0.0, 0.0, height)
        slope = slope_at_foot([(first, 0.0, height), (second, height, top)], scale, radius)
        load = 4.0 / 3.0 * count * np.sqrt(radius) * second * moment(scale, 1.5, height, top)
        return slope / slopes[1] - 1.0, load / crossover_load - 1.0

    weight, height = fsolve(residual, (0.2, 0.1 * top), xtol=1e-12)
    return scale, float(weight), float(height)


def share_above(scale: float, weight: float, height: float, top: float) -> float:
    """Share of the mass of a density of two branches that lies above the crossover height."""
    return weight * moment(scale, 0.0, height, top) / moment(scale, 0.0, 0.0, top)


def mean_power(
    scale: float, power: float, separation: float, top: float, crossover: float = 0.0, weight: float = 1.0
) -> float:
    """Mean of ``(h - separation)^power`` over the asperities in contact, for the density of eq. S6.

    The weight applies above the crossover height; with a weight of 1 the density has one branch.
    """
    second = weight / moment(scale, 0.0, 0.0, top)
    found = second * _between(scale, power, separation, max(crossover, separation), top)
    if separation < crossover:
        first = 1.0 - second * moment(scale, 0.0, crossover, top)
        first /= moment(scale, 0.0, 0.0, crossover)
        found += first * _between(scale, power, separation, separation, crossover)
    return found


def interval_middles(scale: float, low: float, high: float, shares: np.ndarray) -> np.ndarray:
    """Middles (n,) [mm] of consecutive intervals from low on that hold shares of the mass on [low, high].

    The density is exponential; an end beyond the mass, by rounding, is high.
    """
    mass = np.exp(-low / scale) - np.exp(-high / scale)
    left = np.exp(-low / scale) - mass * np.append(0.0, np.cumsum(shares))
    end = -scale * np.log(np.maximum(left, np.exp(-high / scale)))
    return np.asarray(0.5 * (end[:-1] + end[1:]))


def expected_counts(scale: float, top: float, step: float, count: int) -> np.ndarray:
    """Expected numbers (levels,) of asperities on intervals of a height step of a truncated exponential."""
    ends = np.minimum(step * np.arange(int(np.ceil(top / step)) + 1), top)
    masses = [moment(scale, 0.0, a, b) for a, b in pairwise(ends)]
    return count * np.array(masses) / moment(scale, 0.0, 0.0, top)


def _between(scale: float, power: float, separation: float, low: float, high: float) -> float:
    """Integral of ``exp(-h/scale) (h - separation)^power`` from low to high, in t² = h - separation."""

    def integrand(t: float) -> float:
        return 2.0 * t ** (2.0 * power + 1.0) * float(np.exp(-(separation + t * t) / scale))

    ends = np.sqrt(low - separation), np.sqrt(high - separation)
    return float(quad(integrand, *ends, epsrel=1e-12, epsabs=0.0)[0])
