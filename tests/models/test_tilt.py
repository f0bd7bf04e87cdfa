"""The effect of a slope on the area of a contact."""

import numpy as np
import pytest

import metafem as mf
from metafem.contact.law import area_change
from metafem.models.boundary_elements import patches, solve

RADIUS = 0.526


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 4.0, 8.0])
def test_powers(exponent):
    law, a = mf.PowerCap(exponent), np.array([0.01, 0.2])
    own = law.profile_slope(a, RADIUS)
    np.testing.assert_allclose(own, exponent * law.indentation(a, RADIUS) / a, rtol=1e-12)
    np.testing.assert_allclose(area_change(law, a, RADIUS, 0.1 * own), -0.02 * (exponent - 2.0), atol=1e-12)


@pytest.mark.parametrize("law", [mf.PowerCap(1.5), mf.PowerCap(4), mf.SphericalCap()], ids=repr)
def test_resolved_contacts_on_a_slope(law, monkeypatch):
    """The load is that of the contact without a slope; the area by the moments has terms of its own."""
    a, share, cell = 0.2, 0.05, 0.004
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
    # the next term of the slope
    assert area[1] / area[0] - 1.0 == pytest.approx(expected, rel=0.1)
