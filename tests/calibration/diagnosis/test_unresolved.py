"""Combinations of errors that are not told apart."""

from __future__ import annotations

import numpy as np

from metafem.calibration.diagnosis.causes import Causes
from metafem.calibration.diagnosis.shares import unresolved
from tests.calibration.diagnosis.scenes import COMMON, ERRORS, LOADS, design


def found(gradient: np.ndarray):
    """Return what data with these derivatives by the five errors leave unresolved."""
    causes = Causes.of(design((2, 2)), LOADS, ERRORS.of_load(LOADS), COMMON, True)
    precision = np.eye(causes.size)
    precision[:5, :5] += gradient.T @ gradient
    return unresolved(causes, np.linalg.inv(precision), precision)


def test_a_sum_of_two_errors_leaves_their_difference():
    gradient = np.diag([100.0, 100.0, 100.0, 0.0, 0.0])
    gradient[3, 3:] = 100.0
    (one,) = found(gradient)
    assert set(one.change) == {"composite_modulus", "friction"}
    assert one.change["composite_modulus"] * one.change["friction"] < 0.0
    assert one.variance_left > 0.999


def test_what_is_not_measured_is_named_alone_and_what_is_measured_is_not():
    names = [set(one.change) for one in found(np.diag([0.0, 100.0, 100.0, 100.0, 0.0]))]
    assert names == [{"angle_x"}, {"friction"}]
    assert found(100.0 * np.eye(5)) == ()
