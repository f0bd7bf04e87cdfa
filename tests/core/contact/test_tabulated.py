"""A law from a table: powers are exact, and other laws converge."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf

RADIUS, MODULUS = 0.526, 1.36
MATERIAL = mf.Material(MODULUS)


def table_of(law, depth, radius=RADIUS):
    """Indentation [mm], load [N] and area [mm^2] of another law."""
    a = law.contact_radius(depth, radius)
    return depth, MODULUS * law.load(a, radius), law.area(a)


@pytest.mark.parametrize("start", [[], [0.0]], ids=["positive", "from zero"])
def test_a_table_of_hertz_is_hertz(start):
    hertz = mf.Hertz()
    d = np.concatenate([start, np.linspace(0.004, 0.1, 12)])
    law = mf.TabulatedContact(*table_of(hertz, d)).for_material(MATERIAL)
    x = np.geomspace(1e-6, 0.1, 200)
    a = hertz.contact_radius(x, RADIUS)
    assert_allclose(law.contact_radius(x, 3.0), a, rtol=1e-6)  # whatever the radius
    assert_allclose(law.indentation(a, RADIUS), x, rtol=1e-6)
    for name in ("load", "stiffness", "area_slope"):
        assert_allclose(getattr(law, name)(a, RADIUS), getattr(hertz, name)(a, RADIUS), rtol=1e-6)
    surface = mf.Surface.square_lattice([0.1, 0.12, 0.15, 0.13], (2, 2), radius=RADIUS, material=MATERIAL)
    load = np.array([0.001, 0.01, 0.03])
    found, expected = (mf.friction_law(surface, mf.Independent(c), load=load) for c in (law, hertz))
    assert_allclose(found.area, expected.area, rtol=1e-6)


def test_rough_tables_increase_with_continuous_slopes():
    rng = np.random.default_rng(7)
    d, load, area = np.cumsum(rng.exponential(1.0, (3, 30)), axis=1) * np.array([[1e-3], [1e-3], [1e-2]])
    law = mf.TabulatedContact(d, load, area).for_material(MATERIAL)
    x = np.geomspace(1e-6, d[-1], 5000)
    a = law.contact_radius(x, RADIUS)
    assert (np.diff(a) > 0.0).all()
    assert (np.diff(law.load(a, RADIUS)) > 0.0).all()
    assert_allclose(law.indentation(a, RADIUS), x, rtol=1e-10)
    inside = law.breaks(RADIUS)[1:-1]
    for name in ("load", "stiffness", "area_slope"):
        low, high = (getattr(law, name)(inside * (1.0 + side), RADIUS) for side in (-1e-12, 1e-12))
        assert_allclose(low, high, rtol=1e-5)  # steep cubics change by more than the distance
    assert_allclose(law.load(law.contact_radius(d, RADIUS), RADIUS), load / MODULUS, rtol=1e-12)


def test_a_table_is_a_value():
    table = table_of(mf.Hertz(), np.linspace(0.0, 0.01, 9))
    law = mf.TabulatedContact(*table)
    assert law == mf.TabulatedContact(*table)
    assert hash(law) == hash(mf.TabulatedContact(*table))
    assert law.for_material(MATERIAL) != law
    assert repr(law) == "TabulatedContact(<8 points>, up to 0.01 mm)"


def test_a_table_of_another_law_converges_with_its_points():
    """Slopes of first to second order, in logarithms, away from the straight line at the first point."""
    law = mf.JacksonGreen(0.01).for_material(MATERIAL)
    ends = law.yield_indentation(RADIUS) * np.array([5.0, 50.0])
    x = np.geomspace(*ends, 500)[100:]
    errors = []
    for count in (9, 17, 33):
        table = mf.TabulatedContact(*table_of(law, np.geomspace(*ends, count))).for_material(MATERIAL)
        loads = (one.load(one.contact_radius(x, RADIUS), RADIUS) for one in (table, law))
        errors.append(abs(next(loads) / next(loads) - 1.0).max())
    assert errors[-1] < 1e-5
    assert np.log2(errors[0] / errors[-1]) / 2 > 1.9
