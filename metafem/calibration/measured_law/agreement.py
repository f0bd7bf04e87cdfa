"""Agreement of a measured law with that of a design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value, span
from metafem.calibration.joint import checked_covariance
from metafem.calibration.magnitude import beyond, is_off, unit_hint, within_errors
from metafem.calibration.measured_law.features import Deviations, Feature, deviations_of, features_of
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.verdict import Verdict, judged
from metafem.errors import InvalidInput
from metafem.inversion import Design
from metafem.notes import Note
from metafem.prediction import FrictionLaw

# Parameters with errors that shift all points together.
PARAMETERS = ("composite_modulus", "shear_strength", "area_ratio")

# Ratio of E* to that of the design above which the material or a unit is wrong.
OTHER_MATERIAL = 3.0


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Value):
    """Agreement of a measured law with a design, point by point and in its slopes.

    Attributes
    ----------
    measured : MeasuredLaw
    point : ndarray of int, (m,)
        The points of the measured law that are compared.
    predicted : ndarray, (m,)
        Rescaled friction of the design at the measured loads [mm^2].
    deviation, deviation_sd : ndarray, (m,)
        Measured minus predicted rescaled friction, and its standard deviation from the errors of the load, of
        the friction, and of the parameters [mm^2].
    covariance : ndarray, (m, m)
        Covariance matrix of the deviations [mm^4].
    features : tuple of Feature
        Slopes, operating points and crossover, as far as the target of the design has them.
    verdict : Verdict
        Verdict on the deviations, with their correlation from the errors of the parameters.
    parameters : mapping of str to float
        Standard deviations of the parameters that are included.
    notes : tuple of Note
        What was left out.
    percent, normalised : ndarray, (m,)
        Deviation over prediction [%], and over its standard deviation [-].

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.LinearLaw(6.87), template)
    >>> measured = MeasuredLaw([0.1, 0.3], area=[0.6, 1.8], material=template.material)
    >>> compare(measured, design).percent.round(1)
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
        found: FloatArray = np.sqrt(np.diag(self.covariance))
        return found

    @property
    def percent(self) -> FloatArray:
        """Deviation over prediction [%]; infinite where the design has no contact."""
        ratio = np.full(self.deviation.shape, np.inf)
        np.divide(100.0 * self.deviation, self.predicted, out=ratio, where=self.predicted > 0.0)
        return ratio

    @property
    def normalised(self) -> FloatArray:
        """Deviation over its standard deviation [-]."""
        return self.deviation / self.deviation_sd

    def __repr__(self) -> str:
        rms = np.sqrt((self.normalised**2).mean())
        lines = [f"Comparison of {self.measured!r}", f"  points    {rms:.2g} standard deviations (rms)"]
        lines += [f"  {feature}" for feature in self.features]
        return "\n".join([*lines, f"  verdict   {self.verdict}"])


def compare(
    measured: MeasuredLaw,
    design: Design | FrictionLaw,
    *,
    parameters: Mapping[str, float] | Sequence[str] = (),
    covariance: ArrayLike | None = None,
) -> Comparison:
    """Compare a measured law with a design.

    The deviation at the measured load ``x = P/E*`` is ``d = y - f(x)``: y is the rescaled friction, f the law
    of the design. Its variance is ``sd_y^2 + (f' sd_x)^2``, with the mean slope f' over ``x - sd_x`` to
    ``x + sd_x``. Errors of E*, sigma and B shift all points: they add ``J C J^T`` to the covariance of the
    deviations, with ``dd/dE* = f' x / E*``, ``dd/dsigma = -y / sigma`` and ``dd/dB = -y / B``.

    The slopes, operating points and the crossover are estimated from the measured points, and with the same
    estimator from the design at the same loads.

    Parameters
    ----------
    measured : MeasuredLaw
    design : Design or FrictionLaw
        The law of a design is computed at the measured loads, a FrictionLaw is interpolated. Features follow
        from the target of a design.
    parameters : mapping of str to float, or sequence of str
        Standard deviations of ``composite_modulus`` [MPa], ``shear_strength`` [MPa] and ``area_ratio`` [-],
        or the names of the rows of `covariance`; default: no errors.
    covariance : array_like, (p, p), optional
        Covariance matrix of the named parameters, for example from a calibration.

    Returns
    -------
    Comparison

    Raises
    ------
    InvalidInput
        For unknown parameters, a matrix that is not positive semidefinite, errors of sigma or B of a law
        without a Friction, and if no load is within the range of the design or all are below its target's.
    NotConverged
        If the model of the design has no solution at a measured load.

    Notes
    -----
    Points at loads above the largest of ``design.law`` are left out, and a note names them.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(
    ...     0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85)
    ... )
    >>> design = mf.design(mf.LinearLaw(6.87), template)
    >>> load = np.linspace(0.05, 0.5, 10)
    >>> force = 1.03 * mf.friction_law(design.surface, load=load).friction_force
    >>> measured = MeasuredLaw(load, friction_force=force, material=template.material,
    ...                        friction=template.friction)
    >>> compare(measured, design).percent.round(2)[:3]
    array([3., 3., 3.])
    >>> print(compare(measured, design).features[0])
    slope, P/E* = 0.12 to 0.481 mm²: 7.33 ± 0.19, design 7.12 (+3.0 %, +1.1 s.d.), target 6.87 (+6.7 %)
    """
    check.instance("measured", measured, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    if not isinstance(design, FrictionLaw):
        check.instance("design", design, Design, "a metafem.Design or a metafem.FrictionLaw")
    names, matrix = _parameters(measured, parameters, covariance)
    law = design.law if isinstance(design, Design) else design
    end = float(law.rescaled_load[-1])
    smallest = measured.known().load[0]
    known, within = ~np.isnan(measured.rescaled_friction), measured.rescaled_load <= end
    point = np.flatnonzero(known & within)
    modulus = measured.material.composite_modulus
    if not point.size:
        raise InvalidInput(
            f"all measured loads exceed the largest load of the design, P/E* = {end:.4g} mm^2 or "
            f"{modulus * end:.4g} N; the smallest is {smallest:.4g} N"
            + beyond("load", smallest / modulus / end)
        )
    first, last = _first_load(design), float(measured.rescaled_load[point].max())
    if last < first:
        raise InvalidInput(
            f"all measured loads lie below the first load of the target, P/E* = {first:.4g} mm^2 or "
            f"{modulus * first:.4g} N; the largest is {modulus * last:.4g} N{beyond('load', last / first)}"
        )
    found = deviations_of(measured, point, design, names, matrix)
    notes = tuple(
        Note(_left_out(measured.load[which], why))
        for which, why in (
            (~known, "the area of a contact is unknown"),
            (known & ~within, f"the law of the design ends at P/E* = {end:.4g} mm^2"),
        )
        if which.any()
    )
    notes += _magnitudes(found, design)
    parts = [*features_of(found, design)] if isinstance(design, Design) else []
    # if the law holds, whitened residuals in order of load are independent
    residual = np.linalg.solve(np.linalg.cholesky(found.covariance), found.values)
    deviations = dict(zip(names, np.sqrt(np.diag(matrix)).tolist(), strict=True))
    return Comparison(
        measured=measured,
        point=point,
        predicted=found.predicted,
        deviation=found.values,
        covariance=found.covariance,
        features=tuple(part for part in parts if isinstance(part, Feature)),
        verdict=judged(residual, parameters=0),
        parameters=deviations,
        notes=(*measured.notes, *notes, *(part for part in parts if isinstance(part, Note))),
    )


def _first_load(design: Design | FrictionLaw) -> float:
    """Return the smallest rescaled load of a target [mm^2], 0 of a law."""
    if isinstance(design, FrictionLaw):
        return 0.0
    return min([float(design.target_law.load[0]), *(branch.load_range[0] for branch, _ in design.fits)])


def _magnitudes(found: Deviations, design: Design | FrictionLaw) -> tuple[Note, ...]:
    """Return notes on loads within their errors, and on frictions and moduli far from the design's."""
    measured = found.measured
    notes = within_errors("load", measured.load, measured.load_sd)
    there = found.predicted > 0.0
    if there.any():
        friction = measured.rescaled_friction[found.point]
        ratio = float(np.median(friction[there] / found.predicted[there]))
        if is_off(ratio):
            name = "friction_force" if measured.by_force else "area"
            notes += (Note(f"{name} is {ratio:.2g} times that of the design; {unit_hint(name, ratio)}"),)
    if isinstance(design, Design):
        ratio = measured.material.composite_modulus / design.surface.material.composite_modulus
        if not 1.0 / OTHER_MATERIAL < ratio < OTHER_MATERIAL:
            notes += (Note(f"E* of the part is {ratio:.2g} times that of the design; check its unit"),)
    return notes


def _parameters(
    measured: MeasuredLaw, parameters: Mapping[str, float] | Sequence[str], covariance: ArrayLike | None
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of the parameters with an error and their covariance matrix."""
    names = tuple(parameters)
    for name in names:
        if name not in PARAMETERS:
            raise InvalidInput(f"parameters: {name!r:.40} is unknown; the names are {', '.join(PARAMETERS)}")
        if name != "composite_modulus" and measured.friction is None:
            raise InvalidInput(f"parameters: {name} has no effect on a law without a Friction; leave it out")
    if covariance is None:
        if not isinstance(parameters, Mapping):
            if names:
                raise InvalidInput("parameters without standard deviations need covariance")
            return (), np.zeros((0, 0))
        sd = [check.number(name, parameters[name], at_least=0.0) for name in names]
        return names, np.diag(np.square(sd)) if sd else np.zeros((0, 0))
    if isinstance(parameters, Mapping):
        raise InvalidInput("parameters must be a list of names if covariance is given")
    return names, checked_covariance(names, covariance)


def _left_out(load: FloatArray, why: str) -> str:
    """Return which points are not compared."""
    points = (
        f"the point at {load[0]:.4g} N is"
        if len(load) == 1
        else f"{len(load)} points at {span(load, 'N')} are"
    )
    return f"{points} left out: {why}"
