"""Area ratio and shear strength from sheared contacts, from a part in full contact, and from records."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.calibration.laws import MeasuredLaw
from metafem.calibration.statistics import (
    PAPER,
    Calibration,
    Estimate,
    Fit,
    MeasurementErrors,
    Verdict,
    errors_in_variables,
    positive,
)
from metafem.contact.elastic import usual_law
from metafem.errors import InvalidInput, refuse_if
from metafem.models import Independent, Model
from metafem.notes import information
from metafem.prediction import equilibrium
from metafem.surface import Surface

# Excess of B over 1, in standard deviations, above which a fit is refused. One normal error in a hundred is
# larger.
ABOVE_ONE = 2.33

# Names of the measured quantities.
COLUMNS = ("area_before", "area_sheared", "friction_force")

RESIST = "forces that resist sliding are positive"

Deviation = Callable[[FloatArray], FloatArray]


def proportional(measured: FloatArray, deviation: Sequence[Deviation]) -> Fit:
    """Return the ratios q_j of quantities ``x_j = q_j x_(j-1)`` with errors, and the x_0 as abscissae.

    `measured` has the quantities x_0, x_1, ... of k points, (..., c, k), nan where not measured; each point
    has two or more. `deviation` returns the standard deviation of each quantity at its values.
    """
    y = np.moveaxis(measured, -2, -1)
    known, count = np.isfinite(y), y.shape[-1] - 1
    filled = np.where(known, y, 0.0)
    both = known[..., 1:] & known[..., :-1]
    ratio = (both * filled[..., 1:]).sum(axis=-2) / (both * filled[..., :-1]).sum(axis=-2)

    def factors(q: FloatArray) -> FloatArray:
        """Return x_j/x_0, (..., 1, c)."""
        return np.concatenate([np.ones((*q.shape[:-1], 1)), q.cumprod(axis=-1)], axis=-1)[..., None, :]

    def model(q: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        by_x = factors(q)
        by_q = np.tri(count + 1, count, -1) * (by_x[..., None] / q[..., None, None, :])
        value = x[..., None] * by_x
        return value, x[..., None, None] * by_q, np.broadcast_to(by_x, value.shape)

    def of(value: FloatArray) -> FloatArray:
        return np.stack([each(value[..., j]) for j, each in enumerate(deviation)], axis=-1)

    start = (filled * factors(ratio)).sum(axis=-1) / (known * factors(ratio) ** 2).sum(axis=-1)
    # smaller values are noise and would have infinite weights
    least = 1e-6 * start.max(axis=-1, keepdims=True)
    return errors_in_variables(model, y, of, ratio, np.maximum(start, least), least)


def shear(
    area_before: ArrayLike,
    area_sheared: ArrayLike,
    friction_force: ArrayLike,
    *,
    errors: MeasurementErrors = PAPER,
    test: Sequence[Any] | None = None,
) -> Calibration:
    """Return the area ratio B and the shear strength sigma, fitted to sheared contacts.

    The lines are ``Af = B A0`` and ``F = sigma Af`` with the area A0 before shear, the sheared area Af and
    the friction force F. All three quantities have errors. The true A0 of each point is an unknown of the
    fit; A0, B A0 and sigma B A0 were measured with independent errors, whose standard deviations are computed
    from the fitted values. Both lines contain the sheared area, so B and sigma are correlated (about -0.3
    with the default errors). Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, Fig. 2, C
    and D.

    The data may be measured at static friction or during sliding, but friction force and sheared area must be
    measured at the same instant.

    Parameters
    ----------
    area_before, area_sheared : array_like, (k,)
        Total contact areas A0 before shear and Af at the friction force [mm^2], positive; nan if not
        measured.
    friction_force : array_like, (k,)
        Total friction forces F of these contacts [N]; nan if not measured.
    errors : MeasurementErrors
        Standard deviations of the measured quantities. The error of a total area does not depend on the
        number of contacts.
    test : sequence, (k,), optional
        Labels of the tests to which the points belong; default: one test.

    Returns
    -------
    Calibration

    Raises
    ------
    InvalidInput
        If an array does not match, an area is not positive, or a line has less than two points.

    Examples
    --------
    >>> before = np.array([0.05, 0.1, 0.2, 0.3])
    >>> found = shear(before, [0.043, 0.085, 0.17, 0.254], [0.0155, 0.0316, 0.0632, 0.0941])
    >>> found
    <Calibration: area_ratio = 0.8492 ± 0.0077, shear_strength = 0.3705 ± 0.006 MPa, fits>
    """
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    given = dict(zip(COLUMNS, (area_before, area_sheared, friction_force), strict=True))
    before = check.array_with_gaps("area_before", area_before, shape=(None,))
    points = np.array([check.array_with_gaps(name, given[name], shape=before.shape) for name in COLUMNS])
    for name, areas in zip(COLUMNS, points[:2], strict=False):
        must = "must be greater than 0; leave out points without contact"
        check.refuse_entries(name, areas, areas <= 0.0, must)
    known = np.isfinite(points)
    for i, what in enumerate(("B", "sigma")):
        few, pair = int(known[i : i + 2].all(axis=0).sum()), " and ".join(COLUMNS[i : i + 2])
        refuse_if(few < 2, f"{what} needs at least 2 points with {pair}, and {few} have both quantities")
    used = known.sum(axis=0) >= 2
    fit = proportional(points[:, used], (errors.of_area, errors.of_area, errors.of_friction_force))
    (ratio, strength), covariance = fit.parameter.tolist(), fit.covariance
    refuse_if(strength <= 0.0, f"friction_force is not positive: sigma = {strength:.4g} MPa; {RESIST}")
    sd = math.sqrt(covariance[0, 0])
    refuse_if(
        ratio > 1.0 + ABOVE_ONE * sd,
        f"area_ratio = {ratio:.4g} ± {sd:.2g} is above 1, but contacts shrink under shear; check that "
        "area_before and area_sheared are not exchanged",
    )
    verdict = Verdict(float(fit.chi_square.sum()), int(known[:, used].sum() - used.sum()) - 2)
    unused = int((~used).sum())
    words = f"{unused} of {len(used)} points hold less than two quantities and are not used"
    return Calibration(
        estimates={
            "area_ratio": positive(ratio, covariance[0, 0]),
            "shear_strength": positive(strength, covariance[1, 1]),
        },
        parameters=("area_ratio", "shear_strength"),
        covariance=covariance,
        verdict=verdict,
        notes=(information(words),) if unused else (),
    ).of_tests(test, len(before), lambda rows: shear(*points[:, rows], errors=errors))


def shear_strength(
    law: MeasuredLaw, surface: Surface, load_min: float, *, model: Model | None = None
) -> Estimate:
    """Return the shear strength sigma [MPa], fitted to friction forces of a part in full contact.

    The line ``F = sigma B A0`` is fitted to the friction forces, with the area A0 that the model predicts at
    each load. Both have errors. The errors of E*, B and the radii are not included: an error of B changes
    sigma by the same factor. Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234,
    supplementary text "Model parameter values".

    Parameters
    ----------
    law : MeasuredLaw
        Measured law with friction forces; points below `load_min` are not used.
    surface : Surface
        Designed or measured surface with its E*. Its friction provides the area ratio B; if it has no
        friction, the law provides B.
    load_min : float
        Smallest load that is used [N], at which all asperities are in contact.
    model : Model, optional
        Model of the contact area; default: independent asperities with the contact law `Hertz`, or `Elastic`
        if a summit has no finite curvature.

    Returns
    -------
    Estimate
        Value, standard deviation and 68 % interval of sigma [MPa].

    Raises
    ------
    InvalidInput
        If an asperity is open at `load_min` under the model, if fewer than two points are at or above
        `load_min`, if the law has no friction forces, or if the area ratio is unknown.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice([[0.1, 0.11]], (1, 2), radius=0.526, material=mf.Material(1.36))
    >>> law = mf.calibration.MeasuredLaw(
    ...     [0.1, 0.2, 0.3], friction_force=[0.127, 0.2, 0.264],
    ...     material=surface.material, friction=mf.Friction(0.4, 0.85),
    ... )
    >>> found = shear_strength(law, surface, 0.1)
    >>> round(found.value, 4), round(found.sd, 4)
    (0.3987, 0.0052)
    """
    check.instance("law", law, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    check.instance("surface", surface, Surface, "a metafem.Surface")
    least = check.number("load_min", load_min, above=0.0)
    solver = Independent(contact=usual_law(surface)) if model is None else model
    friction, force, force_sd = surface.friction or law.friction, law.friction_force, law.friction_force_sd
    if force is None or force_sd is None or friction is None:
        raise InvalidInput(
            "sigma needs a law with friction forces, and the area_ratio B of a metafem.Friction"
        )
    used = law.load >= least
    refuse_if(used.sum() < 2, f"law has {int(used.sum())} points from {least:g} N on; sigma needs at least 2")
    opened = int((equilibrium(surface, solver, load=least).asperity_area <= 0.0).sum())
    must = f"is too small: {opened} of {surface.count} asperities are not in contact at this load"
    refuse_if(opened, must, key="load_min", value=load_min)
    law = law.only(used)
    area, slope = law.computed(surface, solver)
    area_sd, force_sd = slope * law.load_sd, force_sd[used]
    fit = proportional(np.stack([area, force[used]]), (lambda _: area_sd, lambda _: force_sd))
    factor, ratio = float(fit.parameter[0]), float(friction.area_ratio)
    refuse_if(factor <= 0.0, f"friction_force is not positive: sigma B = {factor:.4g} MPa; {RESIST}")
    strength = float(factor / ratio)
    return positive(strength, float(fit.covariance[0, 0]) / ratio**2)


def at_peak(displacement: ArrayLike, friction_force: ArrayLike, values: ArrayLike | None = None) -> float:
    """Return the largest friction force of a record [N], or other values at the displacement of this peak.

    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text "Mechanical
    testing".

    Parameters
    ----------
    displacement, friction_force : array_like, (m,)
        Tangential displacement [mm], not decreasing, and force [N], positive if it resists sliding.
    values : array_like, (m,), optional
        Values to interpolate at the peak, such as contact areas, nan between the frames of the camera;
        default: the friction forces.

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If the record has no peak, or no values on both sides of it.

    Examples
    --------
    >>> x = np.linspace(0.0, 0.5, 51)
    >>> force = 0.2 * x / (x**2 + 0.01)
    >>> round(at_peak(x, force), 3), round(at_peak(x, force, 0.1 - 0.02 * np.minimum(x / 0.1, 1.0)), 3)
    (1.0, 0.08)
    """
    x = check.array("displacement", displacement, shape=(None,))
    force = check.array("friction_force", friction_force, shape=x.shape)
    found = force if values is None else check.array_with_gaps("values", values, shape=x.shape)
    one_way = "is less than the one before; give one pull in one direction"
    check.refuse_entries("displacement", x, np.diff(x, prepend=x[0]) < 0.0, one_way)
    peak = int(force.argmax())
    refuse_if(force[peak] <= 0.0, f"friction_force is at most {force[peak]:g} N; {RESIST}")
    none = (
        f"friction_force is largest at an end of the record, at {x[peak]:g} mm: there is no peak; begin the"
    )
    refuse_if(peak in (0, len(x) - 1), f"{none} record before the contact is sheared, and shear farther")
    frames = np.flatnonzero(np.isfinite(found))
    beside = frames.size > 0 and frames[0] <= peak <= frames[-1]
    refuse_if(not beside, f"values have no frame on both sides of the peak at {x[peak]:g} mm")
    # interpolate over the entries, which are equidistant in time; displacements may repeat
    return float(np.interp(peak, frames, found[frames]))
