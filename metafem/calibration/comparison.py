"""Comparison of a measured law with the law of a design."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value, percent, span
from metafem.calibration.laws import MeasuredLaw
from metafem.calibration.statistics import Verdict, checked_covariance
from metafem.errors import refuse_if, shown
from metafem.inversion import Design
from metafem.notes import Note
from metafem.prediction import FrictionLaw
from metafem.progress import doing

# Parameters whose errors shift all points together.
PARAMETERS = ("composite_modulus", "shear_strength", "area_ratio")

# Relative deviation (rms) above which exchanged columns are suspected, and the largest ratio of the deviation
# after the exchange to the deviation before it.
EXCHANGED, BETTER = 0.3, 0.3


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Value):
    """Agreement of a measured law with a design, point by point.

    Attributes
    ----------
    measured : MeasuredLaw
        The measured law at the m compared loads.
    predicted : ndarray, (m,)
        Rescaled friction of the design at the measured loads [mm^2].
    deviation, deviation_sd : ndarray, (m,)
        Measured minus predicted rescaled friction, and its standard deviation due to the errors of the load,
        the friction and the parameters [mm^2].
    covariance : ndarray, (m, m)
        Covariance matrix of the deviations [mm^4].
    verdict : Verdict
        Verdict on the deviations; it accounts for their correlation due to the errors of the parameters.
    parameters : mapping of str to float
        Standard deviations of the parameters whose errors are included.
    notes : tuple of Note
        Notes on what was left out.
    percent : ndarray, (m,)
        Deviation over predicted value [%].

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
    predicted: FloatArray
    deviation: FloatArray
    covariance: FloatArray
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
        touching = self.predicted > 0.0
        return np.where(touching, 100.0 * self.deviation / np.where(touching, self.predicted, 1.0), np.inf)


def compare(
    measured: MeasuredLaw,
    design: Design,
    *,
    parameters: Sequence[str] = (),
    covariance: ArrayLike | None = None,
) -> Comparison:
    """Return the deviations of a measured law from a design, with their errors and a verdict.

    The deviation at the measured load ``x = P/E*`` is ``d = y - f(x)``, with the measured rescaled friction y
    and the law f of the design. The variance of d is ``sd_y^2 + (f' sd_x)^2``, where f' is the mean slope
    between ``x - sd_x`` and ``x + sd_x``. Errors of E*, sigma and B shift all points together. They add
    ``J C J^T`` to the covariance of the deviations, with ``dd/dE* = f' x / E*``, ``dd/dsigma = -y / sigma``
    and ``dd/dB = -y / B``.

    Parameters
    ----------
    measured : MeasuredLaw
    design : Design
        Its law is computed at the measured loads.
    parameters : sequence of str
        Names of the parameters with errors, in the order of the rows of `covariance`: ``composite_modulus``,
        ``shear_strength`` and ``area_ratio``; default: none.
    covariance : array_like, (p, p), optional
        Covariance matrix of `parameters` in MPa and 1, for example from a calibration.

    Returns
    -------
    Comparison

    Raises
    ------
    InvalidInput
        If a parameter is unknown, the matrix is not positive semidefinite, sigma or B have errors but the law
        has no Friction, or no load is within the range of the design.
    NotConverged
        If the model of the design has no solution at a measured load.

    Notes
    -----
    Points above the largest load of ``design.law`` are left out, and a note names them.

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
    """
    check.instance("measured", measured, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    check.instance("design", design, Design, "a metafem.Design")
    friction = measured.friction
    must = "parameters of the friction have no effect on a law without a Friction; leave them out"
    refuse_if(friction is None and set(parameters) - {"composite_modulus"}, must)
    refuse_if(parameters and covariance is None, f"parameters = {shown(parameters)} need a covariance")
    names, matrix = checked_covariance(parameters, covariance, PARAMETERS)
    end = float(design.law.rescaled_load[-1])
    inside = measured.rescaled_load <= end
    newtons = measured.material.composite_modulus * end
    limit = f"the law of the design ends at P/E* = {end:.4g} mm^2, {newtons:.4g} N"
    loads = span(measured.load[~inside], "N") if not inside.all() else ""
    refuse_if(not inside.any(), f"all measured loads, {loads}, are beyond it: {limit}")
    notes = [*measured.notes, *[Note(f"points at {loads} are left out: {limit}")] * bool(loads)]
    law = measured.only(inside)
    # use the material of the part, because the effect of adhesion depends on E*
    surface = design.surface.replaced(material=measured.material)
    with doing("computing the law of the design at the measured loads"):
        predicted, slope = law.computed(surface, design.law.model, newtons)
    deviation, total = law.rescaled_friction - predicted, _covariance(law, slope, names, matrix)
    # if the design's law is correct, the whitened residuals are independent
    residual = np.linalg.solve(np.linalg.cholesky(total), deviation)
    return Comparison(
        measured=law,
        predicted=predicted,
        deviation=deviation,
        covariance=total,
        verdict=Verdict(float(residual @ residual), len(residual)),
        parameters=dict(zip(names, np.sqrt(np.diag(matrix)).tolist(), strict=True)),
        notes=(*_exchanged(law, design.law, deviation / predicted), *notes),
    )


def _covariance(law: MeasuredLaw, slope: FloatArray, names: Sequence[str], matrix: FloatArray) -> FloatArray:
    """Return the covariance of the deviations, from the slopes of the law of the design."""
    found, friction = law.rescaled_friction, law.friction
    # areas do not depend on the shear strength and the area ratio
    by_stress = -found if law.stress_of_forces else 0.0 * found
    changes = {"composite_modulus": slope * law.load / law.material.composite_modulus}
    if friction is not None:
        changes["shear_strength"] = by_stress / friction.shear_strength
        changes["area_ratio"] = by_stress / friction.area_ratio
    jacobian = np.array([changes[name] for name in names]).reshape(len(names), len(found)).T
    variance = law.rescaled_friction_sd**2 + (slope * law.load_sd) ** 2
    return np.asarray(np.diag(variance) + jacobian @ matrix @ jacobian.T)


def _exchanged(measured: MeasuredLaw, law: FrictionLaw, relative: FloatArray) -> Iterator[Note]:
    """Yield a note if the law agrees much better after an exchange of loads and friction forces."""
    before, stress = float(np.sqrt(np.mean(relative**2))), measured.stress_of_forces
    x = measured.rescaled_friction * stress / measured.material.composite_modulus
    inside = (x > law.rescaled_load[0]) & (x <= law.rescaled_load[-1])
    if not stress or not before > EXCHANGED or not inside.any():
        return
    expected = np.interp(x[inside], law.rescaled_load, law.rescaled_friction)
    after = float(np.sqrt(np.mean((measured.load[inside] / stress / expected - 1.0) ** 2)))
    if after < BETTER * before:
        yield Note(
            f"the friction forces differ from the design by {percent(before)}, and by {percent(after)} if "
            "they are exchanged with the loads: check whether the columns of the table are exchanged"
        )
