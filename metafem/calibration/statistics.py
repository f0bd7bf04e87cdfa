"""Fits with errors of all quantities; results of calibrations, with their verdicts and 68 % intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag
from scipy.optimize.elementwise import find_root
from scipy.special import gammaincc, ndtr

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.contact import JKR, Contact, Hertz
from metafem.errors import InvalidInput, NotConverged, refuse_if, shown
from metafem.material import Friction, Material
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

# SHARES are the lengths of the steps. The iteration ends when the change of the parameters, over their
# standard deviations, is below ENOUGH. A full step reduces the change by a factor of about 100; smaller steps
# are needed if the errors of the abscissae are as large as the abscissae.
SHARES, ENOUGH = (1.0,) * 15 + (0.5,) * 45 + (0.2,) * 140, 1e-9

# Returns the quantities at parameters (..., q) and abscissae (..., k): values (..., k, c), and their
# derivatives with respect to the parameters (..., k, c, q) and the abscissae (..., k, c).
Model = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray, FloatArray]]

# Units of the quantities that calibrations determine.
UNITS = {
    "radius": "mm",
    "composite_modulus": "MPa",
    "adhesion_energy": "N/mm",
    "area_ratio": "1",
    "shear_strength": "MPa",
}


@dataclass(frozen=True)
class Verdict:
    """Chi-square test of normalised residuals.

    Attributes
    ----------
    chi_square : float
        Sum of the squares of the residuals over their standard deviations [-].
    freedom : int
        Number of measured values minus number of fitted ones.
    probability : float
        Probability of a chi-square at least as large for a correct law with independent normal errors [-].
    fits : bool
        Whether the probability is at least 1 %.
    birge_ratio : float
        Square root of chi-square over freedom [-]: the ratio of the observed to the expected deviations.
        Birge, Phys. Rev. 40, 207 (1932), doi:10.1103/PhysRev.40.207.

    Examples
    --------
    >>> verdict = Verdict(chi_square=3.954, freedom=5)
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
        """Whether the probability is at least 1 %."""
        return self.probability >= REJECTED

    @property
    def birge_ratio(self) -> float:
        """Ratio of the observed to the expected deviations."""
        return math.sqrt(self.chi_square / self.freedom) if self.freedom > 0 else 0.0

    def __str__(self) -> str:
        freedom = f"{self.freedom} degree{'s' * (self.freedom != 1)} of freedom"
        return f"chi² = {self.chi_square:.3g} with {freedom} (p = {self.probability:.2g})"

    def to_dict(self) -> dict[str, Any]:
        """Return the attributes by name."""
        names = ("fits", "chi_square", "freedom", "probability", "birge_ratio")
        return {name: getattr(self, name) for name in names}


class Estimate(NamedTuple):
    """Value of a parameter, its standard deviation and its 68 % interval."""

    value: float
    sd: float
    interval: tuple[float, float]


def positive(value: float, variance: float) -> Estimate:
    """Return the estimate of a parameter that cannot be negative."""
    sd = math.sqrt(variance)
    low, high = bounded_interval(value, sd)
    return Estimate(value, sd, (float(low), float(high)))


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Calibration(Value):
    """Result of a calibration: the parameters of a law that was fitted to tests.

    Intervals contain the true value in 68 % of repeated calibrations.

    Attributes
    ----------
    estimates : mapping of str to Estimate
        ``value``, standard deviation ``sd`` and 68 % ``interval``: of compression tests E*,
        ``composite_modulus`` [MPa], and w, ``adhesion_energy`` [N/mm], whose interval is asymmetric and may
        begin at 0, and R, ``radius`` [mm], if it has an error; of shear tests B, ``area_ratio`` [-], and
        sigma, ``shear_strength`` [MPa]. E* belongs to `contact_law`.
    parameters, covariance : tuple of str, and ndarray, (p, p)
        Names and covariance of the parameters for `metafem.studies.uncertainty`; `joint_covariance` joins
        those of compression and shear tests.
    verdict : Verdict
        Whether the law fits the points.
    material, contact_law : Material and Contact, or None
        Of compression tests: material and law for a model, that of Johnson, Kendall and Roberts if the
        interval of w does not begin at 0, and otherwise that of the cap without adhesion.
    friction : Friction or None
        Of shear tests: B, or 1 if errors make it larger, and sigma.
    heterogeneity : Verdict or None
        Whether the tests agree: by how much the chi-square of the common fit exceeds the sum of those of the
        tests. None for a single test, and if a test has no fit.
    notes : tuple of Note

    Examples
    --------
    >>> from metafem.calibration import shear
    >>> before = np.array([0.1, 0.2, 0.3])
    >>> found = shear(before, 0.85 * before, 0.3145 * before)
    >>> round(found.estimates["area_ratio"].value, 6), round(found.friction.shear_strength, 6)
    (0.85, 0.37)
    """

    estimates: Mapping[str, Estimate]
    parameters: tuple[str, ...]
    covariance: FloatArray
    verdict: Verdict
    heterogeneity: Verdict | None = None
    notes: tuple[Note, ...] = ()

    @property
    def material(self) -> Material | None:
        """Material with the E* of compression tests."""
        found = self.estimates.get("composite_modulus")
        return found and Material(found.value)

    @property
    def contact_law(self) -> Contact | None:
        """Contact law of compression tests."""
        found = self.estimates.get("adhesion_energy")
        return found and (JKR(found.value) if found.interval[0] else Hertz())

    @property
    def friction(self) -> Friction | None:
        """Friction of shear tests."""
        found = self.estimates.get("shear_strength")
        return found and Friction(found.value, min(self.estimates["area_ratio"].value, 1.0))

    def __repr__(self) -> str:
        stated = [
            f"{name} = {value:.4g} ± {sd:.2g} {UNITS[name]}".removesuffix(" 1")
            for name, (value, sd, _) in self.estimates.items()
        ]
        return f"<Calibration: {', '.join(stated)}, {'fits' if self.verdict.fits else 'does not fit'}>"

    def to_dict(self) -> dict[str, Any]:
        """Return the result as numbers and texts, for JSON; the names of numbers end with their units.

        Examples
        --------
        >>> from metafem.calibration import shear
        >>> before = np.array([0.1, 0.2, 0.3])
        >>> found = shear(before, 0.85 * before, 0.3145 * before).to_dict()
        >>> round(found["shear_strength_MPa"], 6), found["verdict"]["fits"]
        (0.37, True)
        """
        found: dict[str, Any] = {}
        for name, (value, sd, ends) in self.estimates.items():
            unit = "" if UNITS[name] == "1" else "_" + UNITS[name].replace("/", "_per_")
            found |= {f"{name}{unit}": value, f"{name}_sd{unit}": sd, f"{name}_interval{unit}": list(ends)}
        found["verdict"] = self.verdict.to_dict()
        if self.heterogeneity is not None:
            found["heterogeneity"] = self.heterogeneity.to_dict()
        return found

    def of_tests(self, test: Any, count: int, fit: Callable[[Any], Calibration]) -> Calibration:
        """Return the result with the comparison of tests; `test` holds the label of each of `count` points.

        `fit` takes the numbers of the points of a test. Notes tell what does not fit or agree.
        """
        wrong = test is not None and (isinstance(test, str) or np.shape(test) != (count,))
        refuse_if(wrong, f"test = {shown(test)} must hold a label for each of the {count} points")
        labels = np.array([str(name) for name in (count * [""] if test is None else test)])
        names, heterogeneity = tuple(dict.fromkeys(labels.tolist())), None
        notes = list(self.notes)
        if len(names) > 1:
            try:
                alone = [fit(np.flatnonzero(labels == name)).verdict for name in names]
                square = self.verdict.chi_square - sum(each.chi_square for each in alone)
                freedom = self.verdict.freedom - sum(each.freedom for each in alone)
                heterogeneity = Verdict(max(square, 0.0), freedom)
            except (InvalidInput, NotConverged) as error:
                notes.append(Note(f"the tests are not compared, as one has no fit of its own: {error}"))
        notes += [
            Note(
                f"{what}: {verdict}; the stated uncertainties do not include this; uncertainties "
                f"{verdict.birge_ratio:.2g} times as large would (Birge ratio)"
            )
            for what, verdict in (
                (f"{' and '.join(self.estimates)}: the law does not fit", self.verdict),
                ("the tests differ", heterogeneity),
            )
            if verdict is not None and not verdict.fits
        ]
        return replace(self, heterogeneity=heterogeneity, notes=tuple(notes))


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


def checked_covariance(
    names: Sequence[str], covariance: ArrayLike | None, known: Sequence[str]
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of parameters and their covariance (p, p), or raise InvalidInput.

    The names must be different names of `known`.
    """
    names = tuple(names)
    unknown = set(names) - set(known) or len(set(names)) < len(names)
    refuse_if(unknown, f"parameters = {shown(names)} must be different names of {', '.join(known)}")
    if not names:
        return (), np.zeros((0, 0))
    matrix = check.array("covariance", covariance, shape=(len(names), len(names)))
    # check the correlation matrix, which has no units
    scale = np.sqrt(np.abs(np.diagonal(matrix)))
    scaled = matrix / np.outer(*[np.where(scale > 0.0, scale, 1.0)] * 2)
    symmetric = np.allclose(scaled, scaled.T, rtol=0.0, atol=ASYMMETRY)
    wrong = not symmetric or np.linalg.eigvalsh(scaled).min(initial=0.0) < -ASYMMETRY
    must = f"of {', '.join(names)} must be symmetric and positive semidefinite"
    refuse_if(wrong, f"covariance = {shown(matrix.tolist())} {must}")
    return names, matrix


def joint_covariance(*calibrations: Calibration) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of all parameters of independent calibrations, and their joint covariance.

    Parameters
    ----------
    *calibrations : Calibration
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
    blocks = [each.covariance for each in calibrations]
    return tuple(names), np.asarray(block_diag(*blocks)) if blocks else np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class Fit:
    """Fits of parameters to one or many sets of points.

    Attributes
    ----------
    parameter : ndarray, (..., q)
    covariance : ndarray, (..., q, q)
        Inverse of half the curvature of chi-square, minimised over the abscissae.
    abscissa : ndarray, (..., k)
        Fitted abscissae.
    chi_square : ndarray, (..., k)
        Chi-square of each point.
    converged : ndarray of bool, (...,)
    """

    parameter: FloatArray
    covariance: FloatArray
    abscissa: FloatArray
    chi_square: FloatArray
    converged: NDArray[np.bool_]


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # some of many fits may not exist
def errors_in_variables(
    model: Model,
    measured: FloatArray,
    deviation: Callable[[FloatArray], FloatArray],
    parameter: FloatArray,
    abscissa: FloatArray,
    least: FloatArray,
) -> Fit:
    """Return the least-squares fit of a model to measured quantities (..., k, c), nan where not measured.

    The sum over all measured quantities of ``((y - f(p, x)) / s)^2`` is minimised over the parameters p and
    the abscissae x of all points. `deviation` returns the standard deviations s at the values of the model.
    If they were computed from measured values, values that are too small by chance would have too much weight
    and bias the parameters. `parameter` and `abscissa` are initial guesses, and the abscissae stay above
    `least`. A Gauss-Newton step solves for the parameters after the abscissa of each point is eliminated; it
    solves many fits at once. York, Earth Planet. Sci. Lett. 5, 320 (1968),
    doi:10.1016/S0012-821X(68)80059-7.
    """
    known = np.isfinite(measured)
    y = np.where(known, measured, 0.0)
    p, x = parameter, abscissa
    for step, share in enumerate(SHARES):
        value, by_p, by_x = model(p, x)
        weight = known / deviation(value) ** 2
        off = y - value
        along = weight * by_x
        normal, right_x = (along * by_x).sum(axis=-1), (along * off).sum(axis=-1)
        mixed = (along[..., None] * by_p).sum(axis=-2)
        curvature = np.einsum("...kcq,...kcr->...qr", by_p, weight[..., None] * by_p)
        curvature = curvature - np.swapaxes(mixed / normal[..., None], -1, -2) @ mixed
        right = np.einsum("...kcq,...kc->...q", by_p, weight * off)
        right = right - np.einsum("...kq,...k->...q", mixed, right_x / normal)
        singular = np.linalg.det(curvature) == 0.0
        covariance = np.linalg.inv(np.where(singular[..., None, None], np.nan, curvature))
        change = (covariance @ right[..., None])[..., 0]
        sd = np.sqrt(np.einsum("...ii->...i", covariance))
        done = (np.abs(change) <= ENOUGH * sd).all(axis=-1) & (step > 0)
        if (done | ~np.isfinite(change).all(axis=-1)).all():
            break
        p = p + share * change
        x = np.maximum(x + share * (right_x - (mixed @ change[..., None])[..., 0]) / normal, least)
    return Fit(p, covariance, x, (weight * off**2).sum(axis=-1), np.asarray(done))


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
    radius_sd : float
        Standard deviation of the radius of the caps [mm], common to all points, not negative; default: 0.

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
    radius_sd: float = 0.0

    def __post_init__(self) -> None:
        for name in ("load", "boundary", "friction_force"):
            check.member(self, name, above=0.0)
        for name in ("friction_relative", "radius_sd"):
            check.member(self, name, at_least=0.0)

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
