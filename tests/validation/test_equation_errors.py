"""The equations of the asperity models hold at their solutions, and only there."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from validation.methods.equation_errors import equation_error
from validation.scenes.random_contacts import random_scene

SURFACE = mf.Surface.square_lattice(
    [0.1, 0.12, 0.11, 0.09], (2, 2), radius=0.526, material=mf.Material(1.36), block=mf.Block(9, 9, 3)
)
LAYER = mf.BondedLayer()
MODELS = [
    mf.Independent(),
    mf.Independent(mf.JKR(9e-6)),
    mf.MeanField(mf.SphericalCap()),
    mf.Interacting(1, LAYER, mf.KogutEtsion(3.0)),
    mf.Interacting(3, LAYER),
    mf.Interacting(3, contact=mf.SphericalCap(), pedestal=True),
    mf.Interacting(3, contact=mf.JKR(9e-6, mf.PowerCap(1.5))),
]


@pytest.mark.parametrize("model", MODELS, ids=repr)
def test_a_solution_obeys_the_equations_and_a_changed_one_does_not(model):
    curve = model.curve(SURFACE, np.array([0.1]))
    assert equation_error(SURFACE, model, curve) < 1e-11
    # a shift of the plane by 1e-6 mm is an error of the order of the change
    assert equation_error(SURFACE, model, replace(curve, approach=curve.approach + 1e-6)) > 1e-6
    last = curve.last
    moved = replace(last, load=last.load * np.array([1.0, 1.001, 1.0, 1.0]))
    assert equation_error(SURFACE, model, replace(curve, compute_last=lambda: moved)) > 1e-4


def test_equations_that_have_no_closed_form_are_left_out():
    for model in (mf.BoundaryElements(0.02), mf.Interacting(3, contact=mf.PowerCap(4))):
        assert equation_error(SURFACE, model, model.curve(SURFACE, np.array([0.1]))) is None


def test_a_scene_follows_from_its_seed():
    first, second, outside = random_scene(7), random_scene(7), random_scene(7, inside=False)
    assert (first.control == second.control).all()
    assert (first.surface.position == second.surface.position).all()
    assert first.surface.count != outside.surface.count or (first.control != outside.control).any()
