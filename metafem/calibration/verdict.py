"""Whether a law fits measured points: chi-square of the residuals, and their runs of one sign."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray

# Probability below which a law is rejected: one in a hundred correct laws.
REJECTED = 0.01


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
    fits : bool
        Whether both probabilities are at least 1 %.

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

    @property
    def fits(self) -> bool:
        """Whether neither test rejects the law."""
        return min(self.probability, self.runs_probability) >= REJECTED

    def __str__(self) -> str:
        degrees = f"{self.freedom} degree{'s' * (self.freedom != 1)} of freedom"
        runs = f"{self.runs} run{'s' * (self.runs != 1)} of residuals"
        return (
            f"the law {'fits' if self.fits else 'does not fit'}: chi² = {chi(self.chi_square)} with "
            f"{degrees} (p = {self.probability:.2g}), {runs} (p = {self.runs_probability:.2g})"
        )


def chi(square: float) -> str:
    """Return a chi-square for texts: of four digits from a thousand on, without a power of ten.

    Examples
    --------
    >>> chi(3.954), chi(317_512.0)
    ('3.95', '317,500')
    """
    return f"{square:.3g}" if square < 999.5 else f"{float(f'{square:.4g}'):,.0f}"


def judged(residual: FloatArray, parameters: int) -> Verdict:
    """Return the verdict on normalised residuals (k,), in the order of load, after a fit of parameters."""
    from scipy.special import gammaincc

    square, freedom = float((residual**2).sum()), max(len(residual) - parameters, 0)
    probability = float(gammaincc(0.5 * freedom, 0.5 * square)) if freedom else 1.0
    signs = residual[residual != 0.0] > 0.0
    runs = int(np.count_nonzero(signs[1:] != signs[:-1])) + 1 if signs.size else 0
    return Verdict(square, freedom, probability, runs, _runs_probability(int(signs.sum()), signs.size, runs))


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
