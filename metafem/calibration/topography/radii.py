"""One radius for all caps: the estimates of the others under it."""

from __future__ import annotations

from metafem._validate import FloatArray


def pooled(value: FloatArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (x, y, height, radius) of caps (n, 4) and their covariance (n, 4, 4) under one common radius.

    The radius is the mean weighted by the inverse variances. The others follow by their regression on it:
    ``v - C_vR / C_RR (R_i - R)``, and lose the variance that they owe to the error of their own radius.
    """
    variance = covariance[:, 3, 3]
    common = float((value[:, 3] / variance).sum() / (1.0 / variance).sum())
    own = 1.0 / float((1.0 / variance).sum())
    slope = covariance[:, :, 3] / variance[:, None]
    result = value - slope * (value[:, 3] - common)[:, None]
    outer = slope[:, :, None] * slope[:, None, :]
    return result, covariance - outer * variance[:, None, None] + outer * own
