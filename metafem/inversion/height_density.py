"""Piecewise exponential height densities, and the friction laws that follow from them.

The densities are functions of the height h above the foot of the distribution [mm]. With the regularised
lower incomplete gamma function gamma(s, x) every integral is a sum of positive terms: the same values as
equations S2 to S8 of Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, without
cancellation. `metafem.reference.height_densities` contains the equations as printed.

For any contact law A(d), P(d) without adhesion, an exponential density has a law that is straight except at
its ends: ``A0`` and ``p`` are integrals of ``exp(-h/lambda)`` times A(h - delta) and P(h - delta), and both
are proportional to ``exp(-delta/lambda)``. For a uniform density the slope is A(h_m)/P(h_m). For a power cap
rho^n, A grows as d^(2/n) and P as d^(1 + 1/n), and the integrals are incomplete gamma functions; for other
laws they are computed by quadrature.
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
from metafem.errors import refuse_if
from metafem.models.model import PARABOLOID

# With a scale below this many standard deviations of the manufactured heights, the density is no longer
# exponential: rule of thumb of Aymard et al., doi:10.1126/science.adk4234.
FINEST_SCALE_IN_SD = 10.0

# The tightest relative tolerance that brentq accepts.
TIGHTEST = 4.0 * np.finfo(float).eps


# Number of quadrature nodes per interval of a piece, and of intervals of the fourth root of the indentation,
# in which fractional powers are smooth. Indentations beyond the last number of scales are negligible.
NODES, INTERVALS, DEEPEST = 24, 4, 45.0


def slope_excess(x: ArrayLike) -> FloatArray:
    """Return m(x) / m(0) - 1: the slope at x = h_m / lambda over that of a uniform density, minus 1.

    ``m = sqrt(pi R / lambda) g(x)`` (eqs. S3, S4) and ``m(0) = 3 pi/4 sqrt(R/h_m)``, so the ratio is
    ``sqrt(x) (1 - e^-x) / (Gamma(5/2) gamma(3/2, x))``, where ``k(x) = gamma(3/2, x)`` (eq. S5). It grows
    with x, at first as 1 + x/10. Below x = 1 both factors are Kummer series, and their difference is summed
    term by term.

    Examples
    --------
    >>> slope_excess([0.0, 1e-9, 3.0]).round(13)
    array([0.00000000e+00, 1.00000000e-10, 3.93611793e-01])
    """
    value = np.asarray(x, dtype=np.float64)
    large = np.maximum(value, 1.0)
    direct = np.sqrt(large) * -np.expm1(-large) / (math.gamma(2.5) * gammainc(1.5, large)) - 1.0
    small = np.minimum(value, 1.0)
    # (e^x - 1)/x = sum x^n/(2)_n over M(1, 5/2, x) = sum x^n/(5/2)_n; x^18/(2)_18 < 1e-17 at x = 1
    first, second = np.ones_like(small), np.ones_like(small)
    total, difference = np.ones_like(small), np.zeros_like(small)
    for n in range(18):
        first = first * small / (2.0 + n)
        second = second * small / (2.5 + n)
        total = total + second
        difference = difference + (first - second)
    return np.asarray(np.where(value < 1.0, difference / total, direct))


def scale_from_slope(slope: float, radius: float, max_height: float, law: Contact = PARABOLOID) -> float:
    """Return the scale lambda [mm] at which the truncated exponential has this slope (eqs. S3, S7).

    The slope must exceed `uniform_slope`, the bound of the uniform density.
    """
    bound = uniform_slope(radius, max_height, law)
    excess = (slope - bound) / bound
    if law.power == PARABOLOID.power:
        # k(x) <= 1 makes the ratio exceed sqrt(x) (1 - e^-x)/Gamma(5/2): the root lies below `upper`.
        upper = 2.0 * (math.gamma(2.5) * (1.0 + excess)) ** 2
        # the excess is nearly x/10, so x tends to 10 excess
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
    """Return the smallest slope A(h_m)/P(h_m) [-], that of uniformly distributed heights.

    For Hertz contacts it is ``3 pi/4 sqrt(R/h_m)``.
    """
    found = _contact(law, max_height, radius)
    return float(found.area / found.load)


def _contact(law: Contact, indentation: float, radius: float) -> Contacts:
    """Return one contact at an indentation [mm]."""
    return contacts(law, np.array(indentation), np.array(radius))


@dataclass(frozen=True)
class Piece:
    """``alpha exp(-h/lambda)`` between two heights [mm]; alpha in 1/mm."""

    low: float
    high: float
    alpha: float


@dataclass(frozen=True)
class ExponentialDensity:
    """Exponential density of heights up to a maximum, with another weight below a crossover height.

    ``alpha_2 exp(-h/lambda)`` on [h_c, h_m] and ``alpha_1 exp(-h/lambda)`` on [0, h_c], with
    ``alpha_2 = u / (lambda (1 - exp(-h_m/lambda)))`` and alpha_1 from the unit mass (eq. S6). Without a
    crossover height it is the truncated exponential.

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
        """The branches from the foot upwards."""
        lam, top, mid = self.scale, self.max_height, self.crossover_height
        upper = self.weight / (lam * float(_exponential_mass(0.0, top, lam)))  # eq. S6, alpha_2
        if mid == 0.0:
            return (Piece(0.0, top, upper),)
        lower = max(0.0, 1.0 - self.upper_mass) / (lam * float(_exponential_mass(0.0, mid, lam)))  # alpha_1
        return Piece(0.0, mid, lower), Piece(mid, top, upper)

    def density(self, height: ArrayLike) -> FloatArray:
        """Probability density of the height [1/mm]."""
        h = np.asarray(height, dtype=np.float64)
        result = np.zeros_like(h)
        for piece in self.pieces:
            inside = (h >= piece.low) & (h <= piece.high)
            value = piece.alpha * np.exp(-np.where(inside, h, 0.0) / self.scale)
            result = np.where(inside, value, result)
        return result

    def mass(self, low: ArrayLike, high: ArrayLike) -> FloatArray:
        """Probability of a height between low and high [mm]."""
        lo, hi = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
        total = np.zeros(np.broadcast(lo, hi).shape)
        for piece in self.pieces:
            start, end = np.clip(lo, piece.low, piece.high), np.clip(hi, piece.low, piece.high)
            total = total + piece.alpha * self.scale * _exponential_mass(start, end, self.scale)
        return total

    def moment(self, power: float, separation: ArrayLike) -> FloatArray:
        """Mean of ``max(h - delta, 0)^power`` [mm^power] at separations from 0 to h_m [mm].

        A piece from a to b contributes ``lambda^(q+1) alpha e^(-delta/lambda) Gamma(q+1)`` times
        ``gamma(q+1, (b - delta)/lambda) - gamma(q+1, (a - delta)/lambda)``.
        """
        delta = np.asarray(separation, dtype=np.float64)
        outside = not ((delta >= 0.0) & (delta <= self.max_height)).all()
        words = f"must lie within the density, from 0 to {self.max_height:g} mm"
        refuse_if(outside, words, key="separation", value=f"{separation!r:.60}")
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
        """Expected real contact area A0 [mm^2]; with Hertz contacts N pi R <d> (eq. S2)."""
        return count * self._means(separation, radius, law)[1]  # eq. S2, F/(sigma B)

    def rescaled_load(
        self, separation: ArrayLike, count: float, radius: float, law: Contact = PARABOLOID
    ) -> FloatArray:
        """Expected load P/E* [mm^2]; with Hertz contacts N 4/3 sqrt(R) <d^(3/2)> (eq. S2)."""
        return count * self._means(separation, radius, law)[0]  # eq. S2, P/E*

    def slope(self, separation: ArrayLike, radius: float, law: Contact = PARABOLOID) -> FloatArray:
        """Slope dA0/d(P/E*) [-] at separations below h_m [mm]; with Hertz contacts pi sqrt(R)/2 <1>/<sqrt d>.

        For a power cap it is ``2/(n + 1) A(1)/P(1) <d^(2/n - 1)>/<d^(1/n)>``. For other laws -dA0/d(delta) is
        integrated by parts: A0/lambda, and A(h - delta) times the density at the ends of each piece.
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
        """Mean load and area [mm^2] of an asperity at separations [mm]."""
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
        """Slope of the only or first branch for large loads [-] (eqs. S3, S7).

        It is that of the truncated exponential where the plane reaches the foot.
        """
        if law.power != PARABOLOID.power:
            whole = ExponentialDensity(self.scale, self.max_height)
            return float(whole.slope(0.0, radius, law))
        excess = float(slope_excess(self.max_height / self.scale))
        return uniform_slope(radius, self.max_height, law) * (1.0 + excess)  # eq. S3

    def asymptotic_slopes(self, radius: float, law: Contact = PARABOLOID) -> tuple[float, float]:
        """Slopes m_1 and m_2 of two branches for large loads [-] (eqs. S7, S8).

        m_2 is the slope where the plane reaches the foot.
        """
        first = self.asymptotic_slope(radius, law)  # eq. S7
        return first, float(self.slope(0.0, radius, law))  # eq. S8, m_2

    def intercept(self, count: float, radius: float, law: Contact = PARABOLOID) -> float:
        """Intercept of the asymptote of a truncated exponential [mm^2].

        With Hertz contacts it is ``pi N R lambda Gamma(x)`` with x = h_m/lambda and
        ``Gamma(x) = x e^-x/(1 - e^-x) (4/(3 sqrt(pi)) sqrt(x) g(x) - 1)``, whose bracket is `slope_excess`.
        """
        if law.power != PARABOLOID.power:
            load, area = self._means(0.0, radius, law)
            return count * float(area - self.asymptotic_slope(radius, law) * load)
        x = self.max_height / self.scale
        factor = x * math.exp(-x) / -math.expm1(-x) * float(slope_excess(x))
        return count * float(_contact(law, 1.0, radius).area) * self.scale * factor

    def crossover_load(self, count: float, radius: float, law: Contact = PARABOLOID) -> float:
        """Load P_c/E* [mm^2] at which the plane reaches the crossover height (eq. S8)."""
        return float(self.rescaled_load(self.crossover_height, count, radius, law))  # eq. S8, P_c/E*


def equal_masses(scale: float, low: float, high: float, parts: int) -> FloatArray:
    """Ends of `parts` intervals of equal mass of exp(-h/lambda) between two heights, (parts + 1,)."""
    # measured from the lower end, e^(-(h - low)/lambda) decreases linearly with the mass
    fallen = np.arange(1, parts) / parts * -math.expm1((low - high) / scale)
    return np.concatenate([[low], low - scale * np.log1p(-fallen), [high]])


def _exponential_mass(low: ArrayLike, high: ArrayLike, scale: float) -> FloatArray:
    """Integral of exp(-h/lambda)/lambda between two heights."""
    lo, hi = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    return np.asarray(-np.exp(-lo / scale) * np.expm1((lo - hi) / scale))
