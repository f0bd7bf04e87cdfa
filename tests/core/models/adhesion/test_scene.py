"""Equations of adhesive contacts: their derivatives and their energy."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.models.adhesion.scene import Contacts, Scene
from metafem.models.interacting.influence import coupling_between
from tests.models.scenes import RADIUS, scene

CLOSED = np.array([0, 2, 3, 5])
CAPS = [mf.Hertz(), mf.Elastic(mf.Power(1.5))]


@pytest.mark.parametrize("cap", CAPS, ids=repr)
def test_derivatives_are_those_of_the_equations(cap):
    surface, step = scene(), 1e-5
    law = mf.JKR(9e-5, cap).for_material(surface.material)
    coupling, regular = coupling_between(surface, mf.BondedLayer().for_surface(surface), 1)
    some = Contacts(Scene(law, RADIUS, surface.gap, coupling.influence, regular), CLOSED)
    a = np.array([0.12, 0.2, 0.15, 0.18])

    def equations(radii):
        found = some.respond(radii)
        return np.concatenate([found.indentation + found.displacement, found.load])

    linear = some.linearise(a)
    change = [(equations(a + step * e) - equations(a - step * e)) / (2.0 * step) for e in np.eye(4)]
    forces, loads = np.split(np.array(change).T, 2)
    assert_allclose(linear.by_radius, forces, atol=1e-7 * np.abs(forces).max())
    assert_allclose(np.diag(linear.load), loads, atol=1e-7 * np.abs(loads).max())


@pytest.mark.parametrize("cap", CAPS, ids=repr)
def test_the_area_is_the_derivative_of_the_energy(cap):
    """With dU = P dx - A dw, a change of w changes P at fixed x by -dA/dx."""
    surface, w, x, step = scene(height=0.1 + np.array([0, 1, 0, 2, 1, 0]) * 1e-3), 9e-5, 0.06, 1e-3

    def state(energy, approach):
        model = mf.Interacting(1, contact=mf.JKR(energy, cap))
        return model.curve(surface, approach=np.array([approach]))

    area = [state(w, x * (1.0 + sign * 0.1 * step)).area[0] for sign in (-1.0, 1.0)]
    load = [state(w * (1.0 + sign * step), x).load[0] for sign in (-1.0, 1.0)]
    modulus = surface.material.composite_modulus
    by_approach, by_energy = (
        np.diff(area)[0] / (0.2 * step * x),
        modulus * np.diff(load)[0] / (2.0 * step * w),
    )
    assert by_energy == pytest.approx(-by_approach, rel=1e-8)
