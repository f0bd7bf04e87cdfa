"""Tilts of many angles, of unequal radii, and without a solution."""

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
    difference = np.abs(same.slope_sd.values - few.slope_sd.values)
    assert (difference <= few.slope_sd_error.values).all()
    assert "too small" not in few.attrs["notes"]


def test_laws_without_a_solution_are_counted_and_interpolated(surface, monkeypatch):
    areas = mf.Independent.areas

    def failing(self, surface, load, height, radius=None, position=None):
        found = areas(self, surface, load, height, radius, position)
        found[3, 2] = np.nan
        return found

    exact = mf.studies.misalignment(surface, 0.001)
    monkeypatch.setattr(mf.Independent, "areas", failing)
    found = mf.studies.misalignment(surface, 0.001)
    assert found.failed == 1
    np.testing.assert_allclose(found.slope_sd, exact.slope_sd, rtol=1e-5)
    monkeypatch.setattr(mf.Independent, "areas", lambda *given: np.full((2001, 20), np.nan))
    with pytest.raises(mf.NotConverged, match="fewer than two angles"):
        mf.studies.misalignment(surface, 0.001)
