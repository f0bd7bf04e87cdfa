"""Measured and predicted slopes of branches and friction at operating points."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration.measured_law.bent_line import KINK, least
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.measured_law.segmented import LEAST as LEAST_BENT
from metafem.calibration.measured_law.segmented import TRIED, fit_segments, points_of
from metafem.errors import InvalidInput
from metafem.inversion import BilinearLaw, Design, MultilinearLaw, OperatingPoints
from metafem.notes import Note, information
from metafem.prediction import FrictionLaw, friction_law
from metafem.progress import doing

# Fewest points of a line whose scatter can be judged.
LEAST = 3


@dataclass(frozen=True)
class Feature:
    """A slope, the friction at an operating point, or the crossover load of a measured law.

    Attributes
    ----------
    name : str
        Kind of feature, with its loads.
    unit : str
        "" for a slope, else "mm²".
    value, sd : float
        Measured value, and its standard deviation from the errors of measurement and of the parameters; for a
        crossover, half its 68 % interval from the errors of measurement.
    predicted : float
        Value of the design, at the same loads by the same estimator.
    target : float
        Specified value.
    interval : (float, float)
        68 % interval of the value.
    deviation, normalised : float
        Relative deviation from the design, and in standard deviations [-].
    target_deviation : float
        Relative deviation from the target [-].

    Examples
    --------
    >>> print(Feature("slope", "", 7.1, 0.2, 6.9, 6.87, (6.9, 7.3)))
    slope: 7.1 ± 0.2, design 6.9 (+2.9 %, +1.0 s.d.), target 6.87 (+3.3 %)
    """

    name: str
    unit: str
    value: float
    sd: float
    predicted: float
    target: float
    interval: tuple[float, float]

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
        unit = f" {self.unit}".rstrip()
        compared = (
            f"{self.predicted:.3g}{unit} ({percent(self.deviation, '+.1f')}, {self.normalised:+.1f} s.d.)"
        )
        return (
            f"{self.name}: {self.value:.3g} ± {self.sd:.2g}{unit}, design {compared}, "
            f"target {self.target:.3g}{unit} ({percent(self.target_deviation, '+.1f')})"
        )


@dataclass(frozen=True, eq=False)
class Deviations:
    """Deviations (m,) of measured points from the law of a design at rescaled loads x (m,) [mm^2]."""

    measured: MeasuredLaw
    point: NDArray[np.intp]
    predicted: FloatArray  # (m,), rescaled friction of the design [mm^2]
    slope: FloatArray  # (m,), its mean slope over the error bar of the load [-]
    operating: FloatArray  # (q,), its rescaled friction at the operating points of the target [mm^2]
    covariance: FloatArray  # (m, m), [mm^4]

    @property
    def load(self) -> FloatArray:
        """Rescaled loads x [mm^2]."""
        return self.measured.rescaled_load[self.point]

    @property
    def values(self) -> FloatArray:
        """Deviations [mm^2]."""
        return self.measured.rescaled_friction[self.point] - self.predicted

    def compared(self, which: NDArray[np.bool_]) -> MeasuredLaw:
        """Return the law of some of the compared points, as areas."""
        law, point = self.measured, self.point[which]
        return MeasuredLaw(
            law.load[point],
            area=law.rescaled_friction[point],
            load_sd=law.load_sd[point],
            area_sd=law.rescaled_friction_sd[point],
            material=law.material,
        )

    def feature(self, name: str, unit: str, weight: FloatArray, predicted: float, target: float) -> Feature:
        """Return a feature that is a sum of the friction of the points with weights (m,)."""
        value = predicted + float(weight @ self.values)
        sd = math.sqrt(float(weight @ self.covariance @ weight))
        return Feature(name, unit, value, sd, predicted, target, (value - sd, value + sd))


def features_of(found: Deviations, design: Design) -> Iterator[Feature | Note]:
    """Return the features of a design's target in a measured law, and notes on missing ones."""
    yield from _slopes(found, design)
    yield from _points(found, design)
    yield from _crossover(found, design)


def _slopes(found: Deviations, design: Design) -> Iterator[Feature | Note]:
    """Return the slopes of the branches, by least squares of the points within their loads."""
    for i, (branch, _) in enumerate(design.fits):
        low, high = branch.load_range
        chosen = (found.load >= low) & (found.load <= high)
        number = f" {i + 1}" if len(design.fits) > 1 else ""
        name = f"slope{number}, P/E* = {low:.3g} to {high:.3g} mm²"
        if chosen.sum() < LEAST or np.ptp(found.load[chosen]) == 0.0:
            yield information(f"{name}: {int(chosen.sum())} measured points; a slope needs at least {LEAST}")
            continue
        centred = np.where(chosen, found.load - found.load[chosen].mean(), 0.0)
        weight = centred / (centred**2).sum()
        yield found.feature(name, "", weight, float(weight @ found.predicted), branch.slope)


def _points(found: Deviations, design: Design) -> Iterator[Feature | Note]:
    """Return the friction at the operating points, from the two measured points around each."""
    if not isinstance(design.target, OperatingPoints):
        return
    for load, wanted, predicted in zip(
        design.target.rescaled_load.tolist(),
        design.target.rescaled_friction.tolist(),
        found.operating.tolist(),
        strict=True,
    ):
        name = f"friction at P/E* = {load:.3g} mm²"
        after = int(np.searchsorted(found.load, load))
        if after < len(found.load) and found.load[after] == load:
            weight = (found.load == load) / (found.load == load).sum()
        elif 0 < after < len(found.load):
            below, above = found.load[after - 1 : after + 1]
            weight = np.zeros(len(found.load))
            weight[after - 1 : after + 1] = (above - load) / (above - below), (load - below) / (above - below)
        else:
            ends = f"{found.load[0]:.3g} to {found.load[-1]:.3g} mm²"
            yield information(f"{name}: the measured loads P/E* = {ends} do not include it")
            continue
        yield found.feature(name, "mm²", weight, predicted, wanted)


def _crossover(found: Deviations, design: Design) -> Iterator[Feature | Note]:
    """Return the crossover load of a law with two branches."""
    target = design.target
    if isinstance(target, BilinearLaw):
        wanted = target.crossover_load
    elif isinstance(target, MultilinearLaw) and len(target.slopes) == 2:
        wanted = 0.5 * sum(target.crossover_loads[0])
    else:
        return
    # the slope changes again beyond the second branch
    end = design.fits[-1][0].load_range[1] if design.fits else np.inf
    below = found.load <= end
    if below.sum() < LEAST_BENT:
        words = f"{int(below.sum())} measured points up to P/E* = {end:.3g} mm², the end of the second branch"
        yield information(f"crossover: {words}; it needs at least {LEAST_BENT}")
        return
    law = found.compared(below)
    try:
        fit = fit_segments(law)
    except InvalidInput as error:
        yield information(f"crossover: {error}")
        return
    # the same estimator on the law of the design at the same loads
    points = replace(points_of(law), y=found.predicted[below][None])
    exact = float(least(points, TRIED).parameters[0, KINK])
    sd = 0.5 * float(np.diff(fit.crossover_interval)[0])
    interval = fit.crossover_interval
    yield Feature("crossover, P/E*", "mm²", fit.crossover_load, sd, exact, wanted, interval)
    yield from (information(f"crossover: {note}") for note in fit.notes)


@doing("computing the law of the design at the measured loads")
def deviations_of(
    measured: MeasuredLaw,
    point: NDArray[np.intp],
    design: Design | FrictionLaw,
    parameters: tuple[str, ...],
    matrix: FloatArray,
) -> Deviations:
    """Return the deviations of points of a law, with the covariance matrix (p, p) of parameters."""
    x, sd = measured.rescaled_load[point], measured.rescaled_load_sd[point]
    end = float((design.law if isinstance(design, Design) else design).rescaled_load[-1])
    middle = np.clip(x, 0.0, end)
    low, high = np.clip(x - sd, 0.0, end), np.clip(x + sd, 0.0, end)
    # where the whole error bar lies below 0, the slope at the smallest loads
    high = np.where(high > low, high, np.minimum(sd, end))
    operating = np.empty(0)
    if isinstance(design, Design) and isinstance(design.target, OperatingPoints):
        operating = design.target.rescaled_load
    loads, place = np.unique(np.concatenate([middle, low, high, operating]), return_inverse=True)
    friction = _law(measured, design, loads)[place]
    predicted, at_low, at_high, at_operating = np.split(friction, np.cumsum([len(x)] * 3))
    slope = (at_high - at_low) / (high - low)
    total = np.diag(measured.rescaled_friction_sd[point] ** 2 + (slope * sd) ** 2)
    if parameters:
        changes = _changes(measured, point, slope)
        jacobian = np.column_stack([changes[name] for name in parameters])
        total = total + jacobian @ matrix @ jacobian.T
    return Deviations(measured, point, predicted, slope, at_operating, total)


def _changes(measured: MeasuredLaw, point: NDArray[np.intp], slope: FloatArray) -> dict[str, FloatArray]:
    """Return the changes of the deviations (m,) with each parameter."""
    changes = {
        "composite_modulus": slope * measured.rescaled_load[point] / measured.material.composite_modulus
    }
    if measured.friction is not None:
        # areas do not depend on the shear strength and the area ratio
        by_force = measured.rescaled_friction[point] if measured.by_force else np.zeros(len(point))
        changes["shear_strength"] = -by_force / measured.friction.shear_strength
        changes["area_ratio"] = -by_force / measured.friction.area_ratio
    return changes


def _law(measured: MeasuredLaw, design: Design | FrictionLaw, rescaled_load: FloatArray) -> FloatArray:
    """Return the rescaled friction at increasing rescaled loads."""
    if isinstance(design, FrictionLaw):
        load, friction = np.append(0.0, design.rescaled_load), np.append(0.0, design.rescaled_friction)
        found: FloatArray = np.interp(rescaled_load, load, friction)
        return found
    # with the material of the part, on whose modulus the effect of adhesion depends
    surface = design.surface.replaced(material=measured.material)
    load = measured.material.composite_modulus * rescaled_load
    return friction_law(surface, design.law.model, load=load).rescaled_friction
