"""Equations of adhesive contacts: their derivatives, and the energy of paraboloids."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.models.adhesion.scene import Contacts, Scene
from metafem.models.adhesion.slopes import Slopes
from metafem.models.interacting.influence import coupling_between
from tests.models.scenes import RADIUS, scene

CLOSED = np.array([0, 2, 3, 5])


def contacts(cap, order):
    surface = scene()
    law = mf.JKR(9e-5, cap).for_material(surface.material)
    coupling, regular = coupling_between(surface, mf.BondedLayer().for_surface(surface), order)
    return Contacts(Scene(law, RADIUS, surface.gap, coupling, regular), CLOSED)


def settled(some, a):
    """Loads and fields at contact radii."""
    p = np.zeros(len(a))
    for _ in range(100):
        p = some.respond(a, p).load
    return p, some.respond(a, p)


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize("cap", [mf.Hertz(), mf.PowerCap(4), mf.SphericalCap()], ids=repr)
def test_derivatives_are_those_of_the_equations(cap, order):
    some, step = contacts(cap, order), 1e-5
    a = np.array([0.12, 0.2, 0.15, 0.18])

    def equations(radii):
        p, found = settled(some, radii)
        return np.concatenate([found.indentation + found.displacement, p])

    found = settled(some, a)[1]
    linear = some.linearise(a, found)
    loads = linear.loads if order == 3 else np.diag(linear.loads)
    change = [(equations(a + step * e) - equations(a - step * e)) / (2.0 * step) for e in np.eye(4)]
    forces, expected = np.split(np.array(change).T, 2)
    assert_allclose(linear.by_radius, forces, atol=1e-7 * np.abs(forces).max())
    assert_allclose(loads, expected, atol=1e-7 * np.abs(expected).max())


def test_paraboloids_have_an_energy():
    """dF/dp = dF/da (dp/da)^-1 is symmetric, as the second derivative of an energy of the loads."""
    some = contacts(mf.Hertz(), 3)
    a = np.array([0.12, 0.2, 0.15, 0.18])
    linear = some.linearise(a, settled(some, a)[1])
    hessian = linear.by_radius @ np.linalg.inv(linear.loads)
    assert_allclose(hessian, hessian.T, atol=1e-13 * np.abs(hessian).max())


def test_a_tilted_paraboloid_is_a_shifted_one():
    """The moment of an adhesive contact on a slope g is R P g: its edge moves with the contact."""
    some = contacts(mf.Hertz(), 3)
    a = np.array([0.12, 0.2, 0.15, 0.18])
    p, found = settled(some, a)
    steepness = found.slope_x**2 + found.slope_y**2
    general = Slopes(some.scene.law, some.radius, a, found.curvature, steepness)
    assert_allclose(general.values.tilt, RADIUS[CLOSED] * p, rtol=1e-10)
    assert_allclose(general.values.turn, RADIUS[CLOSED], rtol=1e-12)
    assert_allclose(general.values.load, p, rtol=1e-10)
