"""Tilts of many angles, and without a solution."""

import numpy as np
import pytest

import metafem as mf

RANGE = (0.02, 0.1)


def test_a_number_is_a_thousand_steps_of_the_source(surface):
    found = mf.studies.misalignment(surface, 0.001, load_range=RANGE)
    assert found.sizes["angle"] == 1000
    few = mf.studies.misalignment(surface, np.linspace(0.0, 0.001, 101)[1:], load_range=RANGE)
    same = found.isel(angle=slice(9, None, 10))
    np.testing.assert_allclose(same["angle"], few["angle"])
    np.testing.assert_allclose(same.slope_sd, few.slope_sd, rtol=0.01)


def test_an_angle_without_a_solution_is_named(surface, monkeypatch):
    areas = mf.Independent.areas

    def failing(*given):
        found = areas(*given)
        found[0, 2] = np.nan
        return found

    monkeypatch.setattr(mf.Independent, "areas", failing)
    with pytest.raises(mf.NotConverged, match=r"at a tilt of -0\.002 rad"):
        mf.studies.misalignment(surface, [0.001, 0.002])
