"""Adhesive caps against closed forms and the energy of a contact."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.contact import Contact

RADIUS, MODULUS, ENERGY = 0.526, 1.36, 9e-6
MATERIAL = mf.Material(MODULUS)
POWERS = [mf.Elastic(mf.Power(n)) for n in (1.5,)]
PROFILE = mf.Elastic(mf.Profile(lambda rho: rho**4 / (2.0 * RADIUS**3), 0.4))
CAPS = [mf.Hertz(), *POWERS, mf.Elastic(mf.Sphere()), PROFILE]
QUANTITIES = ("indentation", "load", "stiffness", "area_slope")


def bound(cap=None, energy=ENERGY):
    return mf.JKR(energy, cap or mf.Hertz()).for_material(MATERIAL)


def test_the_closed_form_of_a_paraboloid():
    """a(P) and d(a) as Johnson, Kendall and Roberts print them, in N and MPa."""
    unit = math.pi * ENERGY * RADIUS
    load = unit * np.concatenate([np.linspace(-1.49, 10.0, 40), np.geomspace(10.0, 1e6, 40)])
    root = np.sqrt(6.0 * unit * load + (3.0 * unit) ** 2)
    a = np.cbrt(0.75 * RADIUS / MODULUS * (load + 3.0 * unit + root))
    law = bound()
    assert_allclose(MODULUS * law.load(a, RADIUS), load, rtol=1e-12, atol=1e-12 * unit)
    d = a**2 / RADIUS - np.sqrt(2.0 * math.pi * ENERGY * a / MODULUS)
    assert_allclose(law.indentation(a, RADIUS), d, rtol=1e-12)
    assert_allclose(law.contact_radius(d[d > 0.0], RADIUS), a[d > 0.0], rtol=1e-12)
    assert law.contact_radius(-1e-9, RADIUS) == 0.0


def test_contact_radii_of_a_paraboloid_are_exact_at_all_indentations():
    """d(a) returns the indentation, from a millionth to a million times that of the jump's length."""
    for energy in (1e-12, 1e-2):
        law = bound(energy=energy)
        length = np.cbrt(law.length**2 * RADIUS)
        d = length * np.append(0.0, np.geomspace(1e-12, 1e9, 400))
        a = law.contact_radius(d, RADIUS)
        rounding = 1e-14 * (d + law.deficit(a))
        assert (np.abs(law.indentation(a, RADIUS) - d) <= rounding).all()
        q = np.sqrt(2.0 * math.pi * law.length) / (1.0 / RADIUS)
        assert_allclose(a[0], np.cbrt(q) ** 2, rtol=1e-14)


def test_pull_off_of_a_paraboloid():
    law = bound()
    a = law.pull_off_radius([RADIUS, 2.0 * RADIUS])
    assert_allclose(a[0], (9.0 / 8.0 * math.pi * ENERGY / MODULUS * RADIUS**2) ** (1 / 3), rtol=1e-12)
    assert_allclose(MODULUS * law.load(a, RADIUS * np.array([1, 2])), -1.5 * math.pi * ENERGY * RADIUS
                    * np.array([1, 2]), rtol=1e-12)  # fmt: skip
    at_rest = (6.0 * math.pi * ENERGY * RADIUS**2 * 0.75 / MODULUS) ** (1 / 3)
    assert law.zero_load_radius(RADIUS) == pytest.approx(at_rest, rel=1e-12)


def test_branches_and_their_ends():
    for cap in CAPS:
        law = bound(cap)
        d = np.array([0.0, 1e-9, 1e-3, 0.009])
        a = law.contact_radius(d, RADIUS)
        assert_allclose(law.indentation(a, RADIUS), d, atol=1e-12 * d[-1])
        end = law.pull_off_radius(RADIUS)
        near = law.load(end * np.array([1 - 1e-4, 1.0, 1 + 1e-4]), RADIUS)
        assert near[1] == near.min() < 0.0
        assert law.stiffness(end, RADIUS) == pytest.approx(0.0, abs=1e-8 * end)
        rest = law.zero_load_radius(RADIUS)
        assert rest > end
        assert law.load(rest, RADIUS) == pytest.approx(0.0, abs=1e-12 * abs(near[1]))


def test_without_adhesion_the_law_is_that_of_the_cap():
    for cap in CAPS:
        assert mf.JKR(0.0, cap).for_material(MATERIAL) is cap
        a = np.array([0.0, 0.05, 0.1, 0.2])
        faint = bound(cap, 1e-28)
        for law in (faint, mf.JKR(0.0, cap, MATERIAL)):
            for name in QUANTITIES:
                found, expected = (getattr(one, name)(a, RADIUS) for one in (law, cap))
                assert_allclose(found, expected, rtol=1e-9)
            d = cap.indentation(a[1:], RADIUS)
            assert_allclose(law.contact_radius(d, RADIUS), a[1:], rtol=1e-9)


@pytest.mark.parametrize(
    ("cap", "energy"), [*((cap, ENERGY) for cap in CAPS), (mf.Elastic(mf.Sphere()), 0.0)]
)
def test_the_energy_of_a_contact(cap, energy):
    """U = int_0^a (d - d_cap(s))^2 ds - pi w a^2 is stationary at a, and dU/dd = P."""
    law = mf.JKR(energy, cap, MATERIAL)
    x, weight = np.polynomial.legendre.leggauss(60)
    a, w = 0.2, energy / MODULUS
    d = float(law.indentation(a, RADIUS))

    def value(depth, radius):
        # s = a t^2, in which fractional powers of s are smoother
        t = 0.5 * (x + 1.0)
        rest = depth - cap.indentation(radius * t**2, RADIUS)
        return float(0.5 * weight @ (rest**2 * 2.0 * radius * t)) - math.pi * w * radius**2

    load = law.load(a, RADIUS)
    scale = cap.load(a, RADIUS) * d / a
    assert derivative(lambda b: value(d, b), a, 1e-4 * a) == pytest.approx(0.0, abs=1e-7 * scale)
    assert derivative(lambda e: value(e, a), d, 1e-2 * d) == pytest.approx(load, rel=1e-7)
    slope = derivative(lambda b: law.load(b, RADIUS), a, 1e-4 * a)
    slope /= derivative(lambda b: law.indentation(b, RADIUS), a, 1e-4 * a)
    assert law.stiffness(a, RADIUS) == pytest.approx(slope, rel=1e-7)
    area = derivative(lambda e: law.area(law.contact_radius(e, RADIUS)), d, 1e-3 * d)
    assert law.area_slope(a, RADIUS) == pytest.approx(area, rel=1e-7)


def derivative(function, at, by):
    near, far = ((function(at + s) - function(at - s)) / (2.0 * s) for s in (by, 2.0 * by))
    return (4.0 * near - far) / 3.0


def test_a_law_belongs_to_its_first_material():
    law = mf.JKR(ENERGY)
    assert isinstance(law, Contact)
    assert law.adhesive
    assert repr(law) == repr(bound()) == "JKR(adhesion_energy=9e-06, cap=Hertz())"
    assert str(mf.JKR(ENERGY, mf.Elastic())) == f"{law}, Elastic()" == "JKR, w = 9 mJ/m^2, Elastic()"
    assert bound().for_material(mf.Material(2.0)) == bound()


def test_the_largest_indentation_is_that_at_the_extent():
    law = bound(mf.Elastic(mf.Profile(lambda rho: rho**4 / (2.0 * RADIUS**3), 0.05)))
    most = law.largest_indentation(np.full(2, RADIUS))
    assert_allclose(most, law.indentation(0.05, RADIUS), rtol=1e-12)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_contact_of_a_profile_is_that_of_its_paraboloid_in_all_units(scale):
    """The profile ends at an indentation of 5.6 mm times the scale, far from the contact."""
    law = mf.JKR(5e-5 * scale).for_material(mf.Material(1e-3))
    cap = mf.Elastic(mf.Profile(lambda rho: rho**2 / (40.0 * scale), 15.0 * scale))
    profile = mf.JKR(5e-5 * scale, cap).for_material(mf.Material(1e-3))
    d = scale * np.array([0.0, 0.3, 1.0, 2.0])
    expected = law.contact_radius(d, 20.0 * scale)
    assert_allclose(profile.contact_radius(d, 20.0 * scale), expected, rtol=1e-9)
