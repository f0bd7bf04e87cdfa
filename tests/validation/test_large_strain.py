"""Large strain against small, Hertz, physics.md's rows, the balance of energy and other elements."""

import numpy as np
import pytest

import metafem as mf
from metafem.fe.geometry import Cap, graded_mesh
from validation.finite_elements import frozen_meshes
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


def test_small_strain_limit():
    a = 0.002 * R
    contact = press.press_sequence(np.array([a]), CAP, False, (0, 0))[0]
    small = mf.fe.press(a, **BODY)
    # The coarse mesh's own error is 1.5e-3.
    assert contact.rescaled_load == pytest.approx(small.rescaled_load, rel=2e-3)
    assert contact.indentation == pytest.approx(small.indentation, rel=2e-3)
    assert contact.fraction == 1.0
    assert contact.residual <= soft_body.RESIDUAL


def test_stuck_points_do_not_move():
    contacts = press.press_sequence(R * np.array([0.1, 0.2, 0.3, 0.4, 0.5]), CAP, True, (0, 0))
    for contact in contacts[2::2]:
        place = np.array([contact.material_radius])
        moved = press.stuck_displacement(place, contacts, R)
        assert place + moved == pytest.approx(contact.contact_radius, rel=1e-6)


@pytest.mark.nightly
def test_the_finite_elements_still_make_the_tables_of_deep_caps():
    rows = [0, 3, 5]
    deep = frozen_meshes.soft_cap(frozen_meshes.DEEP_CONTACTS[rows], 0.4)
    np.testing.assert_allclose(deep, frozen_meshes.deep_caps()[0.4][rows], rtol=1e-6)
