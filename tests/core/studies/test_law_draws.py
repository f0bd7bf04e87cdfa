"""The interpolated area against that of the models."""

import numpy as np
import pytest

import metafem as mf
from metafem.studies.uncertainty import LOADS, tabulated


def response_of(surface, model, radius_sd):
    """The response up to P/E* = 0.3 mm^2."""
    sd = {"radius": np.array([radius_sd * 0.526])}
    return tabulated(surface, model, sd, 0.3 * 1.36 * np.sqrt(1.0 - 5.0 * radius_sd))


@pytest.mark.parametrize(
    # the largest errors occur at the entry of a contact between two loads of the table
    ("model", "largest", "usual"),
    [(mf.Independent(), 1e-4, 1e-7), (mf.Interacting(substrate=mf.BondedLayer()), 5e-3, 1e-6)],
)
def test_the_area_is_that_of_the_model(surface, model, largest, usual):
    response = response_of(surface, model, 0.01)
    load = np.linspace(0.01, 0.28, 40)
    for factor in (0.975, 1.0, 1.015):
        area = model.areas(surface, load, surface.height[None], factor * surface.radius[None])[0]
        error = np.abs(response(load, np.full(40, factor)) / area - 1.0)
        assert error.max() <= largest
        assert np.median(error) <= usual


def test_there_is_no_area_without_load(surface):
    response = response_of(surface, mf.Independent(), 0.0)
    np.testing.assert_array_equal(response(np.array([-0.1, 0.0]), np.ones(2)), 0.0)


def test_a_load_without_solution_is_named(surface, monkeypatch):
    monkeypatch.setattr(mf.Interacting, "areas", lambda *given: np.full((1, LOADS), np.nan))
    with pytest.raises(mf.NotConverged, match="no solution at the rescaled load"):
        response_of(surface, mf.Interacting(), 0.01)
