"""Laws do not know units: all lengths times 1e+-3 and all moduli times 1e+-6 scale every result."""

from itertools import product

import numpy as np
import pytest

import metafem as mf
from metafem.models.contact_tables import tables

RADII = np.array([0.3, 0.526])
TABLE = np.geomspace(1e-4, 0.3, 12)
BOWL = np.linspace(0.0, 0.4, 9)

# Every law, for lengths and moduli in other units.
LAWS = {
    "hertz": lambda length, modulus: mf.Hertz(),
    "paraboloid": lambda length, modulus: mf.Elastic(mf.Paraboloid()),
    "power": lambda length, modulus: mf.Elastic(mf.Power(4.0, 0.3)),
    "flat": lambda length, modulus: mf.Elastic(mf.Power(32.0)),
    "pointed": lambda length, modulus: mf.Elastic(mf.Power(1.1)),
    "sphere": lambda length, modulus: mf.Elastic(mf.Sphere()),
    "function": lambda length, modulus: mf.Elastic(
        mf.Profile(lambda rho: rho**2 / length + rho**4 / length**3, 0.4 * length)
    ),
    "table of a profile": lambda length, modulus: mf.Elastic(mf.Profile(length * np.array([BOWL, BOWL**2]))),
    "jkr": lambda length, modulus: mf.JKR(9e-6 * length * modulus),
    "jkr on a power": lambda length, modulus: mf.JKR(9e-6 * length * modulus, mf.Elastic(mf.Power(1.5))),
    "kogut-etsion": lambda length, modulus: mf.KogutEtsion(0.1 * modulus),
    "jackson-green": lambda length, modulus: mf.JacksonGreen(0.03 * modulus),
    "table": lambda length, modulus: mf.TabulatedContact(
        length * TABLE, length**2 * modulus * TABLE**1.4, length**2 * TABLE**0.9
    ),
}


def results(make, length, modulus):
    """Quantities of a law, and the powers of the length with which they grow."""
    law = make(length, modulus).for_material(mf.Material(1.36 * modulus))
    radius, d = length * RADII, length * np.array([0.001, 0.08])
    found = law.contacts(d, radius)
    a = found.contact_radius
    yield 1, a
    yield 1, law.indentation(a, radius)
    yield 2, found.load
    yield 2, found.area
    yield 1, found.stiffness
    yield 1, law.area_slope(a, radius)
    yield 0, law.profile_slope(a, radius)
    yield 1, law.largest_indentation(radius)
    if law.largest_order == 3:
        yield 4, law.second_moment(a, radius)
    if not law.adhesive:
        kept = tables(law, radius)
        yield 0, kept.data[:, :4] if law.similar else kept.data[:, :1]


@pytest.mark.parametrize("name", LAWS)
def test_a_law_scales_with_lengths_and_moduli(name):
    one = list(results(LAWS[name], 1.0, 1.0))
    for length, modulus in product((1e-3, 1e3), (1e-6, 1.0, 1e6)):
        other = list(results(LAWS[name], length, modulus))
        for (power, value), (_, scaled) in zip(one, other, strict=True):
            np.testing.assert_allclose(scaled, length**power * value, rtol=1e-9)
