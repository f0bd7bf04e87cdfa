"""Result of a diagnosis: errors with their uncertainties, their shares in the misfit, and the residuals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem._values import Value, percent
from metafem.calibration.diagnosis import sentences
from metafem.calibration.diagnosis.causes import GROUPS, Priors
from metafem.calibration.diagnosis.shares import Unresolved
from metafem.calibration.verdict import Verdict, chi
from metafem.models import Model
from metafem.notes import Note, counted
from metafem.surface import Friction, Surface


@dataclass(frozen=True)
class Cause:
    """One error of the entire part or of its calibration.

    Attributes
    ----------
    name : str
        ``angle_x``, ``angle_y``, ``height_scale``, ``composite_modulus``, ``friction`` or
        ``adhesion_root``.
    prior_sd, mean, sd : float
        Prior standard deviation, and posterior mean and standard deviation; angles in [rad], all other errors
        relative [-]. The 68 % interval is ``mean - sd`` to ``mean + sd``.

    Examples
    --------
    >>> print(Cause("height_scale", 0.02, 0.013, 0.001))
    height scale +1.3 % ± 0.1 % (expected: 0 ± 2 %)
    """

    name: str
    prior_sd: float
    mean: float
    sd: float

    def __str__(self) -> str:
        found = sentences.interval(self.name, self.mean, self.sd)
        return sentences.stated(self.name, found, self.prior_sd)


@dataclass(frozen=True, eq=False, repr=False)
class SingleErrors(Value):
    """Errors of one kind for the n asperities [mm].

    Attributes
    ----------
    name : str
        ``height``, ``radius`` or ``position``.
    prior_sd : float
        Prior standard deviation [mm].
    mean, sd : ndarray, (n,), or (n, 2) for positions
        Posterior means and standard deviations [mm].
    outlier : ndarray of bool, as mean
        Whether an error is so large that the largest of n Gaussian errors is smaller in 99 % of parts.

    Examples
    --------
    >>> mean, sd = np.array([0.0, -0.01]), np.full(2, 1e-4)
    >>> errors = SingleErrors("height", 9e-4, mean, sd, np.array([False, True]))
    >>> errors.mean[errors.outlier]
    array([-0.01])
    """

    name: str
    prior_sd: float
    mean: FloatArray
    sd: FloatArray
    outlier: np.ndarray


@dataclass(frozen=True, eq=False, repr=False)
class Explanation(Value):
    """Errors of a part that explain its measured law; the result of `explain`.

    Attributes
    ----------
    causes : tuple of Cause
        Errors of the entire part and of its calibration whose prior standard deviation is not 0.
    covariance : ndarray, (c, c)
        Posterior covariance of `causes`, in their order.
    single : mapping of str to SingleErrors
        Errors of single asperities whose prior standard deviation is not 0, under the names ``height``,
        ``radius`` and ``position``.
    shares : mapping of str to float
        Share of each cause in the explained misfit [-], largest first; the shares add up to 1. Names:
        ``tilt``, ``height_scale``, ``composite_modulus``, ``friction``, ``adhesion_root``, ``height``,
        ``radius`` and ``position``.
    misfit_without : mapping of str to float
        Misfit if one cause is left out and all other causes remain [-], in the order of `shares`.
    unresolved : tuple of Unresolved
        Errors and combinations of errors that the measured values do not determine.
    misfit_design, misfit : float
        Chi-square of the measured values without any errors of the part, and with all of them [-]. The second
        includes the sum of the squared errors over their prior variances.
    count : int
        Number of measured values, without loads and open contacts; the expected value of `misfit`.
    verdict : Verdict
        Whether the measurement errors explain the remaining residuals.
    load, load_sd : ndarray, (k,)
        Posterior means of the true loads and their standard deviations [N].
    residual : mapping of str to ndarray
        Measured minus explained values over their standard deviations [-]: ``load``, ``friction_force`` and
        ``area``, (k,), and ``asperity_area``, (k, n), nan where no contact was measured.
    log_evidence : mapping of str to float
        Logarithm of the probability density of the measured values for each model that was tried.
    surface : Surface
        The part with the mean errors, including its tilt and its E*.
    friction : Friction or None
        Friction with the mean error of sigma B.
    model : Model
    priors : Priors
    notes : tuple of Note
    sites : ndarray of int, (n,), or None
        Sites of the asperities in the template of a Design; None for a Surface.

    Examples
    --------
    >>> import metafem as mf
    >>> from metafem.calibration import MeasuredLaw, explain
    >>> material = mf.Material(1.36)
    >>> design = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.13], (2, 2), radius=0.526, material=material)
    >>> loads = np.array([0.05, 0.1, 0.2])
    >>> areas = [mf.equilibrium(design.tilted(0.002, 0.0), load=load).asperity_area for load in loads]
    >>> measured = MeasuredLaw(loads, asperity_area=areas, material=material)
    >>> explain(measured, design, model=mf.Independent()).sentences()[-1][:50]
    'What remains is no larger than the errors of the m'
    """

    causes: tuple[Cause, ...]
    covariance: FloatArray
    single: Mapping[str, SingleErrors]
    shares: Mapping[str, float]
    misfit_without: Mapping[str, float]
    unresolved: tuple[Unresolved, ...]
    misfit_design: float
    misfit: float
    count: int
    verdict: Verdict
    load: FloatArray
    load_sd: FloatArray
    residual: Mapping[str, FloatArray]
    log_evidence: Mapping[str, float]
    surface: Surface
    friction: Friction | None
    model: Model
    priors: Priors
    notes: tuple[Note, ...] = field(default=())
    sites: IntArray | None = None

    def __getitem__(self, name: str) -> Cause:
        return next(cause for cause in self.causes if cause.name == name)

    def __repr__(self) -> str:
        first = next(iter(self.shares), None)
        what = "no causes" if first is None else f"{percent(self.shares[first])} by {sentences.NAMES[first]}"
        return (
            f"<Explanation: chi² {chi(self.misfit_design)} of the design, {chi(self.misfit)} explained, "
            f"{what}, {counted(self.notes)}>"
        )

    @property
    def outliers(self) -> IntArray:
        """Numbers of the asperities whose height or radius is far outside its tolerance."""
        found = [errors.outlier for name, errors in self.single.items() if name != "position"]
        return np.flatnonzero(np.any(found, axis=0)) if found else np.zeros(0, dtype=np.int64)

    def sentences(self) -> tuple[str, ...]:
        """Return sentences on the causes of the misfit, undetermined errors and remaining residuals."""
        areas = bool(np.isfinite(self.residual.get("asperity_area", np.nan)).any())
        found = [sentences.misfit(self.misfit_design, self.misfit, self.count, areas)]
        found += sentences.ranking(self.shares)
        for name in ("height", "radius"):
            if name in self.single:
                errors = self.single[name]
                for i in np.flatnonzero(errors.outlier).tolist():
                    numbers = errors.mean[i], errors.sd[i], errors.prior_sd
                    found.append(sentences.outlier(name, i, self.sites, *numbers))
        found += [sentences.unresolved(one.change, one.variance_left) for one in self.unresolved]
        found += sentences.models(self.log_evidence)
        found.append(sentences.remaining(self.verdict))
        return tuple(found)

    def __str__(self) -> str:
        lines = []
        for group in self.shares:
            lines += [str(cause) for cause in self.causes if cause.name in GROUPS[group]]
            if group in self.single:
                errors = self.single[group]
                found = sentences.spread(group, errors.mean, errors.sd)
                lines.append(sentences.stated(group, found, errors.prior_sd))
        return "\n".join([*lines, *self.sentences()])
