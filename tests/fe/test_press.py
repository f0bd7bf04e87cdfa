"""Pressed contacts against closed forms, physics.md's rows and each other."""

import math

import numpy as np
import pytest
from skfem import MeshQuad

import metafem as mf
from metafem import reference
from metafem import reference as exact
from metafem.contact import pedestal_compliance
from metafem.fe.elements import Body
from metafem.fe.geometry import Cap, Flat, graded_mesh
from metafem.fe.prescribed_radius import pressed
from tests.core.fe.test_press import R, block, overestimates
from validation.finite_elements import pedestal
from validation.finite_elements.frozen_meshes import FOLDER


def test_graded_mesh_gives_hertz_on_a_deep_block():
    contact = mf.fe.press(1e-5, 1.0, thickness=1.0)
    load, indentation = exact.hertz(1e-5, 1.0)
    # the bonded base, 1e5 contact radii away, takes 7.5e-6 of the indentation
    indentation += load * float(reference.layer_regular(0.0, 1.0, 0.5))
    error = max(abs(contact.rescaled_load / load - 1.0), abs(contact.indentation / indentation - 1.0))
    assert error < 1e-5
    assert overestimates(contact, error)


@pytest.mark.nightly
def test_estimate_bounds_the_distance_to_a_finer_solution():
    cap, contact = Cap(R, 0.12, 10.0, 7.2), block(0.12, 0.10)
    mesh = graded_mesh(float(cap.surface(np.array(0.1))[0]), 10.0, 7.2, cap.foot, contact_edge=1e-7)
    fine = pressed(Body(mesh, cap, 8, 0.5), lambda r: R - np.sqrt(R**2 - r**2), 0.1, 10.0)
    errors = contact.rescaled_load / fine.rescaled_load - 1.0, contact.indentation / fine.indentation - 1.0
    assert overestimates(contact, max(map(abs, errors)))


def test_shortfall_of_the_block_without_a_cap():
    contact = mf.fe.press(
        10.0, 1.0, thickness=pedestal.PEDESTAL_EXTENT, block_radius=pedestal.PEDESTAL_EXTENT
    )
    hertz = (0.75 * contact.rescaled_load) ** (2.0 / 3.0)
    short = math.pi * (hertz - contact.indentation) / contact.rescaled_load
    assert short * pedestal.PEDESTAL_EXTENT == pytest.approx(pedestal.SHORTFALL, abs=1e-3)


def test_the_fit_holds_between_the_rows():
    height_ratio = 0.06
    a = 0.3 * math.sqrt(height_ratio * (2.0 - height_ratio))
    # The promise of the table.
    assert pedestal_compliance(height_ratio, 1.0, a) == pytest.approx(
        pedestal.measure_pedestal(height_ratio, a), rel=1e-3
    )


def test_lengths_scale():
    small = block(0.12, 0.10)
    big = mf.fe.press(100.0, 1e3 * R, height=120.0, thickness=7.2e3, block_radius=1e4)
    # rounding, in elements at the edge that are 1e6 times as long as wide
    assert big.rescaled_load == pytest.approx(1e6 * small.rescaled_load, rel=1e-7)
    assert big.indentation == pytest.approx(1e3 * small.indentation, rel=1e-7)


def test_a_frozen_cell_gives_what_press_gives():
    mesh, side = MeshQuad.load(FOLDER / "cell.vtu"), 1.5 / math.sqrt(math.pi)
    frozen = pressed(Body(mesh, Flat(), 5, 0.5), lambda r: r**2 / (2.0 * R), 0.2, side, walled=True)
    contact = mf.fe.press(0.2, R, thickness=7.2, cell_radius=side)
    assert frozen.rescaled_load == pytest.approx(contact.rescaled_load, rel=1e-4)
