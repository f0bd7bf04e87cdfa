"""Resolved contacts on a slope."""

import numpy as np
import pytest

import metafem as mf
from metafem.contact.law import area_change
from metafem.models.boundary_elements import patches, solve
from tests.core.models.test_tilt import LAWS, RADIUS, on_slope


@pytest.mark.parametrize(("share", "error"), [(0.05, 1e-3), (0.3, 0.13)])
@pytest.mark.parametrize("law", LAWS[:2], ids=repr)
def test_resolved_contacts_on_a_slope(law, share, error, monkeypatch):
    """The load is that of the contact without a slope; the area by the moments has terms of its own."""
    a, cell = 0.2, 0.004
    slope = share * float(law.profile_slope(np.array(a), RADIUS))
    flat = patches.patch

    def tilted(*arguments):
        patch = flat(*arguments)
        patch.gap[...] += slope * (patch.corner[0] + np.arange(len(patch.gap)))[:, None]
        return patch

    load, depth = float(law.load(a, RADIUS)), float(law.indentation(a, RADIUS))
    surface = mf.Surface([[0.0, 0.0]], [0.0], RADIUS, mf.Material(1.0))
    area = []
    for lay in (flat, tilted):
        monkeypatch.setattr(solve, "patch", lay)
        scene = solve.Scene(surface, cell, mf.HalfSpace(), law)
        area.append(scene.solve(scene.initial_guess(depth, by_load=False), load).contacts.area[0])
    expected = area_change(law, np.array(a), RADIUS, slope)
    if share == 0.05:  # the next term of the slope
        assert area[1] / area[0] - 1.0 == pytest.approx(expected, rel=0.1)
    assert area[1] / area[0] == pytest.approx(on_slope(law, a, slope), rel=error)
