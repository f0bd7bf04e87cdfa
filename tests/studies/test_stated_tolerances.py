"""Tolerances that studies state do not depend on the errors that are asked for, and are those of draws."""

import numpy as np
import pytest

import metafem as mf

# Errors of the heights [mm] and largest tilts [degrees] that are asked for.
HEIGHT_SD, ANGLE = (1e-3, 3e-3, 1e-2, 3e-2, 1e-1), (0.01, 0.1, 1.0, 10.0, 45.0)


def test_the_largest_errors_of_the_heights_do_not_depend_on_those_studied(linear):
    found = [mf.studies.manufacturing(linear, sd, draws=1024) for sd in (0.0, *HEIGHT_SD)]
    assert len({float(study.largest_height_sd) for study in found}) == 1
    there = mf.studies.manufacturing(linear, float(found[0].largest_height_sd), draws=1024)
    # the search ends within a fifth of the sampling error
    scatter, error = (float(there[name][0] / there.nominal_slope) for name in ("slope_sd", "slope_sd_error"))
    assert scatter == pytest.approx(0.01, abs=0.2 * error)


def test_the_largest_tilt_does_not_depend_on_those_studied(linear):
    found = [mf.studies.misalignment(linear, np.radians(angle)) for angle in ANGLE]
    assert len({float(study.largest_angle) for study in found}) == 1
    there = mf.studies.misalignment(linear, float(found[0].largest_angle))
    assert float(there.slope_sd[0, -1] / there.nominal_slope) == pytest.approx(0.01, rel=1e-3)
