"""Two elliptic contacts of least energy: the limits of one contact and of point loads, and the quadrature."""

import numpy as np
import pytest

from metafem.reference.single_contacts import hertz
from validation.methods import two_contacts

RADIUS, APPROACH = 0.526, 0.1
WIDE = np.sqrt(RADIUS * APPROACH)
ALONE = hertz(WIDE, RADIUS)[0]


def test_distant_contacts_are_hertzs():
    load, area = two_contacts.pair(APPROACH, RADIUS, 1e7)
    assert load == pytest.approx(2.0 * ALONE, rel=1e-6)
    assert area == pytest.approx(2.0 * np.pi * WIDE**2, rel=1e-6)


def test_the_first_effect_is_that_of_a_point_load():
    # each is lowered by P/(π r), and its load falls by 3/2 of the relative indentation
    for distance in (50.0, 100.0):
        load, _ = two_contacts.pair(APPROACH, RADIUS, distance)
        lost = 1.0 - load / (2.0 * ALONE)
        assert lost == pytest.approx(1.5 * ALONE / (np.pi * distance * APPROACH), rel=2.0 * WIDE / distance)


def test_units_do_not_matter_and_more_points_change_nothing(monkeypatch):
    load, area = two_contacts.pair(APPROACH, RADIUS, 0.7)
    other = two_contacts.pair(1e3 * APPROACH, 1e3 * RADIUS, 700.0)
    assert other == pytest.approx((1e6 * load, 1e6 * area), rel=1e-6)
    monkeypatch.setattr(two_contacts, "RADIAL", 14)
    monkeypatch.setattr(two_contacts, "ANGLES", 40)
    assert two_contacts.pair(APPROACH, RADIUS, 0.7) == pytest.approx((load, area), rel=1e-6)
