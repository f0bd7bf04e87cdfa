"""Large strain against small, Hertz, physics.md's rows, the balance of energy and other elements."""

import functools

import numpy as np
import pytest

import metafem as mf
from metafem.fe.axisymmetric.geometry import Cap
from metafem.fe.axisymmetric.mesh import graded_mesh
from metafem.fe.large_strain import body as soft_body
from metafem.fe.large_strain import press

R = 0.526
CAP = Cap(R, 0.2, 10.0, 7.2)
BODY = {"radius": R, "height": 0.2, "thickness": 7.2, "block_radius": 10.0}


def over_hertz(contact):
    return contact.rescaled_load / (4.0 / 3.0 * contact.contact_radius**3 / R)


@functools.cache
def coarse(stick):
    """Five contacts on the coarsest mesh."""
    radii = R * np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    return press.press_sequence(radii, CAP, stick, (0, 0))


def sphere(r):
    return R - np.sqrt(R**2 - r**2)


@functools.cache
def flattened(place, degree, refinement=0):
    """One body with its state, the contact ending at a material radius."""
    mesh = graded_mesh(
        float(CAP.surface(np.array(place))[0]), 10.0, 7.2, CAP.foot, contact_edge=1e-4, foot_edge=0.05
    )
    body = soft_body.SoftBody(mesh.refined(refinement) if refinement else mesh, CAP, degree, 0.5)
    return body, body.flatten(sphere)


@pytest.mark.slow
def test_small_strain_limit():
    a = 0.002 * R
    contact = press.press_sequence(np.array([a]), CAP, False, (0, 0))[0]
    small = mf.fe.press(a, **BODY)
    # The coarse mesh's own error is 1.5e-3.
    assert contact.rescaled_load == pytest.approx(small.rescaled_load, rel=2e-3)
    assert contact.indentation == pytest.approx(small.indentation, rel=2e-3)
    assert contact.status is mf.fe.NewtonStatus.CONVERGED
    assert contact.residual <= soft_body.RESIDUAL


@pytest.mark.slow
def test_lengths_of_any_unit():
    big, one = (
        press.press_sequence(
            np.array([0.3 * unit]), Cap(unit, 0.4 * unit, 20.0 * unit, 10.0 * unit), False, (0, 0)
        )[0]
        for unit in (1e6, 1.0)
    )
    assert big.rescaled_load == pytest.approx(1e12 * one.rescaled_load, rel=1e-7)
    assert big.indentation == pytest.approx(1e6 * one.indentation, rel=1e-7)


@pytest.mark.slow
def test_hertz_lies_between_finite_and_small_strain():
    a = 0.5 * R
    assert over_hertz(coarse(False)[-1]) < 1.0 < over_hertz(mf.fe.press(a, **BODY))


@pytest.mark.slow
@pytest.mark.parametrize("stick", [False, True])
def test_the_plane_s_work_is_stored(stick):
    """Neither slip without friction nor stick at first touch loses energy."""
    contacts = coarse(stick)
    depth = np.array([0.0] + [c.indentation for c in contacts])
    # P = depth^(3/2) times a polynomial in sqrt(depth) that begins with Hertz's law.
    share = [c.rescaled_load / c.indentation**1.5 for c in contacts]
    terms = np.polynomial.polynomial.polyfit(np.sqrt(depth), [4.0 / 3.0 * R**0.5, *share], 5)
    power = 2.5 + 0.5 * np.arange(6)
    work = float(terms @ (depth[-1] ** power / power))
    assert work == pytest.approx(contacts[-1].energy, rel=1e-4)


@pytest.mark.slow
def test_stick_is_stiffer_than_slip():
    for slip, stick in zip(coarse(False), coarse(True), strict=True):
        # Loads at one indentation, by P ~ indentation^(3/2).
        assert stick.rescaled_load / stick.indentation**1.5 > slip.rescaled_load / slip.indentation**1.5


@pytest.mark.slow
def test_the_public_history_agrees_with_another():
    contact = mf.fe.press_finite(0.5 * R, **BODY, stick=True)
    other = coarse(True)[-1]
    assert contact.error_estimate < 2e-3
    assert contact.rescaled_load == pytest.approx(other.rescaled_load, rel=contact.error_estimate)


@pytest.mark.slow
def test_stuck_points_do_not_move():
    early, late = (coarse(True)[i] for i in (2, 4))
    history = press.Stick(R)
    for contact in coarse(True):
        history.add(contact.material_radius, contact.shift)
    for contact in (early, late):
        place = np.array([contact.material_radius])
        assert place + history.displacement(place) == pytest.approx(contact.contact_radius, rel=1e-6)


def test_the_plane_presses_inside_and_nothing_crosses_it_outside():
    body, state = flattened(0.5 * R, 2)
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
        mf.fe.press_finite(0.2, **BODY)
    assert caught.value.state.status is mf.fe.NewtonStatus.NOT_CONVERGED


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"contact_radius": 0.0}, "contact_radius"),
        ({"contact_radius": 0.42}, "cap's edge"),
        ({"radius": -1.0}, "radius"),
        ({"height": 0.6}, "height"),
        ({"thickness": 0.1}, "cap's height"),
        ({"block_radius": 0.4}, "block_radius"),
        ({"stick": "no"}, "stick"),
    ],
)
def test_bad_input(change, reason):
    with pytest.raises(mf.InvalidInput, match=reason):
        mf.fe.press_finite(**{"contact_radius": 0.1, **BODY, **change})


@pytest.mark.slow
def test_the_estimate_bounds_the_difference_from_other_elements():
    """Cubic displacements with quadratic pressures, on the coarse mesh."""
    contact = mf.fe.press_finite(0.35 * R, **BODY)
    _, cubic = flattened(contact.material_radius, 3)
    error = abs(
        contact.rescaled_load / (cubic.rescaled_load * (contact.contact_radius / cubic.contact_radius) ** 3)
        - 1.0
    )
    assert error < contact.error_estimate < 100.0 * error


@pytest.mark.slow
def test_rate_of_quadratic_elements():
    place = 0.45 * R
    loads = [flattened(place, 2, refinement)[1].rescaled_load for refinement in range(3)]
    # Quadratic displacements give energies of order four; the foot's corner and the growing cells take
    # up to one from it.
    assert np.log2((loads[0] - loads[1]) / (loads[1] - loads[2])) > 2.5
