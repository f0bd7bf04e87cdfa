"""Whether a law fits measured points, and whether tests that were fitted one by one agree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.serial_correlation import Succession
from metafem.notes import Note

# Probability below which a law is rejected: one in a hundred correct laws.
REJECTED = 0.01

# Smallest probability that is printed: smaller ones of normal errors have no meaning.
LEAST = 1e-9

# Residual over its standard deviation below which it is rounding and has no sign.
ROUNDING = 1e-6


@dataclass(frozen=True)
class Verdict:
    """Whether residuals, divided by their standard deviations, are those of the law.

    Attributes
    ----------
    chi_square : float
        Sum of the squares of the normalised residuals [-].
    freedom : int
        Number of points minus number of fitted parameters.
    probability : float
        Probability that a correct law has a chi-square at least as large [-].
    runs : int
        Number of runs of residuals of one sign, in the order of the points.
    runs_probability : float
        Probability that independent residuals have at most as many runs [-].
    correlation, correlation_probability : float
        Correlation of successive residuals in the order measured, and the probability that independent errors
        have one at least as large [-]; 0 and 1 where the order is not known.
    largest, largest_probability : float
        Largest residual over its own standard deviation, and the probability that normal errors have one as
        large [-]; 0 and 1 where it is not tested.
    outlier : int
        Row of the point with the largest residual; 0 where it is not tested.
    fits : bool
        Whether all probabilities are at least 1 %.

    Examples
    --------
    >>> verdict = judged(np.array([0.5, -1.0, 0.8, -0.2, 1.1, -0.9]), parameters=1)
    >>> verdict.fits, verdict.runs, str(verdict)
    (True, 6, 'the law fits: chi² = 3.95 with 5 degrees of freedom (p = 0.56), 6 runs of residuals (p = 1)')
    """

    chi_square: float
    freedom: int
    probability: float
    runs: int
    runs_probability: float
    correlation: float = 0.0
    correlation_probability: float = 1.0
    largest: float = 0.0
    largest_probability: float = 1.0
    outlier: int = 0

    @property
    def fits(self) -> bool:
        """Whether no test rejects the law with independent normal errors."""
        return self.law_fits and min(self.correlation_probability, self.largest_probability) >= REJECTED

    @property
    def law_fits(self) -> bool:
        """Whether chi-square and runs do not reject the law."""
        return min(self.probability, self.runs_probability) >= REJECTED

    @property
    def one_outlier(self) -> bool:
        """Whether one point is an outlier, without which chi-square does not reject the law."""
        without = _chi_probability(max(self.chi_square - self.largest**2, 0.0), self.freedom - 1)
        return self.largest_probability < REJECTED <= without

    def __str__(self) -> str:
        degrees = f"{self.freedom} degree{'s' * (self.freedom != 1)} of freedom"
        runs = f"{self.runs} run{'s' * (self.runs != 1)} of residuals"
        found = (
            f"the law {'fits' if self.law_fits else 'does not fit'}: chi² = {chi(self.chi_square)} with "
            f"{degrees} (p {chance(self.probability)}), {runs} (p {chance(self.runs_probability)})"
        )
        also = []
        if self.correlation_probability < REJECTED:
            also.append(
                f"successive residuals are correlated by {self.correlation:.2g} "
                f"(p {chance(self.correlation_probability)})"
            )
        if self.largest_probability < REJECTED:
            also.append(
                f"the largest residual is {self.largest:.2g} standard deviations "
                f"(p {chance(self.largest_probability)})"
            )
        return found + (f", {'but' if self.law_fits else 'and'} {' and '.join(also)}" if also else "")


def chi(square: float) -> str:
    """Return a chi-square for texts: of four digits from a thousand on, without a power of ten.

    Examples
    --------
    >>> chi(3.954), chi(317_512.0)
    ('3.95', '317,500')
    """
    return f"{square:.3g}" if square < 999.5 else f"{float(f'{square:.4g}'):,.0f}"


def chance(probability: float, digits: int = 2) -> str:
    """Return a probability for texts, with its sign of relation.

    Examples
    --------
    >>> chance(0.564), chance(6e-239)
    ('= 0.56', '< 1e-9')
    """
    return f"= {probability:.{digits}g}" if probability >= LEAST else "< 1e-9"


def judged(residual: FloatArray, parameters: int) -> Verdict:
    """Return the verdict on normalised residuals (k,), in the order of load, after a fit of parameters."""
    square, freedom = float((residual**2).sum()), max(len(residual) - parameters, 0)
    probability = _chi_probability(square, freedom)
    signs = residual[residual != 0.0] > 0.0
    runs = int(np.count_nonzero(signs[1:] != signs[:-1])) + 1 if signs.size else 0
    return Verdict(square, freedom, probability, runs, _runs_probability(int(signs.sum()), signs.size, runs))


def judged_in_order(residual: FloatArray, load: FloatArray, measured: Succession) -> Verdict:
    """Return the verdict on residuals (k,) as measured: runs over load, and correlation in time.

    The largest of k normal residuals is tested at their common level: each has the variance 1 less its
    leverage.
    """
    from scipy.special import ndtr

    clear = np.where(np.abs(residual) > ROUNDING, residual, 0.0)
    verdict = judged(clear[np.argsort(load, kind="stable")], measured.regressor.shape[1])
    correlation, probability = measured.lag_one(clear)
    size = np.abs(clear) / np.sqrt(np.maximum(1.0 - measured.leverage, ROUNDING))
    largest = float(size.max())
    by_chance = float(-np.expm1(len(clear) * np.log1p(-2.0 * ndtr(-largest)))) if largest else 1.0
    return replace(
        verdict,
        correlation=correlation,
        correlation_probability=probability,
        largest=largest,
        largest_probability=by_chance,
        outlier=int(size.argmax()),
    )


def errors_of(verdict: Verdict, measured: Succession, what: str) -> tuple[float, tuple[Note, ...]]:
    """Return the correlation rho of successive errors, 0 unless it is noticed, with a note on it."""
    if verdict.correlation_probability >= REJECTED:
        return 0.0, ()
    rho = measured.of_errors(verdict.correlation)
    alone = np.diagonal(measured.covariance(0.0))
    factor = float(np.sqrt(np.diagonal(measured.covariance(rho)) / alone).max())
    return rho, (
        Note(
            f"{what}: successive residuals of a test are correlated by {verdict.correlation:.2g} (p "
            f"{chance(verdict.correlation_probability, 1)}): the errors drift, or the law does not fit. "
            f"Errors with a correlation of {rho:.2g} make standard deviations {factor:.2g} times as large "
            "as independent ones; those stated include this factor. Measure the loads in random order, and "
            "more tests"
        ),
    )


def _chi_probability(square: float, freedom: int) -> float:
    """Return the probability that a correct law has a chi-square at least as large."""
    from scipy.special import gammaincc

    return float(gammaincc(0.5 * freedom, 0.5 * square)) if freedom > 0 else 1.0


def _runs_probability(positive: int, count: int, runs: int) -> float:
    """Return the probability of at most `runs` runs of `positive` plus and the other minus signs.

    Wald and Wolfowitz, Ann. Math. Statist. 11, 147 (1940), doi:10.1214/aoms/1177731909: 2 j runs have the
    weight ``2 C(p-1, j-1) C(m-1, j-1)``, and 2 j + 1 runs
    ``C(p-1, j) C(m-1, j-1) + C(p-1, j-1) C(m-1, j)``.
    """
    negative = count - positive
    if min(positive, negative) == 0:
        return 1.0 if count < 2 else 2.0 ** (1 - count)  # one run of signs that were equally likely
    weight = 0
    for number in range(2, runs + 1):
        j, odd = divmod(number, 2)
        if odd:
            weight += math.comb(positive - 1, j) * math.comb(negative - 1, j - 1)
            weight += math.comb(positive - 1, j - 1) * math.comb(negative - 1, j)
        else:
            weight += 2 * math.comb(positive - 1, j - 1) * math.comb(negative - 1, j - 1)
    return weight / math.comb(count, positive)


@dataclass(frozen=True)
class Heterogeneity:
    """Comparison of the parameters of several tests with their weighted mean.

    Attributes
    ----------
    chi_square : float
        Sum over the tests of ``(p - m)^T C^-1 (p - m)`` with the parameters p, their covariance C and the
        weighted mean m [-].
    freedom : int
        Number of fitted parameters of all tests minus that of the mean.
    probability : float
        Probability that tests with the same parameters have a chi-square at least as large [-].
    agree : bool
        Whether the probability is at least 1 %.
    birge_ratio : float
        Root of chi-square over freedom [-].

    Examples
    --------
    >>> found = heterogeneity([np.array([0.84]), np.array([0.86])], [np.eye(1) * 1e-4] * 2)
    >>> found.agree, str(found)
    (True, 'the tests agree: chi² = 2 with 1 degree of freedom (p = 0.16)')
    """

    chi_square: float
    freedom: int
    probability: float

    @property
    def agree(self) -> bool:
        """Whether the tests are compatible with common parameters."""
        return self.probability >= REJECTED

    @property
    def birge_ratio(self) -> float:
        """Root of chi-square over freedom, by which the differences exceed the stated uncertainties.

        Birge, Phys. Rev. 40, 207 (1932), doi:10.1103/PhysRev.40.207.
        """
        return math.sqrt(self.chi_square / self.freedom) if self.freedom else 1.0

    def __str__(self) -> str:
        return (
            f"the tests {'agree' if self.agree else 'differ'}: chi² = {chi(self.chi_square)} with "
            f"{self.freedom} degree{'s' * (self.freedom != 1)} of freedom (p = {self.probability:.2g})"
        )

    def note(self) -> Note:
        """Return what the stated uncertainties leave out if the tests differ."""
        return Note(
            f"{self}; the stated uncertainties do not include what makes them differ: "
            f"{self.birge_ratio:.2g} times as large ones would (Birge ratio)"
        )


def heterogeneity(parameters: Sequence[FloatArray], covariance: Sequence[FloatArray]) -> Heterogeneity:
    """Compare parameters (p,) of several tests; nan where a test does not determine one."""
    from scipy.special import gammaincc

    count = len(parameters[0])
    information, weighted = np.zeros((count, count)), np.zeros(count)
    parts = []
    for values, matrix in zip(parameters, covariance, strict=True):
        known = np.isfinite(values)
        inverse = np.linalg.inv(matrix[np.ix_(known, known)])
        information[np.ix_(known, known)] += inverse
        weighted[known] += inverse @ values[known]
        parts.append((known, inverse))
    determined = np.diagonal(information) > 0.0
    mean = np.zeros(count)
    mean[determined] = np.linalg.solve(information[np.ix_(determined, determined)], weighted[determined])
    square, number = 0.0, -int(determined.sum())
    for values, (known, inverse) in zip(parameters, parts, strict=True):
        apart = values[known] - mean[known]
        square += float(apart @ inverse @ apart)
        number += int(known.sum())
    probability = float(gammaincc(0.5 * number, 0.5 * square)) if number else 1.0
    return Heterogeneity(square, number, probability)
