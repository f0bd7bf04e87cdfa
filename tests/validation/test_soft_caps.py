"""Large strain against small, Hertz, physics.md's rows, the balance of energy and other elements."""

import functools

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.fe.geometry import Cap
from tests.validation.test_large_strain import BODY, CAP, R
from validation.finite_elements import frozen_meshes as tables
from validation.finite_elements.large_strain import body as soft_body
from validation.finite_elements.large_strain import press


@functools.cache
def coarse(stick):
    """Five contacts on the coarsest mesh."""
    radii = R * np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    return press.press_sequence(radii, CAP, stick, (0, 0))


def test_small_strain_limit():
    a = 0.002 * R
    contact = press.press_sequence(np.array([a]), CAP, False, (0, 0))[0]
    small = mf.fe.press(a, **BODY)
    # The coarse mesh's own error is 1.5e-3.
    assert contact.rescaled_load == pytest.approx(small.rescaled_load, rel=2e-3)
    assert contact.indentation == pytest.approx(small.indentation, rel=2e-3)
    assert contact.fraction == 1.0
    assert contact.residual <= soft_body.RESIDUAL


def test_lengths_of_any_unit():
    big, one = (
        press.press_sequence(
            np.array([0.3 * unit]), Cap(unit, 0.4 * unit, 20.0 * unit, 10.0 * unit), False, (0, 0)
        )[0]
        for unit in (1e6, 1.0)
    )
    assert big.rescaled_load == pytest.approx(1e12 * one.rescaled_load, rel=1e-7)
    assert big.indentation == pytest.approx(1e6 * one.indentation, rel=1e-7)


def test_the_plane_s_work_is_stored():
    """Stick at first touch loses no energy."""
    contacts = coarse(True)
    depth = np.array([0.0] + [c.indentation for c in contacts])
    # P = depth^(3/2) times a polynomial in sqrt(depth) that begins with Hertz's law.
    share = [c.rescaled_load / c.indentation**1.5 for c in contacts]
    terms = np.polynomial.polynomial.polyfit(np.sqrt(depth), [4.0 / 3.0 * R**0.5, *share], 5)
    power = 2.5 + 0.5 * np.arange(6)
    work = float(terms @ (depth[-1] ** power / power))
    assert work == pytest.approx(contacts[-1].energy, rel=1e-4)


def test_stick_is_stiffer_than_slip():
    for slip, stick in zip(coarse(False), coarse(True), strict=True):
        # Loads at one indentation, by P ~ indentation^(3/2).
        assert stick.rescaled_load / stick.indentation**1.5 > slip.rescaled_load / slip.indentation**1.5


@pytest.mark.nightly
def test_the_public_history_agrees_with_another():
    contact = press.press_finite(0.5 * R, CAP, stick=True)
    other = coarse(True)[-1]
    assert contact.error_estimate < 2e-3
    assert contact.rescaled_load == pytest.approx(other.rescaled_load, rel=contact.error_estimate)


def test_stuck_points_do_not_move():
    for contact in (coarse(True)[2], coarse(True)[4]):
        place = np.array([contact.material_radius])
        moved = press.stuck_displacement(place, coarse(True), R)
        assert place + moved == pytest.approx(contact.contact_radius, rel=1e-6)


def test_the_finite_elements_still_make_the_table():
    rows, frozen = [0, 6, 11], np.loadtxt(tables.FOLDER / "soft_cap.csv", delimiter=",", skiprows=1)
    assert_allclose(tables.soft_cap(tables.SOFT_CONTACTS[rows]), frozen[rows], rtol=1e-6)


@pytest.mark.nightly
def test_the_finite_elements_still_make_the_tables_of_deep_caps():
    rows = [0, 3, 5]
    deep = tables.soft_cap(tables.DEEP_CONTACTS[rows], 0.4)
    assert_allclose(deep, tables.deep_caps()[0.4][rows], rtol=1e-6)
