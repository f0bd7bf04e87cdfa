"""Coupled Hertz contacts by Newton's method, against closed forms."""

import numpy as np
import pytest

from metafem.reference import bonded_layer
from validation.methods.contact_equations import area, coupled, independent, layer_influence, loads

RADIUS = 0.526
HEIGHT = np.array([0.2, 0.17, 0.1, 0.02])


def test_independent_contacts_carry_the_load():
    depth, separation = independent(HEIGHT, RADIUS, 0.05)
    assert depth == pytest.approx(HEIGHT - separation)
    assert loads(depth, RADIUS).sum() == pytest.approx(0.05, rel=1e-12)


def test_without_influence_the_contacts_are_independent():
    depth, separation = coupled(HEIGHT, RADIUS, np.zeros((4, 4)), 0.05)
    expected, plane = independent(HEIGHT, RADIUS, 0.05)
    assert depth == pytest.approx(expected, abs=1e-13)
    assert separation == pytest.approx(plane, abs=1e-13)
    assert area(depth, RADIUS) == pytest.approx(np.pi * RADIUS * expected[expected > 0.0].sum(), rel=1e-12)


def test_a_constant_in_the_influence_lowers_the_plane_and_changes_nothing_else():
    depth, separation = coupled(HEIGHT, RADIUS, np.full((4, 4), 0.3), 0.05)
    expected, plane = independent(HEIGHT, RADIUS, 0.05)
    assert depth == pytest.approx(expected, abs=1e-13)
    assert separation == pytest.approx(plane - 0.3 * 0.05, abs=1e-13)


def test_layer_influence_is_the_closed_form_of_each_pair():
    position = np.array([[0.0, 0.0], [1.5, 0.0], [0.0, 2.0]])
    found = layer_influence(position, 7.2, 0.5)
    assert found[0, 1] == pytest.approx(float(bonded_layer.influence(1.5, 7.2, 0.5)), rel=1e-12)
    assert (
        found[1, 2] == found[2, 1] == pytest.approx(float(bonded_layer.influence(2.5, 7.2, 0.5)), rel=1e-12)
    )
    assert found[2, 2] == pytest.approx(float(bonded_layer.regular_influence(0.0, 7.2, 0.5)), rel=1e-12)
