"""Tables of single contacts and their sums, against closed forms."""

import numpy as np
import pytest

from metafem.reference import single_contacts as exact
from validation.methods import independent
from validation.methods.tabulated_contacts import adhesive, areas, sphere

RADIUS = 0.526


def test_equal_adhesive_contacts_share_the_load():
    energy, modulus, load, count = 9e-6, 1.36, np.array([0.01, 0.1, 0.5]), 5
    table = adhesive(energy, modulus, RADIUS, 0.5)
    one = [np.pi * exact.jkr_contact_radius(p / count, RADIUS, energy / modulus) ** 2 for p in load]
    assert areas(table, np.full(count, 0.2), load) == pytest.approx(count * np.array(one), rel=1e-6)


def test_sphere_is_sneddons():
    table = sphere(RADIUS, 0.45)
    a = np.sqrt(table.area / np.pi)
    for i in (10_000, 200_000):
        load, indentation = exact.sneddon_sphere(a[i], RADIUS)
        assert (table.load[i], table.indentation[i]) == pytest.approx((load, indentation), rel=1e-12)


def test_weak_adhesion_is_hertz():
    height, load = np.array([0.3, 0.28, 0.21]), np.linspace(0.05, 0.3, 4)
    table = adhesive(1e-16, 1.0, RADIUS, 0.5)
    expected = independent.areas(height, load, RADIUS)
    assert areas(table, height, load) == pytest.approx(expected, rel=2e-6)


def test_a_load_beyond_the_table_is_refused():
    with pytest.raises(ValueError, match="exceeds that of the table"):
        areas(sphere(RADIUS, 0.1), [0.1], [1.0])
