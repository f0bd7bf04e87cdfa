"""The tables of the kernels against the contact laws that they hold, and areas on a slope."""

import numpy as np
import pytest

import metafem as mf
from metafem._kernels import law as kernel
from metafem.contact.law import area_change
from metafem.models.contact_tables import tables
from validation.methods.bent import Bent

R = 0.526
RHO = np.linspace(0.0, 0.45, 30)
LAWS = [
    *(mf.Elastic(mf.Power(n)) for n in (1.1, 1.5, 4, 32)),
    mf.Elastic(mf.Sphere()),
    mf.Elastic(mf.Profile(lambda rho: rho**2 / 1.1 + rho**4, 0.45)),
]
TABLE = mf.Elastic(mf.Profile(np.array([RHO, R - np.sqrt(R**2 - RHO**2)])))


def test_kernels_are_the_laws():
    for law in (*LAWS, TABLE):
        rtol = 3e-8 if law == TABLE else 1e-9
        table, worst = tables(law, np.array([0.4, R])), 0.0
        one_of = (table.data, table.which[1], R)
        for z in np.geomspace(1e-9, 0.1, 200):
            p, rate, square, widening = kernel.pressed(*one_of, z)
            one = law.contacts(np.array(z), np.array(R))
            own = law.area_slope(one.contact_radius, R) / (np.pi * one.stiffness)
            pairs = [(p, one.load), (rate, one.stiffness), (square, one.contact_radius**2)]
            assert widening == pytest.approx(own, rel=1e4 * rtol)  # a derivative of the profile
            assert kernel.indentation_at_load(*one_of, p) == pytest.approx(z, rel=10 * rtol)
            for k in (0.0, 0.02 / R, 0.5 / R):
                wide, d, bend, _, moment, inside = kernel.bent(*one_of, p, square, widening, k)
                a = np.sqrt(wide)
                assert inside
                curved = Bent(law, k)
                pairs += [
                    (curved.load(a, R), p),
                    (curved.indentation(a, R), d),
                    (curved.second_moment(a, R), 4 * moment),
                ]
                assert bend == pytest.approx(np.sqrt(square) / a, rel=10 * rtol)
                # w = a d^2 - int (D + k s^2)^2 ds, for which dw = d dP
                step = 1e-5 * a
                energies = [kernel.complementary(*one_of, 3, z, s * s, k) for s in (a + step, a - step)]
                work = d * (curved.load(a + step, R) - curved.load(a - step, R))
                assert energies[0] - energies[1] == pytest.approx(work, rel=1e-6)
            worst = max(worst, *(abs(x / y - 1.0) for x, y in pairs))
        assert worst < rtol


def test_laws_continue_as_powers_where_they_are_powers():
    table = tables(mf.Elastic(mf.Power(4)), np.array([1.0]))
    for z in (1e-80, 1e3):
        a = mf.Elastic(mf.Power(4)).contact_radius(z, 1.0)
        assert kernel.load_and_rate(table.data, 0, 1.0, z)[0] == pytest.approx(
            mf.Elastic(mf.Power(4)).load(a, 1.0), rel=1e-11
        )
        assert kernel.covers(table.data, 0, 1.0, z)
    assert not kernel.covers(tables(mf.Elastic(mf.Sphere()), np.array([1.0])).data, 0, 1.0, 5.0)


def test_hertz_needs_no_table():
    table = tables(mf.Hertz(), np.full((2, 3), R))
    assert (table.which < 0).all()
    assert table.data.size == 0


def test_breaks_at_the_ends_of_a_table_make_no_panel():
    d = np.linspace(0.005, 0.3, 20)
    law = mf.TabulatedContact(d, d**1.5, d).for_material(mf.Material(1.0))
    table = tables(law, np.array([R]))
    assert np.isfinite(table.data).all()
    found = kernel.pressed(table.data, 0, R, 0.299)
    assert found[0] == pytest.approx(law.load(law.contact_radius(0.299, R), R), rel=1e-10)


def test_tables_of_a_sphere_reach_to_its_equator():
    law = mf.Elastic(mf.Sphere())
    table = tables(law, np.array([R]))
    one_of = (table.data, table.which[0], R)
    for a in R * np.array([0.9, 0.95, 0.97, 0.98, 0.99, 0.995, 0.998]):
        p, _, square, widening = kernel.pressed(*one_of, float(law.indentation(a, R)))
        for k in (0.0, 0.02 / R, 0.1 / R):
            wide, d, _, _, moment, _ = kernel.bent(*one_of, p, square, widening, k)
            radius, curved = np.sqrt(wide), Bent(law, k)
            assert curved.load(radius, R) == pytest.approx(p, rel=1e-9)
            assert curved.indentation(radius, R) == pytest.approx(d, rel=1e-9)
            assert curved.second_moment(radius, R) == pytest.approx(4 * moment, rel=1e-9)


def test_slopes_change_the_areas_of_powers():
    a = np.array([0.01, 0.2])
    for exponent in (1.1, 1.5, 2.0, 4.0, 8.0):
        law = mf.Elastic(mf.Power(exponent))
        own = law.profile_slope(a, R)
        np.testing.assert_allclose(own, exponent * law.indentation(a, R) / a, rtol=1e-12)
        change = area_change(law, a, R, 0.1 * own)
        np.testing.assert_allclose(change, -0.02 * (exponent - 2.0), atol=1e-12)


def on_slope(law, a, slope):
    """A/(pi a^2) of a contact on a slope, as the kernels compute it."""
    table, own = tables(law, np.array([R])), float(law.profile_slope(a, R))
    return kernel.on_slope(table.data, table.which[0], table.scale[0], a**2, 1.0 / own, slope**2)[0] / a**2


def test_the_kernel_changes_areas_by_the_formula_in_second_order():
    for law in (mf.Elastic(mf.Power(1.5)), mf.Elastic(mf.Power(4)), mf.Elastic(mf.Sphere())):
        a, share = 0.2, 1e-3
        slope = share * float(law.profile_slope(np.array(a), R))
        expected = area_change(law, np.array(a), R, slope)
        # `area_change` takes a difference quotient over a thousandth of the radius
        assert on_slope(law, a, slope) - 1.0 == pytest.approx(expected, rel=2e-3)
