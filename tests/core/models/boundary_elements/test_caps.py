"""Resolved contacts of caps that are no paraboloids."""

from itertools import product

import numpy as np
import pytest

import metafem as mf
from metafem.caps.shapes import sphere_profile
from metafem.models.boundary_elements.cells import Scene
from tests.models.scenes import Read, lattice, scene, single_contact
from validation.methods.bent import Bent

RADIUS, CONTACT = 0.526, 0.2
RHO = np.linspace(0.0, 0.45, 80)
SPHERE = mf.Elastic(mf.Profile([RHO, sphere_profile(RHO, RADIUS)]))
LAWS = [*(mf.Elastic(mf.Power(n)) for n in (1.5, 8)), mf.Elastic(mf.Sphere()), SPHERE]


def test_one_contact_is_that_of_the_law():
    for law in (mf.Hertz(), *LAWS):
        width = 0.5 * RADIUS if law in (mf.Elastic(mf.Sphere()), SPHERE) else CONTACT
        state, exact = single_contact(law, 50, contact_radius=width)
        # the cells' error at 50 per radius
        assert state.load == pytest.approx(exact.load, rel=1e-4)
        assert state.area == pytest.approx(exact.area, rel=3e-4)
        assert state.stiffness == pytest.approx(exact.stiffness, rel=5e-4)
        assert state.model.contact == law


def test_areas_from_moments_hold_for_any_extra_curvature():
    surface = scene(radius=np.full(6, RADIUS))
    a = np.linspace(0.1, 0.2, 6)
    for law in (*LAWS, Read(mf.Power(2.0))):
        bent = Bent(law, np.linspace(-0.1, 0.4, 6) * law.indentation(a, RADIUS) / a**2)
        load, moment = bent.load(a, RADIUS), bent.second_moment(a, RADIUS)
        resolved = Scene(surface, 0.01, mf.HalfSpace(), law)
        found = resolved.areas(0.5 * moment / load / 1e-4, load / 1e-4, np.zeros(6))
        np.testing.assert_allclose(1e-4 * found, np.pi * a**2, rtol=1e-12)
        assert (resolved.areas(*np.zeros((3, 6))) == 0.0).all()
        assert (resolved.areas(np.zeros(6), np.ones(6), np.ones(6)) == 0.0).all()  # on one cell


def test_coupled_contacts_are_those_of_order_3():
    for law, surface in (
        (mf.Elastic(mf.Power(4)), lattice(0.5 * np.ones(9))),
        (mf.Elastic(mf.Sphere()), scene()),
    ):
        third, given = mf.Interacting(contact=law), {"approach": float(law.indentation(0.18, RADIUS))}
        state = mf.equilibrium(surface, mf.BoundaryElements(0.01, contact=law), **given)
        # what is required up to a/L = 0.2
        assert state.load == pytest.approx(mf.equilibrium(surface, third, **given).load, rel=3e-4)
        area = mf.equilibrium(surface, third, load=state.load).area
        assert state.area == pytest.approx(area, rel=1e-3)
        assert not any("not that of" in note.text for note in state.notes)


def test_a_flat_summit_on_a_slope_touches_beside_its_axis():
    """At its axis the second summit does not reach the plane, by 1.4 um."""
    surface = scene([[0.0, 0.0], [0.75, 0.0]], [0.5, 0.385], RADIUS)
    areas = [
        mf.equilibrium(
            surface, mf.BoundaryElements(cell, contact=mf.Elastic(mf.Power(4))), approach=0.15
        ).asperity_area
        for cell in (0.004, 0.008)
    ]
    assert areas[0][1] > 0.01
    # seven cells for the deformed one
    np.testing.assert_allclose(*areas, atol=7.0 * 0.008**2 + 7.0 * 0.004**2, rtol=1e-4)


def test_contacts_of_few_cells_keep_the_area_of_their_law():
    """Their edges are not found: the pressure is steep or flat at the axis, some cells from the edge."""
    for exponent, offset in product((1.2, 8), np.random.default_rng(5).random((2, 2))):
        state, exact = single_contact(mf.Elastic(mf.Power(exponent)), 5, offset, 0.05)
        missing = abs(state.area - exact.area) / (0.05 / 5) ** 2
        assert missing < 1.25 * (0.37 * np.pi)  # LAWFUL_ERROR
