"""Resolved contacts of caps that are no paraboloids: few cells, finer cells, and slopes."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.boundary_elements import contact_areas
from tests.models.scenes import scene, single_contact


@pytest.mark.parametrize("count", [5])
@pytest.mark.parametrize("exponent", [1.2, 8])
def test_contacts_of_few_cells_keep_the_area_of_their_law(exponent, count):
    """Their edges are not found: the pressure is steep or flat at the axis, some cells from the edge."""
    contact_radius = 0.05
    for offset in np.random.default_rng(count).random((3, 2)):
        state, exact = single_contact(mf.PowerCap(exponent), count, offset, contact_radius)
        missing = abs(state.area - exact.area) / (contact_radius / count) ** 2
        assert missing < 1.25 * (0.37 * np.pi)  # LAWFUL_ERROR


@pytest.mark.parametrize("law", [mf.PowerCap(4), mf.SphericalCap()], ids=repr)
def test_the_error_falls_as_the_square_of_the_cell(law):
    counts = np.array([12, 24, 48])
    found = [single_contact(law, n) for n in counts]
    for name, least in (("load", 1.8), ("area", 1.5)):  # the sum over the edge scatters
        errors = [abs(getattr(s, name) / getattr(e, name) - 1.0) for s, e in found]
        assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] > least


def test_areas_from_moments_are_those_within_the_edges_on_a_slope(monkeypatch):
    """A neighbour's field has a slope, by which the area and the second moments change."""
    law = mf.PowerCap(4)
    surface = scene([[0.0, 0.0], [0.7, 0.3]], [0.1, 0.1], 0.526)
    model, approach = mf.BoundaryElements(0.003, contact=law), float(law.indentation(0.19, 0.526))
    state = mf.equilibrium(surface, model, approach=approach)
    assert not any("not that of" in note.text for note in state.notes)
    monkeypatch.setattr(contact_areas, "OTHER_CAPS", -1.0)
    edges = mf.equilibrium(surface, model, approach=approach)
    # without the terms of the slope 1.4e-4 and 2.2e-4
    assert state.area == pytest.approx(edges.area, rel=1e-4)
