"""Mean and deviation of a function of an angle that is uniform in an interval around zero."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray
from metafem.studies.sampling.moments import Estimate

# Neighbouring angles on each side whose errors count, too.
NEIGHBOURS = 2


def within(angle: FloatArray, value: FloatArray) -> tuple[Estimate, Estimate]:
    """Return mean and standard deviation over [-angle, angle], each with its error, (..., k).

    angle: (2 k + 1,), increasing, from minus the largest to the largest, with 0. value: (..., 2 k + 1).
    The error is the change with every second angle, counted from each end.
    """
    middle = len(angle) // 2
    fine = _uniform(angle, value)
    coarse = tuple(np.empty_like(part) for part in fine)
    for odd in (0, 1):
        # every second angle, among them 0 (odd = 0) or not
        some = slice((middle - odd) % 2, None, 2)
        for whole, part in zip(coarse, _uniform(angle[some], value[..., some]), strict=True):
            whole[..., 1 - odd :: 2] = part
    mean, sd = (
        Estimate(one, _largest_nearby(np.abs(one - other))) for one, other in zip(fine, coarse, strict=True)
    )
    return mean, sd


def _largest_nearby(change: FloatArray) -> FloatArray:
    """Return the largest value at an angle and its neighbours: a change may cross zero at a single angle."""
    padded = np.pad(change, [(0, 0)] * (change.ndim - 1) + [(NEIGHBOURS, NEIGHBOURS)], mode="edge")
    nearby = np.lib.stride_tricks.sliding_window_view(padded, 2 * NEIGHBOURS + 1, axis=-1)
    return np.asarray(nearby.max(axis=-1))


def _uniform(angle: FloatArray, value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation over [-angle, angle] of values that are linear between angles."""
    centre = value[..., [len(angle) // 2]]  # the digits of small deviations
    left, right = value[..., :-1] - centre, value[..., 1:] - centre
    width = np.diff(angle)
    kept = len(angle) // 2
    moments = []
    for integral in (width * (left + right) / 2.0, width * (left**2 + left * right + right**2) / 3.0):
        both = (integral + integral[..., ::-1])[..., -kept:]
        if len(width) % 2:
            both[..., 0] /= 2.0  # the interval across 0 is its own mirror image
        moments.append(np.cumsum(both, axis=-1) / (2.0 * angle[-kept:]))
    mean, square = moments
    return mean + centre, np.sqrt(np.maximum(square - mean**2, 0.0))
