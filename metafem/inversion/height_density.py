"""Piecewise exponential height densities and their friction laws.

The densities are functions of the height h above the foot of the distribution [mm]. Their integrals are
expressed by the regularised lower incomplete gamma function gamma(s, x), without cancellation. They equal
equations S2 to S8 of Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234.
`metafem.reference` contains the equations as printed.

For any contact law A(d), P(d) without adhesion, the friction law of an exponential density is straight except
near its ends. ``A0`` and ``p`` are integrals of ``exp(-h/lambda)`` times A(h - delta) and P(h - delta), and
both are proportional to ``exp(-delta/lambda)``. For a uniform density the slope at the foot is A(h_m)/P(h_m).
For a power cap rho^n, A is proportional to d^(2/n) and P to d^(1 + 1/n), and the integrals are incomplete
gamma functions. For other laws the integrals are computed by quadrature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.special import gammainc

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.law import Contacts, contacts
from metafem.errors import InvalidInput, refuse_if
from metafem.models.model import PARABOLOID

# If the scale is below this many standard deviations of the manufactured heights, their density is no longer
# exponential. This is a rule of thumb of Aymard et al., doi:10.1126/science.adk4234.
FINEST_SCALE_IN_SD = 10.0

# Smallest relative tolerance that brentq accepts.
TIGHTEST = 4.0 * np.finfo(float).eps


# The quadrature over a piece uses INTERVALS equal intervals of the fourth root of the indentation, with NODES
# nodes each. Fractional powers of the indentation are smooth functions of its fourth root. Indentations above
# DEEPEST scales are negligible.
NODES, INTERVALS, DEEPEST = 24, 4, 45.0


def slope_excess(x: ArrayLike) -> FloatArray:
    """Return m(x) / m(0) - 1 [-]: the relative excess of the slope over that of a uniform density.

    Here x = h_m / lambda, ``m = sqrt(pi R / lambda) g(x)`` (eqs. S3, S4) and ``m(0) = 3 pi/4 sqrt(R/h_m)``.
    The ratio is ``sqrt(x) (1 - e^-x) / (Gamma(5/2) gamma(3/2, x))``, where ``k(x) = gamma(3/2, x)`` (eq. S5).
    The ratio increases with x, as 1 + x/10 for small x. Below x = 1 it is the quotient of two Kummer series,
    whose difference is summed term by term.

    Examples
    --------
    >>> slope_excess([0.0, 1e-9, 3.0]).round(13)
    array([0.00000000e+00, 1.00000000e-10, 3.93611793e-01])
    """
    value = np.asarray(x, dtype=np.float64)
    large = np.maximum(value, 1.0)
    direct = np.sqrt(large) * -np.expm1(-large) / (math.gamma(2.5) * gammainc(1.5, large)) - 1.0
    small = np.minimum(value, 1.0)
    # the ratio is (e^x - 1)/x = sum x^n/(2)_n divided by M(1, 5/2, x) = sum x^n/(5/2)_n; at x = 1 the first
    # omitted term x^18/(2)_18 is below 1e-17
    first, second = np.ones_like(small), np.ones_like(small)
    total, difference = np.ones_like(small), np.zeros_like(small)
    for n in range(18):
        first = first * small / (2.0 + n)
        second = second * small / (2.5 + n)
        total = total + second
        difference = difference + (first - second)
    return np.asarray(np.where(value < 1.0, difference / total, direct))


def scale_from_slope(slope: float, radius: float, max_height: float, law: Contact = PARABOLOID) -> float:
    """Return the scale lambda [mm] of the truncated exponential density that has a slope (eqs. S3, S7).

    The slope must exceed `uniform_slope`, the slope of the uniform density.
    """
    bound = uniform_slope(radius, max_height, law)
    excess = (slope - bound) / bound
    if law.power == PARABOLOID.power:
        # as k(x) <= 1, the ratio exceeds sqrt(x) (1 - e^-x)/Gamma(5/2), and the root lies below `upper`
        upper = 2.0 * (math.gamma(2.5) * (1.0 + excess)) ** 2
        # small x is about 10 times the excess, so the absolute tolerance is proportional to the excess
        given = {"xtol": TIGHTEST * excess, "rtol": TIGHTEST}
        x = brentq(lambda x: float(slope_excess(x)) - excess, 0.0, upper, **given)
        return max_height / float(x)  # eq. S3 solved for lambda

    def missing(logarithm: float) -> float:
        density = ExponentialDensity(max_height * math.exp(-logarithm), max_height)
        return density.asymptotic_slope(radius, law) / slope - 1.0

    low, high = math.log(excess), 1.0
    while missing(low) > 0.0:
        low -= 1.0
    while missing(high) < 0.0:
        high += 1.0
    return max_height * math.exp(-brentq(missing, low, high, xtol=1e-14))


def uniform_slope(radius: float, max_height: float, law: Contact = PARABOLOID) -> float:
    """Return the slope A(h_m)/P(h_m) [-] of uniformly distributed heights.

    Exponential densities have larger slopes. With Hertz contacts the slope is ``3 pi/4 sqrt(R/h_m)``.
    """
    found = _contact(law, max_height, radius)
    return float(found.area / found.load)


def _contact(law: Contact, indentation: float, radius: float) -> Contacts:
    """Return one contact at an indentation [mm]."""
    return contacts(law, np.array(indentation), np.array(radius))


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
        whole = _exponential_mass(0.0, self.max_height, self.scale)
        upper = _exponential_mass(self.crossover_height, self.max_height, self.scale)
        return self.weight * float(upper / whole)

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Pieces of the density, from the foot upwards."""
        lam, top, mid = self.scale, self.max_height, self.crossover_height
        upper = self.weight / (lam * float(_exponential_mass(0.0, top, lam)))  # eq. S6, alpha_2
        if mid == 0.0:
            return (Piece(0.0, top, upper),)
        lower = max(0.0, 1.0 - self.upper_mass) / (lam * float(_exponential_mass(0.0, mid, lam)))  # alpha_1
        return Piece(0.0, mid, lower), Piece(mid, top, upper)

    def density(self, height: ArrayLike) -> FloatArray:
        """Return the probability density at heights [mm], in 1/mm."""
        h = np.asarray(height, dtype=np.float64)
        result = np.zeros_like(h)
        for piece in self.pieces:
            inside = (h >= piece.low) & (h <= piece.high)
            value = piece.alpha * np.exp(-np.where(inside, h, 0.0) / self.scale)
            result = np.where(inside, value, result)
        return result

    def mass(self, low: ArrayLike, high: ArrayLike) -> FloatArray:
        """Return the probability [-] of a height between `low` and `high` [mm]."""
        lo, hi = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
        total = np.zeros(np.broadcast(lo, hi).shape)
        for piece in self.pieces:
            start, end = np.clip(lo, piece.low, piece.high), np.clip(hi, piece.low, piece.high)
            total = total + piece.alpha * self.scale * _exponential_mass(start, end, self.scale)
        return total

    def moment(self, power: float, separation: ArrayLike) -> FloatArray:
        """Return the mean of ``max(h - delta, 0)^power`` [mm^power] at separations from 0 to h_m [mm].

        A piece from a to b contributes ``lambda^(q+1) alpha e^(-delta/lambda) Gamma(q+1)`` times
        ``gamma(q+1, (b - delta)/lambda) - gamma(q+1, (a - delta)/lambda)``.
        """
        delta = np.asarray(separation, dtype=np.float64)
        outside = not ((delta >= 0.0) & (delta <= self.max_height)).all()
        if outside:
            words = f"must lie within the density, from 0 to {self.max_height:g} mm"
            raise InvalidInput(words, key="separation", value=f"{separation!r:.60}")
        lam, q = self.scale, power
        total = np.zeros_like(delta)
        for piece in self.pieces:
            high = gammainc(q + 1.0, np.maximum(piece.high - delta, 0.0) / lam)
            low = gammainc(q + 1.0, np.maximum(piece.low - delta, 0.0) / lam)
            total = total + piece.alpha * (high - low)
        return np.asarray(lam ** (q + 1.0) * math.gamma(q + 1.0) * np.exp(-delta / lam) * total)

    def area(
        self, separation: ArrayLike, count: float, radius: float, law: Contact = PARABOLOID
    ) -> FloatArray:
        """Return the expected real contact area A0 [mm^2]; with Hertz contacts N pi R <d> (eq. S2)."""
        return count * self._means(separation, radius, law)[1]  # eq. S2, F/(sigma B)

    def rescaled_load(
        self, separation: ArrayLike, count: float, radius: float, law: Contact = PARABOLOID
    ) -> FloatArray:
        """Return the expected load P/E* [mm^2]; with Hertz contacts N 4/3 sqrt(R) <d^(3/2)> (eq. S2)."""
        return count * self._means(separation, radius, law)[0]  # eq. S2, P/E*

    def slope(self, separation: ArrayLike, radius: float, law: Contact = PARABOLOID) -> FloatArray:
        """Return the slope dA0/d(P/E*) [-] at separations below h_m [mm].

        With Hertz contacts it is ``pi sqrt(R)/2 <1>/<sqrt d>``, and for a power cap
        ``2/(n + 1) A(1)/P(1) <d^(2/n - 1)>/<d^(1/n)>``. For other laws integration by parts gives
        -dA0/d(delta) as the sum of A0/lambda and of A(h - delta) times the density at the ends of each piece,
        negative at its lower end.
        """
        n = law.power
        if n is None:
            delta = np.asarray(separation, dtype=np.float64)
            by_load, by_area = (mean / self.scale for mean in self._means(delta, radius, law))
            for piece in self.pieces:
                for end, sign in ((piece.high, 1.0), (piece.low, -1.0)):
                    weight = sign * piece.alpha * math.exp(-end / self.scale)
                    found = contacts(law, end - delta, np.full(delta.shape, radius))
                    by_load, by_area = by_load + weight * found.load, by_area + weight * found.area
            return np.asarray(by_area / by_load)
        unit = _contact(law, 1.0, radius)
        closed = (
            self.moment(2.0 / n - 1.0, separation) if n != 2.0 else self.mass(separation, self.max_height)
        )
        ratio = 2.0 / (n + 1.0) * unit.area / unit.load
        return np.asarray(ratio * closed / self.moment(1.0 / n, separation))

    def _means(self, separation: ArrayLike, radius: float, law: Contact) -> tuple[FloatArray, FloatArray]:
        """Return the mean load P/E* and the mean area [mm^2] of one asperity at separations [mm]."""
        n = law.power
        if n is not None:
            unit = _contact(law, 1.0, radius)
            by_load, by_area = self.moment(1.0 + 1.0 / n, separation), self.moment(2.0 / n, separation)
            return unit.load * by_load, unit.area * by_area
        node, weight = np.polynomial.legendre.leggauss(NODES)
        root = (np.arange(INTERVALS)[:, None] + 0.5 * (node + 1.0)).ravel() / INTERVALS
        weights = np.tile(0.5 * weight, INTERVALS) / INTERVALS * 4.0 * root**3
        delta = np.asarray(separation, dtype=np.float64)
        total = np.zeros((2, *delta.shape))
        for piece in self.pieces:
            low, high = (np.maximum(end - delta, 0.0) for end in (piece.low, piece.high))
            wide = np.minimum(high - low, DEEPEST * self.scale)
            depth = low[..., None] + wide[..., None] * root**4
            found = contacts(law, depth, np.full(depth.shape, radius))
            density = piece.alpha * np.exp(-(delta[..., None] + depth) / self.scale)
            for k, values in enumerate((found.load, found.area)):
                total[k] += wide * ((density * values) @ weights)
        return total[0], total[1]

    def asymptotic_slope(self, radius: float, law: Contact = PARABOLOID) -> float:
        """Return the slope [-] of the only or first branch at large loads (eqs. S3, S7).

        It is the slope of the truncated exponential density when the plane reaches the foot.
        """
        if law.power != PARABOLOID.power:
            whole = ExponentialDensity(self.scale, self.max_height)
            return float(whole.slope(0.0, radius, law))
        excess = float(slope_excess(self.max_height / self.scale))
        return uniform_slope(radius, self.max_height, law) * (1.0 + excess)  # eq. S3

    def asymptotic_slopes(self, radius: float, law: Contact = PARABOLOID) -> tuple[float, float]:
        """Return the slopes m_1 and m_2 [-] of two branches at large loads (eqs. S7, S8).

        m_2 is the slope when the plane reaches the foot.
        """
        first = self.asymptotic_slope(radius, law)  # eq. S7
        return first, float(self.slope(0.0, radius, law))  # eq. S8, m_2

    def intercept(self, count: float, radius: float, law: Contact = PARABOLOID) -> float:
        """Return the intercept [mm^2] of the asymptote of a truncated exponential density.

        With Hertz contacts it is ``pi N R lambda Gamma(x)`` with x = h_m/lambda and
        ``Gamma(x) = x e^-x/(1 - e^-x) (4/(3 sqrt(pi)) sqrt(x) g(x) - 1)``. The bracket is `slope_excess`.
        """
        if law.power != PARABOLOID.power:
            load, area = self._means(0.0, radius, law)
            return count * float(area - self.asymptotic_slope(radius, law) * load)
        x = self.max_height / self.scale
        factor = x * math.exp(-x) / -math.expm1(-x) * float(slope_excess(x))
        return count * float(_contact(law, 1.0, radius).area) * self.scale * factor

    def crossover_load(self, count: float, radius: float, law: Contact = PARABOLOID) -> float:
        """Return the load P_c/E* [mm^2] at which the plane reaches the crossover height (eq. S8)."""
        return float(self.rescaled_load(self.crossover_height, count, radius, law))  # eq. S8, P_c/E*


def equal_masses(scale: float, low: float, high: float, parts: int) -> FloatArray:
    """Return the ends of intervals between two heights with equal masses of exp(-h/lambda), (parts + 1,)."""
    # e^(-(h - low)/lambda) decreases linearly with the mass between the lower end and h
    fallen = np.arange(1, parts) / parts * -math.expm1((low - high) / scale)
    return np.concatenate([[low], low - scale * np.log1p(-fallen), [high]])


def _exponential_mass(low: ArrayLike, high: ArrayLike, scale: float) -> FloatArray:
    """Return the integral [-] of exp(-h/lambda)/lambda between two heights [mm]."""
    lo, hi = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    return np.asarray(-np.exp(-lo / scale) * np.expm1((lo - hi) / scale))
