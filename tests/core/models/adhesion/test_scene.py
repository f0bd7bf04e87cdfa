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
OTHER_CAPS = [mf.PowerCap(1.5), mf.SphericalCap()]


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


@pytest.mark.parametrize(("cap", "order"), [(mf.Hertz(), 1), (mf.Hertz(), 3), (mf.PowerCap(4), 3)])
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


def test_other_caps_have_an_energy_to_fourth_order_in_the_slope(monkeypatch):
    """dF/dp is symmetric up to terms in g^4: half the slopes reduce its asymmetry by a factor of 16."""
    for cap in OTHER_CAPS:
        some, a = contacts(cap, 3), np.array([0.12, 0.2, 0.15, 0.18])
        asymmetry = []
        for share in (1.0, 0.5):
            part = Contacts(some.scene, CLOSED)
            part.fields = some.fields * np.array([1.0, share, share])[:, None, None]
            linear = part.linearise(a, settled(part, a)[1])
            hessian = linear.by_radius @ np.linalg.inv(linear.loads)
            asymmetry.append(np.abs(hessian - hessian.T).max() / np.abs(hessian).max())
        assert asymmetry[0] < 1e-7
        assert asymmetry[0] == pytest.approx(16.0 * asymmetry[1], rel=0.05)


@pytest.mark.parametrize("cap", [mf.Hertz(), mf.PowerCap(1.5)], ids=repr)
def test_the_area_is_the_derivative_of_the_energy(cap):
    """With dU = P dx - A dw, a change of w changes P at fixed x by -dA/dx."""
    surface, w, x, step = scene(height=0.1 + np.array([0, 1, 0, 2, 1, 0]) * 1e-3), 9e-5, 0.06, 1e-3

    def state(energy, approach):
        model = mf.Interacting(contact=mf.JKR(energy, cap))
        return model.curve(surface, approach=np.array([approach]))

    area = [state(w, x * (1.0 + sign * 0.1 * step)).area[0] for sign in (-1.0, 1.0)]
    load = [state(w * (1.0 + sign * step), x).load[0] for sign in (-1.0, 1.0)]
    modulus = surface.material.composite_modulus
    by_approach, by_energy = (
        np.diff(area)[0] / (0.2 * step * x),
        modulus * np.diff(load)[0] / (2.0 * step * w),
    )
    assert by_energy == pytest.approx(-by_approach, rel=1e-8 if cap == mf.Hertz() else 3e-6)


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
