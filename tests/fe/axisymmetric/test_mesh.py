"""Recipes, frozen meshes and their boundaries' names."""

import math

import pytest
from skfem import MeshQuad

import metafem as mf
from metafem.fe.axisymmetric.geometry import Flat
from metafem.fe.axisymmetric.prescribed_radius import graded
from validation.finite_elements.frozen_meshes import FOLDER


def parabola(r):
    return r**2 / (2.0 * 0.526)


def test_a_frozen_cell_gives_what_press_gives():
    mesh = MeshQuad.load(FOLDER / "cell.vtu")
    side = 1.5 / math.sqrt(math.pi)
    pressed = graded(mesh, Flat(), 5, 0.5, parabola, 0.2, side, True)
    contact = mf.fe.press(0.2, 0.526, thickness=7.2, cell_radius=side)
    assert pressed.rescaled_load == pytest.approx(contact.rescaled_load, rel=1e-4)
