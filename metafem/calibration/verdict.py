"""Tests of whether a law fits measured points, and whether separately fitted tests agree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaincc, ndtr

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.serial_correlation import Succession
from metafem.notes import Note

# Probability below which a law is rejected. One in a hundred correct laws is rejected by chance.
REJECTED = 0.01

# Smallest printed probability. Smaller probabilities are meaningless, since real errors are not exactly
# normal.
LEAST = 1e-9

# Normalised residuals below this bound are rounding errors, whose signs are not counted.
ROUNDING = 1e-6


@dataclass(frozen=True)
class SignificanceTest:
    """Result of a statistical test of residuals.

    Attributes
    ----------
    name : str
        ``chi_square``, ``runs``, ``correlation`` or ``largest``.
    statistic : float
        For ``chi_square``, the sum of the squares of the normalised residuals. For ``runs``, the number of
        runs of residuals with equal sign, in the order of the points. For ``correlation``, the correlation of
        successive residuals in the order of measurement. For ``largest``, the largest residual over its own
        standard deviation. All [-].
    probability : float
        Probability of a statistic at least as extreme if the law is correct and the errors are independent
        and normal [-].
    noticed : bool
        Whether the probability is below 1 %.

    Examples
    --------
    >>> SignificanceTest("largest", 5.0, 1e-5).noticed
    True
    """

    name: str
    statistic: float
    probability: float

    @property
    def noticed(self) -> bool:
        """Whether the test rejects the hypothesis of a correct law with independent normal errors."""
        return self.probability < REJECTED


@dataclass(frozen=True)
class Verdict:
    """Tests of whether normalised residuals are consistent with the law.

    Attributes
    ----------
    freedom : int
        Number of points minus number of fitted parameters.
    tests : tuple of SignificanceTest
        ``chi_square`` and ``runs`` test the law. ``correlation`` and ``largest`` test the errors, if the
        order of measurement is known. ``verdict["runs"]`` returns one test.
    outlier : int
        Row of the point with the largest residual; 0 if the largest residual is not tested.

    Examples
    --------
    >>> verdict = judged(np.array([0.5, -1.0, 0.8, -0.2, 1.1, -0.9]), parameters=1)
    >>> verdict.fits, verdict["runs"].statistic, str(verdict)
    (True, 6, 'the law fits: chi² = 3.95 with 5 degrees of freedom (p = 0.56), 6 runs of residuals (p = 1)')
    """

    freedom: int
    tests: tuple[SignificanceTest, ...]
    outlier: int = 0

    def __getitem__(self, name: str) -> SignificanceTest:
        return next(test for test in self.tests if test.name == name)

    @property
    def fits(self) -> bool:
        """Whether no test rejects the hypothesis of a correct law with independent normal errors."""
        return not any(test.noticed for test in self.tests)

    @property
    def law_fits(self) -> bool:
        """Whether neither the chi-square nor the runs test rejects the law."""
        return not any(test.noticed for test in self.tests[:2])

    @property
    def one_outlier(self) -> bool:
        """Whether one point is an outlier, and chi-square does not reject the law without this point."""
        largest = self["largest"]
        square = max(self["chi_square"].statistic - largest.statistic**2, 0.0)
        return largest.noticed and _chi_probability(square, self.freedom - 1) >= REJECTED

    def __str__(self) -> str:
        square, runs = self["chi_square"], self["runs"]
        found = (
            f"the law {'fits' if self.law_fits else 'does not fit'}: chi² = {chi(square.statistic)} with "
            f"{self.freedom} degree{'s' * (self.freedom != 1)} of freedom (p {chance(square.probability)}), "
            f"{runs.statistic} run{'s' * (runs.statistic != 1)} of residuals (p {chance(runs.probability)})"
        )
        words = {
            "correlation": "successive residuals are correlated by {:.2g} (p {})",
            "largest": "the largest residual is {:.2g} standard deviations (p {})",
        }
        also = [
            words[test.name].format(test.statistic, chance(test.probability))
            for test in self.tests[2:]
            if test.noticed
        ]
        return found + (f", {'but' if self.law_fits else 'and'} {' and '.join(also)}" if also else "")


def chi(square: float) -> str:
    """Return a chi-square value as text without a power of ten.

    Examples
    --------
    >>> chi(3.954), chi(317_512.0)
    ('3.95', '317,500')
    """
    return f"{square:.3g}" if square < 999.5 else f"{float(f'{square:.4g}'):,.0f}"


def chance(probability: float, digits: int = 2) -> str:
    """Return a probability as text that begins with "=" or "<".

    Examples
    --------
    >>> chance(0.564), chance(6e-239)
    ('= 0.56', '< 1e-9')
    """
    return f"= {probability:.{digits}g}" if probability >= LEAST else "< 1e-9"


def judged(residual: FloatArray, parameters: int) -> Verdict:
    """Return the verdict on normalised residuals (k,), sorted by load, after a fit of some parameters."""
    square, freedom = float((residual**2).sum()), max(len(residual) - parameters, 0)
    signs = residual[residual != 0.0] > 0.0
    runs = int(np.count_nonzero(signs[1:] != signs[:-1])) + 1 if signs.size else 0
    tests = (
        SignificanceTest("chi_square", square, _chi_probability(square, freedom)),
        SignificanceTest("runs", runs, _runs_probability(int(signs.sum()), signs.size, runs)),
    )
    return Verdict(freedom, tests)


def judged_in_order(residual: FloatArray, load: FloatArray, measured: Succession) -> Verdict:
    """Return the verdict on residuals (k,) in the order of measurement.

    The runs are counted over the load, the correlation over the order of measurement. The variance of a
    normalised residual is 1 minus its leverage. The probability for the largest residual accounts for the
    number k of residuals.
    """
    clear = np.where(np.abs(residual) > ROUNDING, residual, 0.0)
    verdict = judged(clear[np.argsort(load, kind="stable")], measured.regressor.shape[1])
    size = np.abs(clear) / np.sqrt(np.maximum(1.0 - measured.leverage, ROUNDING))
    largest = float(size.max())
    by_chance = float(-np.expm1(len(clear) * np.log1p(-2.0 * ndtr(-largest)))) if largest else 1.0
    of_errors = (
        SignificanceTest("correlation", *measured.lag_one(clear)),
        SignificanceTest("largest", largest, by_chance),
    )
    return replace(verdict, tests=(*verdict.tests, *of_errors), outlier=int(size.argmax()))


def errors_of(verdict: Verdict, measured: Succession, what: str) -> tuple[float, tuple[Note, ...]]:
    """Return the correlation rho of successive errors and a note; 0 and no note if it is not significant."""
    correlation = verdict["correlation"]
    if not correlation.noticed:
        return 0.0, ()
    rho = measured.of_errors(correlation.statistic)
    independent = np.diagonal(measured.covariance(0.0))
    factor = float(np.sqrt(np.diagonal(measured.covariance(rho)) / independent).max())
    return rho, (
        Note(
            f"{what}: successive residuals of a test are correlated by {correlation.statistic:.2g} (p "
            f"{chance(correlation.probability, 1)}): the errors drift, or the law does not fit. "
            f"Errors with a correlation of {rho:.2g} make standard deviations {factor:.2g} times as large "
            "as independent ones; those stated include this factor. Measure the loads in random order, and "
            "repeat the test"
        ),
    )


def _chi_probability(square: float, freedom: int) -> float:
    """Return the probability that a correct law has a chi-square of at least `square`."""
    return float(gammaincc(0.5 * freedom, 0.5 * square)) if freedom > 0 else 1.0


def _runs_probability(positive: int, count: int, runs: int) -> float:
    """Return the probability of at most `runs` runs of equal signs if `positive` of `count` signs are plus.

    Wald and Wolfowitz, Ann. Math. Statist. 11, 147 (1940), doi:10.1214/aoms/1177731909. For p plus signs in i
    runs and m minus signs in j runs, the number of sequences is ``C(p-1, i-1) C(m-1, j-1)``. i and j differ
    by at most 1. For i = j the number counts twice, since either sign may come first.
    """
    negative = count - positive
    if min(positive, negative) == 0:
        return 1.0 if count < 2 else 2.0 ** (1 - count)  # all `count` signs are equal
    weight = sum(
        math.comb(positive - 1, of_plus - 1) * math.comb(negative - 1, number - of_plus - 1)
        for number in range(2, runs + 1)
        for of_plus in (number // 2, (number + 1) // 2)
    )
    return weight / math.comb(count, positive)


@dataclass(frozen=True, eq=False, repr=False)
class SingleTest(Value):
    """Fit of one of several pooled tests.

    Attributes
    ----------
    name : str
        Label of the test.
    points : int
        Number of points.
    value : ndarray, (2,)
        E* [MPa] and sqrt(w) [sqrt(N/mm)] of a compression test, or B [-] and sigma [MPa] of a shear test; nan
        for a parameter that the points do not determine.
    covariance : ndarray, (2, 2)
        Covariance of the two values, without the error of the radius.
    verdict : Verdict or None
        Whether the law fits this test; None for a shear test.
    sd : ndarray, (2,)
        Standard deviations of the values.

    Examples
    --------
    >>> SingleTest("1", 20, np.array([0.85, 0.37]), np.diag([4e-6, 1e-6])).sd
    array([0.002, 0.001])
    """

    name: str
    points: int
    value: FloatArray
    covariance: FloatArray
    verdict: Verdict | None = None

    @property
    def sd(self) -> FloatArray:
        """Standard deviations of the values."""
        return np.sqrt(np.diagonal(self.covariance))


@dataclass(frozen=True)
class Heterogeneity:
    """Test of whether several tests have the same parameters, by comparison with their weighted mean.

    Attributes
    ----------
    chi_square : float
        Sum of ``(p - m)^T C^-1 (p - m)`` over the tests [-]; p are the parameters of a test, C is their
        covariance and m the weighted mean.
    freedom : int
        Number of fitted parameters of all tests minus the number of parameters of the mean.
    probability : float
        Probability of a chi-square at least as large if all tests have the same parameters [-].
    agree : bool
        Whether the probability is at least 1 %.
    birge_ratio : float
        Square root of chi-square over freedom [-].

    Examples
    --------
    >>> tests = [SingleTest(str(b), 20, np.array([b]), np.eye(1) * 1e-4) for b in (0.84, 0.86)]
    >>> found = heterogeneity(tests)
    >>> found.agree, str(found)
    (True, 'the tests agree: chi² = 2 with 1 degree of freedom (p = 0.16)')
    """

    chi_square: float
    freedom: int
    probability: float

    @property
    def agree(self) -> bool:
        """Whether the tests are consistent with common parameters."""
        return self.probability >= REJECTED

    @property
    def birge_ratio(self) -> float:
        """Square root of chi-square over freedom [-]: the ratio of the observed to the expected differences.

        Birge, Phys. Rev. 40, 207 (1932), doi:10.1103/PhysRev.40.207.
        """
        return math.sqrt(self.chi_square / self.freedom) if self.freedom else 1.0

    def __str__(self) -> str:
        return (
            f"the tests {'agree' if self.agree else 'differ'}: chi² = {chi(self.chi_square)} with "
            f"{self.freedom} degree{'s' * (self.freedom != 1)} of freedom (p = {self.probability:.2g})"
        )

    def note(self) -> Note:
        """Return a note that the tests differ."""
        return Note(
            f"{self}; the stated uncertainties do not include this difference; uncertainties "
            f"{self.birge_ratio:.2g} times as large would (Birge ratio)"
        )


def heterogeneity(tests: Sequence[SingleTest]) -> Heterogeneity:
    """Return the comparison of several tests; values that a test does not determine are nan."""
    rows, values = [], []
    for test in tests:
        known = np.isfinite(test.value)
        root = np.linalg.cholesky(test.covariance[np.ix_(known, known)])
        rows.append(np.linalg.solve(root, np.eye(len(known))[known]))
        values.append(np.linalg.solve(root, test.value[known]))
    # the weighted mean is the least-squares solution of the whitened values
    matrix, wanted = np.concatenate(rows), np.concatenate(values)
    mean, _, determined, _ = np.linalg.lstsq(matrix, wanted, rcond=None)
    square, freedom = float(((wanted - matrix @ mean) ** 2).sum()), len(wanted) - int(determined)
    return Heterogeneity(square, freedom, _chi_probability(square, freedom))
