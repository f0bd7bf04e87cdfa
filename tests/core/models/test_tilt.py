"""The effect of a slope on the area of a contact."""

import numpy as np
import pytest

import metafem as mf
from metafem._kernels.contact.tabulated import on_slope as on_slope_kernel
from metafem.contact.law import area_change
from metafem.models.contact_tables import tables

RADIUS = 0.526
LAWS = [mf.PowerCap(1.5), mf.PowerCap(4), mf.SphericalCap()]


def test_powers():
    a = np.array([0.01, 0.2])
    for exponent in (1.0, 1.5, 2.0, 4.0, 8.0):
        law = mf.PowerCap(exponent)
        own = law.profile_slope(a, RADIUS)
        np.testing.assert_allclose(own, exponent * law.indentation(a, RADIUS) / a, rtol=1e-12)
        change = area_change(law, a, RADIUS, 0.1 * own)
        np.testing.assert_allclose(change, -0.02 * (exponent - 2.0), atol=1e-12)


def on_slope(law, a, slope):
    """A/(pi a^2) of a contact on a slope, as the kernels compute it."""
    table, own = tables(law, np.array([RADIUS])), float(law.profile_slope(a, RADIUS))
    return on_slope_kernel(table.data, table.which[0], table.scale[0], a**2, 1.0 / own, slope**2)[0] / a**2


def test_the_kernel_changes_areas_by_the_formula_in_second_order():
    for law in LAWS:
        a, share = 0.2, 1e-3
        slope = share * float(law.profile_slope(np.array(a), RADIUS))
        expected = area_change(law, np.array(a), RADIUS, slope)
        # `area_change` takes a difference quotient over a thousandth of the radius
        assert on_slope(law, a, slope) - 1.0 == pytest.approx(expected, rel=2e-3)
