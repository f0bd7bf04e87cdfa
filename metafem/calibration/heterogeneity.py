"""Whether tests that were fitted one by one agree with each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.verdict import REJECTED, chi
from metafem.notes import Note


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
