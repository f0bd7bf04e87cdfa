"""The effect of a slope on the area of a contact."""

import numpy as np
import pytest

import metafem as mf
from metafem._kernels.contact.tabulated import on_slope as on_slope_kernel
from metafem.contact.law import area_change
from metafem.models.boundary_elements import patches, solve
from metafem.models.contact_tables import tables

RADIUS = 0.526
LAWS = [mf.PowerCap(1.5), mf.PowerCap(4), mf.SphericalCap()]


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 4.0, 8.0])
def test_powers(exponent):
    law, a = mf.PowerCap(exponent), np.array([0.01, 0.2])
    own = law.profile_slope(a, RADIUS)
    np.testing.assert_allclose(own, exponent * law.indentation(a, RADIUS) / a, rtol=1e-12)
    np.testing.assert_allclose(area_change(law, a, RADIUS, 0.1 * own), -0.02 * (exponent - 2.0), atol=1e-12)


def on_slope(law, a, slope):
    """A/(pi a^2) of a contact on a slope, as the kernels compute it."""
    table, own = tables(law, np.array([RADIUS])), float(law.profile_slope(a, RADIUS))
    return on_slope_kernel(table.data, table.which[0], table.scale[0], a**2, 1.0 / own, slope**2)[0] / a**2


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_the_kernel_changes_areas_by_the_formula_in_second_order(law):
    a, share = 0.2, 1e-3
    slope = share * float(law.profile_slope(np.array(a), RADIUS))
    expected = area_change(law, np.array(a), RADIUS, slope)
    # `area_change` takes a difference quotient over a thousandth of the radius
    assert on_slope(law, a, slope) - 1.0 == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(("share", "error"), [(0.05, 1e-3), (0.3, 0.13)])
@pytest.mark.parametrize("law", LAWS, ids=repr)
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
