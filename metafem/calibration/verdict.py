"""Tests of whether a law fits measured points, and whether separately fitted tests agree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import gammaincc

from metafem._given import shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.errors import refuse_if
from metafem.notes import Note

# Probability below which a law is rejected. One in a hundred correct laws is rejected by chance.
REJECTED = 0.01

# Smallest printed probability. Smaller probabilities are meaningless, since real errors are not exactly
# normal.
LEAST = 1e-9


@dataclass(frozen=True)
class Verdict:
    """Chi-square test of normalised residuals.

    Attributes
    ----------
    chi_square : float
        Sum of the squares of the residuals over their standard deviations [-].
    freedom : int
        Number of points minus number of fitted parameters.
    probability : float
        Probability of a chi-square at least as large for a correct law with independent normal errors [-].
    fits : bool
        Whether the probability is at least 1 %.
    birge_ratio : float
        Square root of chi-square over freedom [-]: the ratio of the observed to the expected deviations.
        Birge, Phys. Rev. 40, 207 (1932), doi:10.1103/PhysRev.40.207.

    Examples
    --------
    >>> verdict = judged(np.array([0.5, -1.0, 0.8, -0.2, 1.1, -0.9]), parameters=1)
    >>> verdict.fits, str(verdict)
    (True, 'chi² = 3.95 with 5 degrees of freedom (p = 0.56)')
    """

    chi_square: float
    freedom: int

    @property
    def probability(self) -> float:
        """Probability of a chi-square at least as large for a correct law."""
        return float(gammaincc(0.5 * self.freedom, 0.5 * self.chi_square)) if self.freedom > 0 else 1.0

    @property
    def fits(self) -> bool:
        """Whether the test does not reject the law."""
        return self.probability >= REJECTED

    @property
    def birge_ratio(self) -> float:
        """Square root of chi-square over freedom [-]."""
        return math.sqrt(self.chi_square / self.freedom) if self.freedom else 1.0

    def __str__(self) -> str:
        probability = f"= {self.probability:.2g}" if self.probability >= LEAST else "< 1e-9"
        return (
            f"chi² = {chi(self.chi_square)} with {self.freedom} degree{'s' * (self.freedom != 1)} of freedom "
            f"(p {probability})"
        )

    def note(self, what: str) -> Note:
        """Return a note that something does not fit or agree, such as "the law does not fit"."""
        return Note(
            f"{what}: {self}; the stated uncertainties do not include this; uncertainties "
            f"{self.birge_ratio:.2g} times as large would (Birge ratio)"
        )


def chi(square: float) -> str:
    """Return a chi-square value as text without a power of ten.

    Examples
    --------
    >>> chi(3.954), chi(317_512.0)
    ('3.95', '317,500')
    """
    return f"{square:.3g}" if square < 999.5 else f"{float(f'{square:.4g}'):,.0f}"


def judged(residual: FloatArray, parameters: int) -> Verdict:
    """Return the verdict on normalised residuals (k,) after a fit of some parameters."""
    return Verdict(float((residual**2).sum()), max(len(residual) - parameters, 0))


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

    @property
    def sd(self) -> FloatArray:
        """Standard deviations of the values."""
        return np.sqrt(np.diagonal(self.covariance))


def heterogeneity(tests: Sequence[SingleTest]) -> Verdict:
    """Return the comparison of several tests with their weighted mean.

    Chi-square is the sum of ``(p - m)^T C^-1 (p - m)`` over the tests, with the parameters p of a test, their
    covariance C and the weighted mean m. Values that a test does not determine are nan.

    Examples
    --------
    >>> tests = [SingleTest(str(b), 20, np.array([b]), np.eye(1) * 1e-4) for b in (0.84, 0.86)]
    >>> str(heterogeneity(tests))
    'chi² = 2 with 1 degree of freedom (p = 0.16)'
    """
    rows, values = [], []
    for test in tests:
        known = np.isfinite(test.value)
        root = np.linalg.cholesky(test.covariance[np.ix_(known, known)])
        rows.append(np.linalg.solve(root, np.eye(len(known))[known]))
        values.append(np.linalg.solve(root, test.value[known]))
    # the weighted mean is the least-squares solution of the whitened values
    matrix, wanted = np.concatenate(rows), np.concatenate(values)
    mean, _, determined, _ = np.linalg.lstsq(matrix, wanted, rcond=None)
    return Verdict(float(((wanted - matrix @ mean) ** 2).sum()), len(wanted) - int(determined))


def labels_of(test: Any, count: int) -> tuple[str, ...]:
    """Return the test label of each point, "" if there are no tests."""
    if test is None:
        return ("",) * count
    wrong = isinstance(test, str) or np.ndim(test) != 1 or len(test) != count
    refuse_if(wrong, f"test = {shown(test)} must hold a label for each of the {count} points")
    return tuple(str(name) for name in test)
