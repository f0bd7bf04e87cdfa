"""Verdicts on residuals, agreement of repeated tests, 68 % intervals and covariances."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import block_diag
from scipy.optimize.elementwise import find_root
from scipy.special import gammaincc, ndtr

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.errors import refuse_if
from metafem.notes import Note

# Probability below which a law is rejected. One in a hundred correct laws is rejected by chance.
REJECTED = 0.01

# Probability that an interval contains the mean. Half-width of the normal interval with this probability, in
# standard deviations.
PROBABILITY, WIDTH = 0.68, 0.9944578832

# Table of means: smallest mean, in standard deviations of the estimate, and number of means.
SMALLEST_MEAN, MEANS = 1e-4, 4000

# Largest asymmetry and most negative eigenvalue of a correlation matrix that rounded input may cause.
ASYMMETRY = 1e-6


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
        freedom = f"{self.freedom} degree{'s' * (self.freedom != 1)} of freedom"
        return f"chi² = {chi(self.chi_square)} with {freedom} (p = {self.probability:.2g})"

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
    """Return the verdict on normalised residuals (k,) after a fit of some parameters; nan has no weight."""
    known = residual[np.isfinite(residual)]
    return Verdict(float((known**2).sum()), max(len(known) - parameters, 0))


@dataclass(frozen=True, eq=False, repr=False)
class SingleTest(Value):
    """Fit of one of several pooled tests: two values with their covariance, nan if not determined.

    Attributes
    ----------
    name : str
        Label of the test.
    points : int
        Number of points.
    value, sd : ndarray, (2,)
        E* [MPa] and sqrt(w) [sqrt(N/mm)] of a compression test, or B [-] and sigma [MPa] of a shear test, and
        their standard deviations.
    covariance : ndarray, (2, 2)
        Covariance of the two values, without the error of the radius.

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


def scatter(tests: Sequence[SingleTest]) -> Verdict | None:
    """Return the chi-square of tests about their weighted mean; None for less than two tests.

    Examples
    --------
    >>> tests = [SingleTest(str(b), 20, np.array([b]), np.eye(1) * 1e-4) for b in (0.84, 0.86)]
    >>> str(scatter(tests))
    'chi² = 2 with 1 degree of freedom (p = 0.16)'
    """
    known = [np.isfinite(test.value) for test in tests]
    if sum(each.any() for each in known) < 2:
        return None
    pairs = list(zip(tests, known, strict=True))
    roots = [np.linalg.cholesky(test.covariance[np.ix_(own, own)]) for test, own in pairs]
    every = list(zip(roots, pairs, strict=True))
    matrix = np.concatenate([np.linalg.solve(root, np.eye(len(own))[own]) for root, (_, own) in every])
    wanted = np.concatenate([np.linalg.solve(root, test.value[own]) for root, (test, own) in every])
    mean, _, determined, _ = np.linalg.lstsq(matrix, wanted, rcond=None)
    return Verdict(float(((wanted - matrix @ mean) ** 2).sum()), len(wanted) - int(determined))


def labels_of(test: Any, count: int) -> tuple[str, ...]:
    """Return the test label of each point, "" if there are no tests."""
    if test is None:
        return ("",) * count
    wrong = isinstance(test, str) or np.ndim(test) != 1 or len(test) != count
    refuse_if(wrong, f"test = {shown(test)} must hold a label for each of the {count} points")
    return tuple(str(name) for name in test)


def bounded_interval(estimate: ArrayLike, sd: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper ends of the 68 % intervals of nonnegative means, from normal estimates.

    The estimates may be negative. For every mean, 0 included, the interval contains the mean in 68 % of
    repeated measurements; no interval is empty. Estimates are ranked by the ratio of their likelihood to that
    of the most probable nonnegative mean: Feldman and Cousins, Phys. Rev. D 57, 3873 (1998),
    doi:10.1103/PhysRevD.57.3873.

    Examples
    --------
    >>> low, high = bounded_interval([3.0, 0.3, -1.0], 1.0)
    >>> low.round(2), high.round(2)
    (array([2.01, 0.  , 0.  ]), array([3.99, 1.29, 0.27]))
    """
    mean, first, last = _accepted()
    x = np.divide(estimate, sd)
    low = np.where(x >= last[-1], x - WIDTH, np.interp(x, last, mean, left=0.0))
    high = np.where(x >= first[-1], x + WIDTH, np.interp(x, first, mean))
    return np.asarray(low * sd), np.asarray(high * sd)


def interval_of(estimate: float, variance: float) -> tuple[float, float]:
    """Return the lower and upper end of the 68 % interval of a nonnegative mean, from one estimate."""
    low, high = bounded_interval(estimate, math.sqrt(variance))
    return float(low), float(high)


@lru_cache
def _accepted() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return means up to WIDTH, and the lowest and the highest accepted estimate of each, (MEANS,).

    For a mean m, the accepted estimates lie between ``m - (m^2 + t^2)/(2 m)`` and ``m + t``. The likelihood
    ratio is equal at the two ends.
    """
    mean = np.geomspace(SMALLEST_MEAN, WIDTH, MEANS)

    def excess(t: FloatArray, m: FloatArray) -> FloatArray:
        return np.asarray(ndtr(t) - ndtr(-(m**2 + t**2) / (2.0 * m)) - PROBABILITY)

    t = find_root(excess, (np.zeros(MEANS), np.full(MEANS, 2.0)), args=(mean,)).x
    return mean, mean - (mean**2 + t**2) / (2.0 * mean), mean + t


def checked_covariance(names: Sequence[str], covariance: ArrayLike) -> FloatArray:
    """Return the covariance matrix of named parameters, (p, p), or raise InvalidInput if it is invalid."""
    matrix = check.array("covariance", covariance, shape=(len(names), len(names)))
    # check the correlation matrix, which has no units
    scale = np.sqrt(np.abs(np.diagonal(matrix)))
    scaled = matrix / np.outer(*[np.where(scale > 0.0, scale, 1.0)] * 2)
    symmetric = np.allclose(scaled, scaled.T, rtol=0.0, atol=ASYMMETRY)
    must = f"of {', '.join(names)} must be symmetric and positive semidefinite"
    wrong = not symmetric or np.linalg.eigvalsh(scaled).min() < -ASYMMETRY
    refuse_if(wrong, f"covariance = {shown(matrix.tolist())} {must}")
    return matrix


def joint_covariance(*calibrations: Any) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of all parameters of independent calibrations, and their joint covariance.

    Parameters
    ----------
    *calibrations : ContactCalibration, ShearCalibration or StrengthFit
        Calibrations without a parameter in common.

    Returns
    -------
    names : tuple of str
    covariance : ndarray, (p, p)
        Block-diagonal covariance matrix; lengths in mm, stresses in MPa, as `metafem.studies.uncertainty`
        expects.

    Raises
    ------
    InvalidInput
        If two calibrations have the same parameter.

    Examples
    --------
    >>> from metafem.calibration import fit_compression, shear
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> area = np.pi * a**2
    >>> pressed = fit_compression(1.36 * 4 / 3 * a**3 / 0.526, area, 0.526)
    >>> names, covariance = joint_covariance(pressed, shear(area, 0.85 * area, 0.3 * area))
    >>> names, np.sqrt(np.diag(covariance)).round(3)
    (('composite_modulus', 'area_ratio', 'shear_strength'), array([0.017, 0.003, 0.002]))
    """
    names = [name for each in calibrations for name in each.parameters]
    for name in names:
        twice = f"{name} is a parameter of two calibrations; pool their tests in one calibration"
        refuse_if(names.count(name) > 1, twice)
    blocks = [each.parameter_covariance for each in calibrations]
    return tuple(names), np.asarray(block_diag(*blocks)) if blocks else np.zeros((0, 0))


@dataclass(frozen=True)
class MeasurementErrors:
    """Standard deviations of measurement errors, which are independent of each other.

    The standard deviation is ``load`` for a load, ``boundary * 2 sqrt(pi A)`` (the perimeter times the error
    of the boundary) for a contact of area A, and ``friction_force + friction_relative F`` for a friction
    force F. The default values are the error bars of Aymard et al., Science 383, 200 (2024),
    doi:10.1126/science.adk4234, caption of Fig. 2.

    Parameters
    ----------
    load : float
        Standard deviation of a load [N], positive; default: 5 mN.
    boundary : float
        Standard deviation of the position of a contact's boundary [mm], positive; default: 1.4 um.
    friction_force : float
        Standard deviation of a friction force of zero [N], positive; default: 1 mN.
    friction_relative : float
        Relative part of the standard deviation of a friction force [-], not negative; default: 0.01.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> errors = MeasurementErrors()
    >>> errors.of_area(np.array([0.01, 0.04])).round(6), errors.of_friction_force(np.array([0.1])).round(6)
    (array([0.000496, 0.000993]), array([0.002]))
    """

    load: float = 5e-3
    boundary: float = 1.4e-3
    friction_force: float = 1e-3
    friction_relative: float = 0.01

    def __post_init__(self) -> None:
        for name in ("load", "boundary", "friction_force"):
            check.member(self, name, above=0.0)
        check.member(self, "friction_relative", at_least=0.0)

    def of_load(self, load: FloatArray) -> FloatArray:
        """Return the standard deviations of loads [N]."""
        return np.full(np.shape(load), self.load)

    def of_area(self, area: FloatArray) -> FloatArray:
        """Return the standard deviations of the areas of single contacts [mm^2]."""
        return 2.0 * self.boundary * np.sqrt(math.pi * np.maximum(area, 0.0))

    def of_friction_force(self, force: FloatArray) -> FloatArray:
        """Return the standard deviations of friction forces [N]."""
        return self.friction_force + self.friction_relative * np.abs(force)

    @property
    def of_open(self) -> float:
        """Standard deviation of the area of an open contact [mm^2], that of a contact as small as its error.

        A contact of twice the radius of the boundary's error cannot be told from none.
        """
        return float(self.of_area(np.array(math.pi * (2.0 * self.boundary) ** 2)))


# Default measurement errors: the error bars of Aymard et al. (2024).
PAPER = MeasurementErrors()
