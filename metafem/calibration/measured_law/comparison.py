"""Result of a comparison: deviations of a measured law from a design in its points and features."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem._values import Value, percent
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.verdict import Verdict
from metafem.notes import Note


@dataclass(frozen=True)
class Feature:
    """Slope of a measured law over the loads of a line of the target.

    Attributes
    ----------
    name : str
        The loads of the slope.
    value, sd : float
        Measured value, and its standard deviation due to the errors of measurement and of the parameters.
    predicted : float
        Value of the design, estimated with the same method at the same loads.
    target : float
        Value that the target specifies.
    deviation, normalised : float
        Relative deviation from the design, and deviation over its standard deviation [-].
    target_deviation : float
        Relative deviation from the target [-].

    Examples
    --------
    >>> print(Feature("slope", 7.1, 0.2, 6.9, 6.87))
    slope: 7.1 ± 0.2, design 6.9 (+2.9 %, +1.0 s.d.), target 6.87 (+3.3 %)
    """

    name: str
    value: float
    sd: float
    predicted: float
    target: float

    @property
    def deviation(self) -> float:
        """Relative deviation from the design [-]."""
        return self.value / self.predicted - 1.0

    @property
    def normalised(self) -> float:
        """Deviation from the design over its standard deviation [-]."""
        return (self.value - self.predicted) / self.sd

    @property
    def target_deviation(self) -> float:
        """Relative deviation from the target [-]."""
        return self.value / self.target - 1.0

    def __str__(self) -> str:
        compared = f"{self.predicted:.3g} ({percent(self.deviation, '+.1f')}, {self.normalised:+.1f} s.d.)"
        return (
            f"{self.name}: {self.value:.3g} ± {self.sd:.2g}, design {compared}, "
            f"target {self.target:.3g} ({percent(self.target_deviation, '+.1f')})"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Value):
    """Agreement of a measured law with a design, point by point and in its slopes.

    Attributes
    ----------
    measured : MeasuredLaw
    point : ndarray of int, (m,)
        Numbers of the compared points of the measured law.
    predicted : ndarray, (m,)
        Rescaled friction of the design at the measured loads [mm^2].
    deviation, deviation_sd : ndarray, (m,)
        Measured minus predicted rescaled friction, and its standard deviation due to the errors of the load,
        the friction and the parameters [mm^2].
    covariance : ndarray, (m, m)
        Covariance matrix of the deviations [mm^4].
    features : tuple of Feature
        Slopes of the lines of the design's target.
    verdict : Verdict
        Verdict on the deviations; it accounts for their correlation due to the errors of the parameters.
    parameters : mapping of str to float
        Standard deviations of the parameters whose errors are included.
    notes : tuple of Note
        Notes on what was left out.
    percent, normalised : ndarray, (m,)
        Deviation over predicted value [%], and over its standard deviation [-].

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.LinearLaw(6.87), template)
    >>> measured = mf.calibration.MeasuredLaw([0.1, 0.3], area=[0.6, 1.8], material=template.material)
    >>> mf.calibration.compare(measured, design).percent.round(1)
    array([-8.6,  3.1])
    """

    measured: MeasuredLaw
    point: NDArray[np.intp]
    predicted: FloatArray
    deviation: FloatArray
    covariance: FloatArray
    features: tuple[Feature, ...]
    verdict: Verdict
    parameters: Mapping[str, float]
    notes: tuple[Note, ...]

    @property
    def deviation_sd(self) -> FloatArray:
        """Standard deviations of the deviations [mm^2]."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def percent(self) -> FloatArray:
        """Deviation over predicted value [%]; infinite where the design has no contact."""
        infinite = np.full(self.deviation.shape, np.inf)
        above = self.predicted > 0.0
        return np.asarray(np.divide(100.0 * self.deviation, self.predicted, infinite, where=above))

    @property
    def normalised(self) -> FloatArray:
        """Deviation over its standard deviation [-]."""
        return self.deviation / self.deviation_sd

    def __repr__(self) -> str:
        rms = np.sqrt((self.normalised**2).mean())
        lines = [f"Comparison of {self.measured!r}", f"  points    {rms:.2g} standard deviations (rms)"]
        lines += [f"  {feature}" for feature in self.features]
        return "\n".join([*lines, f"  verdict   {self.verdict}"])
