"""Area ratio and shear strength from the areas and the friction forces of sheared contacts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.calibration.magnitude import OFF, is_off, unit_hint, within_errors
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.calibration.resampling import Bootstrap, labels_of
from metafem.calibration.sheared.fits import LINES, fitted, fitted_tests, resampled
from metafem.calibration.sheared.record import measured_or_nan
from metafem.calibration.sheared.result import ShearCalibration
from metafem.calibration.verdict import Heterogeneity, heterogeneity
from metafem.errors import InvalidInput
from metafem.notes import Note, information

# Names of the quantities of a point.
NAMES = ("area_before", "area_sheared", "friction_force")

# Excess of B over 1, in standard deviations, above which a note is added: one normal error in a hundred is
# larger.
ABOVE_ONE = 2.33

# Shear strengths [MPa] of soft contacts: hydrogels have 1e-4 MPa, and elastomers less than their moduli.
WEAKEST, STRONGEST = 1e-5, 30.0

# Smallest number of points of a line through the origin: one factor and a residual.
FEWEST = 2

DEFAULT_ERRORS = MeasurementErrors()


def shear(
    area_before: ArrayLike,
    area_sheared: ArrayLike,
    friction_force: ArrayLike,
    *,
    errors: MeasurementErrors = DEFAULT_ERRORS,
    test: Sequence[Any] | None = None,
    bootstrap: Bootstrap | None = None,
) -> ShearCalibration:
    """Fit the area ratio B and the shear strength sigma to sheared contacts, ``Af = B A0``, ``F = sigma Af``.

    Both lines pass through the origin, and all three quantities have errors. The area A0 of each point is an
    unknown of the fit: A0, B A0 and sigma B A0 were measured with independent errors, whose standard
    deviations follow from the fitted values. The sheared area belongs to both lines, which makes B and sigma
    correlated (about -0.3 with the default errors). Separate fits of the two lines have nearly the same
    values and errors, but not this covariance, and the error of sigma B that follows from them is too large.
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, Fig. 2, C and D.

    The static friction force and the area at the same instant, or the sliding ones, may be used.

    Parameters
    ----------
    area_before, area_sheared : array_like, (k,) or (k, n)
        Contact areas A0 before shear and Af at the friction force [mm^2], positive: totals, or areas of n
        contacts, which are added; nan where one was not measured.
    friction_force : array_like, (k,)
        Total friction forces F [N] of these contacts; nan where one was not measured.
    errors : MeasurementErrors
        Standard deviations. The error of a total area is the same for any number of contacts.
    test : sequence, (k,), optional
        Label of the test of each point; default: one test.
    bootstrap : Bootstrap, optional
        Also fit points resampled from those of each test; default: none.

    Returns
    -------
    ShearCalibration

    Raises
    ------
    InvalidInput
        For areas that are not positive, lengths that differ, fewer than two points of a line, and friction
        forces that do not grow with the area.

    Examples
    --------
    >>> before = np.array([0.05, 0.1, 0.2, 0.3])
    >>> found = shear(before, [0.043, 0.085, 0.17, 0.254], [0.0155, 0.0316, 0.0632, 0.0941])
    >>> found
    <ShearCalibration: B = 0.8492 ± 0.0077, sigma = 0.3705 ± 0.006 MPa, 4 points>
    """
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    points = _points(area_before, area_sheared, friction_force)
    names = labels_of(test, points.shape[1])
    known = np.isfinite(points)
    for line, first, second in (("B", 0, 1), ("sigma", 1, 2)):
        number = int((known[first] & known[second]).sum())
        if number < FEWEST:
            both = f"{NAMES[first]} and {NAMES[second]}"
            raise InvalidInput(f"{line} needs at least {FEWEST} points with {both}; there are {number}")
    found = fitted(points, names, errors)
    _refuse_contradiction(found)
    tests = fitted_tests(points, names, errors) if len(set(names)) > 1 else ()
    compared = heterogeneity(tests) if tests else None
    draws = None if bootstrap is None else resampled(points, names, errors, bootstrap)
    notes = tuple(_notes(found, compared))
    return replace(found, tests=tests, heterogeneity=compared, bootstrap=draws, notes=notes)


def _points(*quantities: ArrayLike) -> FloatArray:
    """Return the measured quantities (3, k), areas of several contacts added."""
    columns = [measured_or_nan(name, value) for name, value in zip(NAMES, quantities, strict=True)]
    lengths = {name: len(column) for name, column in zip(NAMES, columns, strict=True)}
    if len(set(lengths.values())) > 1:
        lengths_of = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise InvalidInput(f"{lengths_of} points; all must have the same number")
    return np.stack(columns)


def _refuse_contradiction(found: ShearCalibration) -> None:
    """Refuse a strength that is not positive, and points with a significantly negative slope."""
    if found.shear_strength <= 0.0:
        raise InvalidInput(
            f"friction_force is not positive on the whole: sigma = {found.shear_strength:.4g} MPa; forces "
            "that resist sliding are positive"
        )
    quantities = [getattr(found, name) for name in NAMES]
    for index, verdict in enumerate((found.area_verdict, found.friction_verdict)):
        both = np.stack(quantities[index : index + 2])
        x, y = both[:, np.isfinite(both).all(axis=0)]
        apart = x - x.mean()
        slope = float((apart * y).sum())
        if slope < 0.0 and not verdict.fits:
            slope /= float(apart @ apart)
            raise InvalidInput(
                f"{NAMES[index + 1]} decreases with {NAMES[index]} (slope {slope:.3g}), which "
                f"contradicts {LINES[index]}; check the columns and their units"
            )


def _notes(found: ShearCalibration, compared: Heterogeneity | None) -> Iterator[Note]:
    """Return notes on lines and tests that do not fit, and on points with a missing quantity."""
    for line, verdict in zip(LINES, (found.area_verdict, found.friction_verdict), strict=True):
        if not verdict.law_fits or verdict["largest"].noticed:
            valid = "the stated uncertainties hold only for a law that fits, without outliers"
            yield Note(f"{line}: {verdict}; {valid}")
    yield from found.notes
    ratio, sd = found.area_ratio, np.sqrt(found.covariance[0, 0])
    if ratio > 1.0 + ABOVE_ONE * sd:
        yield Note(
            f"B = {ratio:.4g} is above 1 by {(ratio - 1.0) / sd:.2g} standard deviations, but the areas "
            "of soft contacts shrink under shear; compare area_before and area_sheared, and "
            "check that they are not exchanged"
        )
    yield from _magnitudes(found)
    if compared is not None and not compared.agree:
        yield compared.note()
    unused, count = int(np.isnan(found.area_fitted).sum()), len(found.area_fitted)
    if unused:
        yield information(f"{unused} of {count} points hold less than two quantities and are not used")


def _magnitudes(found: ShearCalibration) -> Iterator[Note]:
    """Return notes on values that only a wrong unit explains."""
    deviations = (found.errors.of_area, found.errors.of_area, found.errors.of_friction_force)
    for name, of in zip(NAMES, deviations, strict=True):
        yield from within_errors(name, getattr(found, name), of(getattr(found, name)))
    ratio, strength = found.area_ratio, found.shear_strength
    if is_off(ratio):
        yield Note(f"B = {ratio:.2g}, but areas change little; {unit_hint(NAMES[1], ratio)}")
    soft = ratio < 1.0 - ABOVE_ONE * math.sqrt(found.covariance[0, 0])
    if strength < WEAKEST or (soft and strength > STRONGEST):
        name = NAMES[2] if STRONGEST < strength < STRONGEST * OFF else NAMES[1]
        large = (strength > STRONGEST) == (name == NAMES[2])
        yield Note(
            f"sigma = {strength:.2g} MPa is outside {WEAKEST:g} to {STRONGEST:g} MPa, the range of soft "
            f"contacts, whose areas shrink under shear; {unit_hint(name, OFF if large else 1.0 / OFF)}"
        )
