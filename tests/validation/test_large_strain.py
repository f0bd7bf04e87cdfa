"""Large strain against small, Hertz, physics.md's rows, the balance of energy and other elements."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.fe.geometry import Cap, graded_mesh
from validation.finite_elements.frozen_meshes import FOLDER
from validation.finite_elements.large_strain import body as soft_body
from validation.finite_elements.large_strain import press

R = 0.526

CAP = Cap(R, 0.2, 10.0, 7.2)

BODY = {"radius": R, "height": 0.2, "thickness": 7.2, "block_radius": 10.0}


def test_the_plane_presses_inside_and_nothing_crosses_it_outside():
    edge = float(CAP.surface(np.array(0.5 * R))[0])
    mesh = graded_mesh(edge, 10.0, 7.2, CAP.foot, contact_edge=1e-4, foot_edge=0.05)
    body = soft_body.SoftBody(mesh, CAP, 2, 0.5)
    state = body.flatten(lambda r: R - np.sqrt(R**2 - r**2))
    plane = state.indentation - CAP.height
    free = np.unique(body.mesh.facets[:, body.mesh.boundaries["free"]])
    depth = CAP.point(body.mesh.p[:, free])[1] + state.unknowns[body.count + free]
    assert depth.min() > plane - 1e-12
    _, force = body.balance(*body.deform(state.unknowns))
    closed = np.unique(body.mesh.facets[:, body.mesh.boundaries["contact"]])
    assert force[body.count + closed].min() > -1e-6 * force[body.count + closed].max()


def test_a_newton_that_does_not_end_is_reported(monkeypatch):
    monkeypatch.setattr(soft_body, "NEWTON", 2)
    with pytest.raises(mf.NotConverged, match="of the indentation") as caught:
        press.press_finite(0.2, CAP)
    assert caught.value.state.fraction < 1.0


def test_the_frozen_table_is_a_contact_law():
    material = mf.Material(1.36)
    indentation, load, area = np.loadtxt(FOLDER / "soft_cap.csv", delimiter=",", skiprows=1).T
    law = mf.TabulatedContact(indentation, 1.36 * load, area).for_material(material)
    a = np.array([0.1, 0.19, 0.35, 0.43]) * R
    # printed ratios of finite strain, and 0.2 % of the mesh
    assert_allclose(law.load(a, R) / mf.Hertz().load(a, R), [0.989, 0.981, 0.974, 0.974], atol=2.5e-3)
    # the pedestal is more compliant than a half-space: c_p P/pi, less what large strain stiffens
    assert (law.indentation(a, R) > mf.Hertz().indentation(a, R)).all()
    surface = mf.Surface.square_lattice([0.1, 0.12, 0.15, 0.13], (2, 2), radius=R, material=material)
    soft, hertz = (
        mf.friction_law(surface, mf.Independent(contact), load=[0.05, 0.1]) for contact in (law, mf.Hertz())
    )
    # the load is smaller by up to 2.7 % at a given contact radius
    assert_allclose(soft.area, hertz.area, rtol=0.027)
    assert (soft.area > hertz.area).all()
