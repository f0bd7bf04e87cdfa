"""Fits of the two lines of sheared contacts: all points, single tests, and resampled points."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.calibration.resampling import Bootstrap
from metafem.calibration.serial_correlation import Succession
from metafem.calibration.sheared.proportional import proportional
from metafem.calibration.sheared.result import ShearCalibration
from metafem.calibration.verdict import SingleTest, Verdict, errors_of, judged_in_order
from metafem.notes import Note

# The two lines: sheared area over area before shear, and friction force over sheared area.
LINES = ("Af = B A0", "F = sigma Af")

# Number of points of the bootstrap that are fitted at once.
AT_ONCE = 200_000


def parameters(points: FloatArray, errors: MeasurementErrors) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return B and sigma (..., 2), their covariance (..., 2, 2) and A0 (..., k) from points (..., 3, k)."""
    deviation = (errors.of_area, errors.of_area, errors.of_friction_force)
    factor, covariance, value = proportional(points, deviation)
    ratio, strength = factor[..., 0], factor[..., 1] / factor[..., 0]  # the second factor is sigma B
    jacobian = np.zeros_like(covariance)
    jacobian[..., 0, 0] = 1.0
    jacobian[..., 1, 0], jacobian[..., 1, 1] = -strength / ratio, 1.0 / ratio
    covariance = jacobian @ covariance @ np.swapaxes(jacobian, -1, -2)
    # symmetric to the last bit
    covariance = 0.5 * (covariance + np.swapaxes(covariance, -1, -2))
    return np.stack([ratio, strength], axis=-1), covariance, value


def fitted(points: FloatArray, test: Sequence[str], errors: MeasurementErrors) -> ShearCalibration:
    """Fit points (3, k); points with a single quantity have no fitted value."""
    used = np.isfinite(points).sum(axis=0) >= 2
    value = np.full(points.shape[1], np.nan)
    found, covariance, value[used] = parameters(points[:, used], errors)
    ratio, strength = found
    before, sheared, force = points
    before_sd, sheared_sd = errors.of_area(value), errors.of_area(ratio * value)
    force_sd = errors.of_friction_force(strength * ratio * value)
    scale = np.hypot(sheared_sd, ratio * before_sd), np.hypot(force_sd, strength * sheared_sd)
    residual = (sheared - ratio * before) / scale[0], (force - strength * sheared) / scale[1]
    verdicts: list[Verdict] = []
    notes: list[Note] = []
    factor = np.ones(2)
    for i, regressor in enumerate((value / scale[0], ratio * value / scale[1])):
        known = np.isfinite(residual[i])
        measured = Succession(np.array(test)[known], regressor[known, None])
        verdict = judged_in_order(residual[i][known], value[known], measured)
        rho, more = errors_of(verdict, measured, LINES[i])
        factor[i] = math.sqrt(measured.covariance(rho)[0, 0] / measured.covariance(0.0)[0, 0])
        verdicts.append(verdict)
        notes += more
    covariance = covariance * np.outer(factor, factor)
    return ShearCalibration(
        area_ratio=float(ratio),
        shear_strength=float(strength),
        covariance=covariance,
        area_before=before,
        area_sheared=sheared,
        friction_force=force,
        area_fitted=value,
        area_residual=residual[0],
        friction_residual=residual[1],
        area_verdict=verdicts[0],
        friction_verdict=verdicts[1],
        errors=errors,
        notes=tuple(notes),
    )


def fitted_tests(
    points: FloatArray, test: Sequence[str], errors: MeasurementErrors
) -> tuple[SingleTest, ...]:
    """Return the fit of each test."""
    own = {name: points[:, np.array([each == name for each in test])] for name in dict.fromkeys(test)}
    return tuple(SingleTest(name, part.shape[1], *_of_known(part, errors)) for name, part in own.items())


def _of_known(points: FloatArray, errors: MeasurementErrors) -> tuple[FloatArray, FloatArray]:
    """Return B and sigma with their covariance, nan for a line without points."""
    known = np.isfinite(points)
    of_ratio, of_strength = (known[0] & known[1]).any(), (known[1] & known[2]).any()
    value, covariance = np.full(2, np.nan), np.full((2, 2), np.nan)
    if of_ratio and of_strength:
        value, covariance, _ = parameters(points[:, known.sum(axis=0) >= 2], errors)
    elif of_ratio or of_strength:
        rows, index = (slice(0, 2), 0) if of_ratio else (slice(1, 3), 1)
        deviation = (errors.of_area, errors.of_area if of_ratio else errors.of_friction_force)
        pair = points[rows][:, known[rows].all(axis=0)]
        factor, square, _ = proportional(pair, deviation)
        value[index], covariance[index, index] = factor[0], square[0, 0]
    return value, covariance


def resampled(
    points: FloatArray, test: Sequence[str], errors: MeasurementErrors, bootstrap: Bootstrap
) -> FloatArray:
    """Return B and sigma (draws, 2) of points that are drawn with replacement from each group.

    The points of a group have the same test and the same measured quantities, so that each draw has the same
    number of points on each line.
    """
    known = np.isfinite(points)
    used = np.flatnonzero(known.sum(axis=0) >= 2)
    group = [(test[i], *known[:, i].tolist()) for i in used.tolist()]
    drawn = bootstrap.rows(group, AT_ONCE // len(used))
    return np.concatenate([parameters(points[:, used[rows]].transpose(1, 0, 2), errors)[0] for rows in drawn])
