"""Conductance against Barber's identity, discs in parallel and resolved contacts."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from validation.fidelity.order3_against_resolved import irregular as irregular_scene
from validation.scenes.quantities import exact_stiffness

LOADS = np.array([0.01, 0.05, 0.1, 0.3])


@pytest.fixture
def irregular():
    return irregular_scene().surface


def test_barbers_identity_without_interaction(irregular):
    """The tables of laws other than Hertz's resolve the stiffness to 1e-13."""
    for model in [mf.Independent(), mf.Independent(mf.PowerCap(4))]:
        found = mf.conductance(irregular, model, load=LOADS, resistivity=1.0).rescaled_conductance
        assert_allclose(found, model.curve(irregular, LOADS).stiffness, rtol=1e-12)


def test_barbers_identity_with_interaction(irregular):
    """Currents through discs and loads on contacts are different systems with the same sum."""
    for order, cell in [(1, None), (3, mf.PeriodicCell(4.0, 4.0))]:
        model, surface = mf.Interacting(order), irregular.replaced(cell=cell)
        found = mf.conductance(surface, model, load=LOADS, resistivity=1.0).rescaled_conductance
        assert_allclose(found, exact_stiffness(model, surface, LOADS), rtol=1e-12)
        # the compiled curve solves the tangent to 1e-4, and for order 3 without terms of second order
        assert_allclose(found, model.curve(surface, LOADS).stiffness, rtol=1e-8 if order == 1 else 2e-5)


def test_conductance_depends_on_the_sum_of_resistivities_on_a_half_space(irregular):
    model = mf.Interacting()
    one = mf.conductance(irregular, model, load=LOADS, resistivity=3.0)
    other = mf.conductance(irregular, model, load=LOADS[::-1], resistivity=1.0, plane_resistivity=2.0)
    assert_allclose(one.conductance, other.conductance, rtol=1e-14)
    assert_allclose(one.conductance, 2.0 / 3.0 * one.rescaled_conductance, rtol=1e-15)


def test_one_disc_has_maxwells_resistance():
    """(rho_1 + rho_2)/(4 a)."""
    surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.36))
    area = mf.equilibrium(surface, load=0.02).area
    found = mf.conductance(surface, load=[0.02], resistivity=1.0, plane_resistivity=0.5)
    assert found.conductance[0] == pytest.approx(4.0 * np.sqrt(area / np.pi) / 1.5, rel=1e-14)


def test_one_disc_on_a_thin_layer():
    """Resistance of the disc and of its images, up to the terms of order 3 of the expansion."""
    surface = mf.Surface([[0, 0]], [0.1], 0.5, mf.Material(1.0), block=mf.Block(20.0, 20.0, 2.0))
    model = mf.Interacting(1, substrate=mf.BondedLayer())
    radius = np.sqrt(mf.equilibrium(surface, model, load=0.02).area / np.pi)
    found = mf.conductance(surface, model, load=[0.02], resistivity=2.0, plane_resistivity=1.0)
    own = 2.0 * (1.0 / (4.0 * radius) - np.log(2.0) / (2.0 * np.pi * 2.0))
    assert found.conductance[0] == pytest.approx(1.0 / (own + 1.0 / (4.0 * radius)), rel=1e-12)


def test_no_contact_has_no_conductance(irregular):
    for model in (mf.Independent(), mf.Interacting()):
        assert mf.conductance(irregular, model, load=[0.0], resistivity=1.0).conductance[0] == 0.0
