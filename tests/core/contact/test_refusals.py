"""Refused values of the contact laws."""

import numpy as np
import pytest

import metafem as mf
from metafem.caps.shapes import sphere_profile
from metafem.contact import pedestal
from tests.refusals import faults

RADIUS = 0.526
MATERIAL = mf.Material(1.36)
FLAT = mf.Surface.square_lattice(np.full(4, 0.1), (2, 2), radius=RADIUS, material=MATERIAL)
HERTZ = np.linspace(0.001, 0.01, 9)
TABLE = mf.TabulatedContact(HERTZ, HERTZ**1.5, HERTZ).for_material(MATERIAL)
LOWEST = [1e-3, 2e-3, 3e-3]


def sphere(rho):
    return sphere_profile(rho, RADIUS)


def quartic(extent):
    return mf.Elastic(mf.Profile(lambda rho: rho**4 / (2.0 * RADIUS**3), extent))


def profile(rho, f, extent=None):
    return lambda: mf.Elastic(mf.Profile([rho, f], extent))


NARROW, WEAK = mf.Elastic(mf.Profile(sphere, 0.1)), mf.JKR(9e-6, quartic(0.05)).for_material(MATERIAL)
REFUSALS = [
    (lambda: mf.Elastic(mf.Power(0.5)), "exponent", "0.5"),
    (lambda: mf.Elastic(mf.Power(40)), "exponent", "40"),
    (lambda: mf.Elastic(mf.Power(4, 0.0)), "coefficient", "0"),
    (lambda: mf.JKR(-1e-6), "adhesion_energy", "-1e-06"),
    (lambda: mf.JKR(1e-6, mf.JKR(1e-6)), "cap", "JKR("),
    (lambda: mf.JKR(1e-6, mf.KogutEtsion(0.1)), "cap", "KogutEtsion("),
    (lambda: mf.JKR(9e-6).load(0.1, RADIUS), "JKR(", "material"),
    (lambda: WEAK.zero_load_radius(RADIUS), "adhesion_energy", "9e-06"),
    (lambda: mf.KogutEtsion(0.1).contact_radius(0.1, RADIUS), "KogutEtsion(", "material"),
    (lambda: mf.KogutEtsion(0.0), "hardness", "0"),
    (lambda: mf.JacksonGreen(-1.0), "yield_strength", "-1"),
    (lambda: mf.KogutEtsion(0.002).for_material(MATERIAL), "hardness = 0.002", "0.003427"),
    (lambda: mf.JacksonGreen(0.001).for_material(MATERIAL), "yield_strength", "0.001"),
    (lambda: mf.Elastic().load(0.1, RADIUS), "Elastic()", "caps"),
    (lambda: mf.Elastic(mf.Hertz()), "cap", "Hertz()"),
    (lambda: mf.Elastic(mf.Sphere()).load(RADIUS, RADIUS), "contact_radius", "0.526"),
    (lambda: mf.Elastic(mf.Sphere()).contact_radius(20.0, 0.4), "indentation", "1.621"),
    (lambda: mf.Elastic(mf.Profile(sphere)), "extent", "function"),
    (lambda: mf.Elastic(mf.Profile(sphere, -0.1)), "extent", "-0.1"),
    (lambda: mf.Elastic(mf.Profile(sphere, 0.5)).load(0.1, RADIUS), "profile", "extent"),
    (lambda: mf.Elastic(mf.Profile(lambda _: 0.01, 0.3)).load(0.1, RADIUS), "function", "arrays"),
    (profile([0.0, 0.1, 0.1], [0.0, 1.0, 2.0]), "rho", "0.1"),
    (profile([0.0, 0.1, 0.2], [0.0, 0.02, 0.01]), "f", "0.02"),
    (profile([0.0, 0.1], [0.0, 0.01]), "rho", "3"),
    (lambda: mf.Elastic(mf.Profile([0.0, 0.1], 0.1)), "profile", "(2,)"),
    (profile([0.0, 0.1, 0.2], [0.0, 0.01, 0.02], 0.3), "extent", "0.2"),
    (lambda: NARROW.contact_radius(0.1, RADIUS), "indentation", "0.1"),
    (lambda: NARROW.load(0.2, RADIUS), "contact_radius", "0.2"),
    (lambda: mf.TabulatedContact(LOWEST, [1, 2, 3], [1, 2]), "area", "2"),
    (lambda: mf.TabulatedContact([0, 1e-3, 2e-3], [0, 1, 2], [0, 1, 2]), "indentation", "2"),
    (lambda: mf.TabulatedContact([0, 1e-3, 2e-3], [0.1, 1, 2], [0, 1, 2]), "indentation[0]", "0"),
    (lambda: mf.TabulatedContact(LOWEST, [1, 3, 2], [1, 2, 3]), "load[2]", "2"),
    (lambda: mf.TabulatedContact(HERTZ, HERTZ, HERTZ).load(0.01, RADIUS), "Tabulated", "material"),
    (lambda: TABLE.contact_radius(0.02, RADIUS), "indentation", "0.02"),
    (lambda: mf.friction_law(FLAT, mf.Independent(TABLE), load=[0.1]), "load", "0.01"),
    (lambda: pedestal.pedestal_compliance(0.01, 1.0), "height/radius", "0.05"),
    (lambda: pedestal.pedestal_compliance(0.7, 1.0), "height/radius", "0.6"),
    (lambda: pedestal.pedestal_compliance(0.2, 1.0, -0.1), "contact_radius", "0"),
    (lambda: pedestal.pedestal_compliance(0.2, 1.0, 0.5), "contact_radius", "foot"),
]


@pytest.mark.parametrize(("call", "key", "value"), REFUSALS)
def test_refusals(call, key, value):
    assert faults([(call, key, value)]) == []
