"""Exponential densities of heights, whose laws are straight at large loads (eqs. S2 to S8).

All formulas are those of Hertz contacts of one radius, ``A = pi R d`` and ``P/E* = 4/3 sqrt(R) d^(3/2)``.
Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.special import gammainc, hyp1f1

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput, refuse_if

# Finest scale of a density over the standard deviation of the heights: below it their density is no longer
# exponential. This is a rule of thumb of Aymard et al., doi:10.1126/science.adk4234.
FINEST_SCALE_IN_SD = 10.0

# Smallest relative tolerance that brentq accepts.
TIGHTEST = 4.0 * np.finfo(float).eps


@dataclass(frozen=True)
class Piece:
    """Density ``alpha exp(-h/lambda)`` between the heights `low` and `high` [mm]; alpha in 1/mm."""

    low: float
    high: float
    alpha: float


@dataclass(frozen=True)
class ExponentialDensity:
    """Exponential density of heights up to a maximum, with a different factor below a crossover height.

    The density is ``alpha_2 exp(-h/lambda)`` on [h_c, h_m] and ``alpha_1 exp(-h/lambda)`` on [0, h_c]. Here
    ``alpha_2 = u / (lambda (1 - exp(-h_m/lambda)))``, and alpha_1 makes the total mass 1 (eq. S6). Without a
    crossover height it is the truncated exponential density.

    Examples
    --------
    >>> density = ExponentialDensity(0.040, 0.120)
    >>> round(density.asymptotic_slope(0.526), 3), round(density.intercept(64, 0.526), 4)
    (6.875, 0.2617)
    >>> round(float(ExponentialDensity(0.0357, 0.120, 0.0153, 0.149).mass(0.0, 0.120)), 12)
    1.0
    """

    scale: float  # lambda [mm], positive
    max_height: float  # h_m [mm], positive
    crossover_height: float = 0.0  # h_c [mm], below h_m
    weight: float = 1.0  # u [-], positive, and so small that the mass of the upper branch is at most 1

    def __post_init__(self) -> None:
        check.number("scale", self.scale, above=0.0)
        top = check.number("max_height", self.max_height, above=0.0)
        middle = check.number("crossover_height", self.crossover_height, at_least=0.0)
        check.number("weight", self.weight, above=0.0)
        refuse_if(middle >= top, f"crossover_height = {middle:g} must be below max_height = {top:g}")
        refuse_if(
            self.upper_mass > 1.0 + 1e-12,  # allows for rounding of a weight at its limit
            f"weight = {self.weight:g} puts {self.upper_mass:.4g} of the asperities above the crossover "
            "height; it must be small enough for at most 1",
        )

    @property
    def upper_mass(self) -> float:
        """Fraction of the asperities above the crossover height."""
        whole = _mass(0.0, self.max_height, self.scale)
        return self.weight * float(_mass(self.crossover_height, self.max_height, self.scale) / whole)

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Pieces of the density, from the foot upwards."""
        lam, top, mid = self.scale, self.max_height, self.crossover_height
        upper = self.weight / (lam * float(_mass(0.0, top, lam)))  # eq. S6, alpha_2
        if mid == 0.0:
            return (Piece(0.0, top, upper),)
        lower = max(0.0, 1.0 - self.upper_mass) / (lam * float(_mass(0.0, mid, lam)))  # alpha_1
        return Piece(0.0, mid, lower), Piece(mid, top, upper)

    def mass(self, low: ArrayLike, high: ArrayLike) -> FloatArray:
        """Return the probability [-] of a height between `low` and `high` [mm]."""
        lo, hi = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
        total = np.zeros(np.broadcast(lo, hi).shape)
        for piece in self.pieces:
            start, end = np.clip(lo, piece.low, piece.high), np.clip(hi, piece.low, piece.high)
            total = total + piece.alpha * self.scale * _mass(start, end, self.scale)
        return total

    def moment(self, power: float, separation: ArrayLike) -> FloatArray:
        """Return the mean of ``max(h - delta, 0)^power`` [mm^power] at separations from 0 to h_m [mm].

        A piece from a to b contributes ``lambda^(q+1) alpha e^(-delta/lambda) Gamma(q+1)`` times
        ``gamma(q+1, (b - delta)/lambda) - gamma(q+1, (a - delta)/lambda)``.
        """
        delta = np.asarray(separation, dtype=np.float64)
        if not ((delta >= 0.0) & (delta <= self.max_height)).all():
            words = f"must lie within the density, from 0 to {self.max_height:g} mm"
            raise InvalidInput(words, key="separation", value=f"{separation!r:.60}")
        lam, q = self.scale, power
        total = np.zeros_like(delta)
        for piece in self.pieces:
            high = gammainc(q + 1.0, np.maximum(piece.high - delta, 0.0) / lam)
            low = gammainc(q + 1.0, np.maximum(piece.low - delta, 0.0) / lam)
            total = total + piece.alpha * (high - low)
        return np.asarray(lam ** (q + 1.0) * math.gamma(q + 1.0) * np.exp(-delta / lam) * total)

    def area(self, separation: ArrayLike, count: float, radius: float) -> FloatArray:
        """Return the expected real contact area A0 = N pi R <d> [mm^2] (eq. S2, F/(sigma B))."""
        return count * math.pi * radius * self.moment(1.0, separation)

    def rescaled_load(self, separation: ArrayLike, count: float, radius: float) -> FloatArray:
        """Return the expected load P/E* = N 4/3 sqrt(R) <d^(3/2)> [mm^2] (eq. S2)."""
        return count * 4.0 / 3.0 * math.sqrt(radius) * self.moment(1.5, separation)

    def slope(self, separation: ArrayLike, radius: float) -> FloatArray:
        """Return the slope dA0/d(P/E*) = pi sqrt(R)/2 <1>/<sqrt d> [-] at separations below h_m [mm]."""
        share = self.mass(separation, self.max_height)
        return np.asarray(0.5 * math.pi * math.sqrt(radius) * share / self.moment(0.5, separation))

    def asymptotic_slope(self, radius: float) -> float:
        """Return the slope [-] of the only or first branch at large loads (eqs. S3, S7).

        It is the slope of the truncated exponential density when the plane reaches the foot.
        """
        excess = float(slope_excess(self.max_height / self.scale))
        return uniform_slope(radius, self.max_height) * (1.0 + excess)

    def asymptotic_slopes(self, radius: float) -> tuple[float, float]:
        """Return the slopes m_1 and m_2 [-] of two branches at large loads (eqs. S7, S8).

        m_2 is the slope when the plane reaches the foot.
        """
        return self.asymptotic_slope(radius), float(self.slope(0.0, radius))

    def intercept(self, count: float, radius: float) -> float:
        """Return the intercept [mm^2] of the asymptote of a truncated exponential density.

        It is ``pi N R lambda Gamma(x)`` with x = h_m/lambda and
        ``Gamma(x) = x e^-x/(1 - e^-x) (4/(3 sqrt(pi)) sqrt(x) g(x) - 1)``. The bracket is `slope_excess`.
        """
        x = self.max_height / self.scale
        factor = x * math.exp(-x) / -math.expm1(-x) * float(slope_excess(x))
        return count * math.pi * radius * self.scale * factor

    def crossover_load(self, count: float, radius: float) -> float:
        """Return the load P_c/E* [mm^2] at which the plane reaches the crossover height (eq. S8)."""
        return float(self.rescaled_load(self.crossover_height, count, radius))


def slope_excess(x: ArrayLike) -> FloatArray:
    """Return m(x) / m(0) - 1 [-]: the relative excess of the slope over that of a uniform density.

    Here x = h_m / lambda, ``m = sqrt(pi R / lambda) g(x)`` (eqs. S3, S4) and ``m(0) = 3 pi/4 sqrt(R/h_m)``.
    The ratio is ``sqrt(x) (1 - e^-x) / (Gamma(5/2) gamma(3/2, x))``, where ``k(x) = gamma(3/2, x)`` (eq. S5).
    It increases with x, as 1 + x/10 for small x, and is a quotient of Kummer's functions, M(1, 2, x) over
    M(1, 5/2, x).

    Examples
    --------
    >>> slope_excess([0.0, 1e-9, 3.0]).round(13)
    array([0.00000000e+00, 1.00000000e-10, 3.93611793e-01])
    """
    value = np.asarray(x, dtype=np.float64)
    large = np.maximum(value, 1.0)
    direct = np.sqrt(large) * -np.expm1(-large) / (math.gamma(2.5) * gammainc(1.5, large)) - 1.0
    small = np.minimum(value, 1.0)
    # M(1, b, x) - 1 = x/b M(1, b + 1, x), which keeps the digits of the difference
    first, second = (small / b * hyp1f1(1.0, b + 1.0, small) for b in (2.0, 2.5))
    return np.asarray(np.where(value < 1.0, (first - second) / (1.0 + second), direct))


def scale_from_slope(slope: float, radius: float, max_height: float) -> float:
    """Return the scale lambda [mm] of the truncated exponential density that has a slope (eqs. S3, S7).

    The slope must exceed `uniform_slope`, the slope of the uniform density.
    """
    bound = uniform_slope(radius, max_height)
    excess = (slope - bound) / bound
    # as k(x) <= 1, the ratio exceeds sqrt(x) (1 - e^-x)/Gamma(5/2), and the root lies below `upper`
    upper = 2.0 * (math.gamma(2.5) * (1.0 + excess)) ** 2
    # small x is about 10 times the excess, so the absolute tolerance is proportional to the excess
    given = {"xtol": TIGHTEST * excess, "rtol": TIGHTEST}
    x = brentq(lambda x: float(slope_excess(x)) - excess, 0.0, upper, **given)
    return max_height / float(x)  # eq. S3 solved for lambda


def uniform_slope(radius: float, max_height: float) -> float:
    """Return the slope ``3 pi/4 sqrt(R/h_m)`` [-] of uniformly distributed heights, the least of all."""
    return 0.75 * math.pi * math.sqrt(radius / max_height)


def middles(density: ExponentialDensity, low: float, high: float, count: int) -> FloatArray:
    """Return the middles of intervals of equal mass between two heights, tallest first, (count,) [mm]."""
    lam = density.scale
    # e^(-(h - low)/lambda) decreases linearly with the mass between the lower end and h
    fallen = np.arange(1, count) / count * -math.expm1((low - high) / lam)
    ends = np.concatenate([[low], low - lam * np.log1p(-fallen), [high]])
    return np.asarray(0.5 * (ends[1:] + ends[:-1])[::-1])


def level_counts(density: ExponentialDensity, count: int, step: float) -> tuple[FloatArray, IntArray]:
    """Return levels at the middles of height steps, (l,) [mm], and the numbers of asperities on them, (l,).

    The numbers are the expected numbers rounded to integers. Until their sum is `count`, single numbers are
    changed by 1. Each change is made where the relative difference from the expected number is then smallest.
    The highest level includes the mass up to the maximum height.
    """
    number = max(1, math.floor(density.max_height / step + 0.5))
    levels = np.asarray(step * (np.arange(number) + 0.5), dtype=np.float64)
    ends = np.append(step * np.arange(len(levels)), density.max_height)
    expected = count * density.mass(ends[:-1], ends[1:])
    counts = np.rint(expected).astype(np.int64)
    while (missing := count - int(counts.sum())) != 0:
        changed = counts + (1 if missing > 0 else -1)
        error = np.full(len(counts), np.inf)
        np.divide(np.abs(changed - expected), expected, out=error, where=(changed >= 0) & (expected > 0.0))
        best = int(error.argmin())
        counts[best] = changed[best]
    return levels, counts


@dataclass(frozen=True)
class Crossing:
    """Densities with the first slope of `plain` up to a crossover load [mm^2] (eq. S8).

    The densities differ in the depth of the crossover height below the top [mm]. P_c is proportional to the
    weight u, so the crossover load determines u for each depth. The second slope then determines the depth.
    """

    plain: ExponentialDensity
    load: float
    count: int
    radius: float

    @property
    def full_load(self) -> float:
        """Load [mm^2] at which the plane reaches the foot of the density `plain`."""
        return self._load_of(self.plain.max_height)

    @property
    def possible(self) -> bool:
        """Whether `plain` reaches the crossover load, and double precision resolves its load there."""
        return self.load < self.full_load and self._load_of(self._least_depth) > 0.0

    @property
    def _least_depth(self) -> float:
        """Depth [mm] at which equal asperities of the maximum height carry the crossover load."""
        return float((0.75 * self.load / self.count / math.sqrt(self.radius)) ** (2.0 / 3.0))

    @property
    def depths(self) -> tuple[float, float]:
        """Smallest and largest depth [mm] for which each branch has at least half an asperity."""
        shallow, deep = self._least_depth, self.plain.max_height * (1.0 - 1e-6)
        ends = []
        for share in (1.0 - 0.5 / self.count, 0.5 / self.count):
            if self._upper_mass(deep) >= share:
                ends.append(deep)
            elif self._upper_mass(shallow) <= share:
                ends.append(shallow)
            else:  # the upper mass decreases from the smallest depth on
                ends.append(self._root(self._upper_mass, share, shallow, deep))
        return ends[0], ends[1]

    @property
    def second_slopes(self) -> tuple[float, float]:
        """Smallest and largest slope [-] of the second branch; none is possible if they do not increase."""
        low, high = (self.second_slope(depth) for depth in self.depths)
        return low, high

    def density(self, depth: float) -> ExponentialDensity:
        """Return the density with the crossover height at a depth [mm] below the top."""
        top = self.plain.max_height
        return ExponentialDensity(self.plain.scale, top, top - depth, self._weight(depth))

    def density_of(self, second: float) -> ExponentialDensity:
        """Return the density with a second slope, by solving eq. S8 for h_c."""
        return self.density(self._root(self.second_slope, second, *self.depths))

    def second_slope(self, depth: float) -> float:
        """Return the slope of the second branch [-] (eq. S8, m_2)."""
        return self.density(depth).asymptotic_slopes(self.radius)[1]

    def _root(self, function: Callable[[float], float], value: float, low: float, high: float) -> float:
        """Return the depth [mm] between `low` and `high` at which a function of the depth has a value."""
        xtol = TIGHTEST * self.plain.max_height
        return float(brentq(lambda depth: function(depth) - value, low, high, xtol=xtol, rtol=TIGHTEST))

    def _load_of(self, depth: float) -> float:
        return float(self.plain.rescaled_load(self.plain.max_height - depth, self.count, self.radius))

    def _weight(self, depth: float) -> float:
        return self.load / self._load_of(depth)  # eq. S8, P_c/E*

    def _upper_mass(self, depth: float) -> float:
        top = self.plain.max_height
        return self._weight(depth) * float(self.plain.mass(top - depth, top))


def _mass(low: ArrayLike, high: ArrayLike, scale: float) -> FloatArray:
    """Return the integral [-] of exp(-h/lambda)/lambda between two heights [mm]."""
    lo, hi = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    return np.asarray(-np.exp(-lo / scale) * np.expm1((lo - hi) / scale))
