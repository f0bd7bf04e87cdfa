"""Sensitivities of A0 to the heights against differences of high order."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.interacting import elastic as interacting
from metafem.models.interacting.sensitivity import general_gradients

PEDESTALS = [mf.Interacting(order=order, substrate=mf.BondedLayer(), pedestal=True) for order in (1, 3)]
MODELS = [mf.Independent(), mf.Interacting(order=3), *PEDESTALS]


def test_raising_all_heights_changes_nothing():
    surface = mf.Surface.square_lattice(
        np.random.default_rng(0).exponential(0.03, 36), (6, 6), radius=0.526, material=mf.Material(1.0)
    )
    for model in (mf.Independent(), mf.Interacting(order=1), mf.Interacting(order=3)):
        gradient = model.sensitivity(surface, np.array([0.01, 0.1])).gradient
        np.testing.assert_allclose(gradient.sum(axis=1), 0.0, atol=1e-12 * np.abs(gradient).max())


def test_heights_can_stand_in_place_of_those_of_the_surface():
    for model in MODELS:
        rng = np.random.default_rng(1)
        height = 0.1 + rng.exponential(0.02, 9)
        flat = mf.Surface.square_lattice(
            0.1, (3, 3), radius=0.526, material=mf.Material(1.0), block=mf.Block(20.0, 20.0, 3.0)
        )
        load = np.array([0.02, 0.08])
        given = model.sensitivity(flat, load, height)
        own = model.sensitivity(flat.replaced(height=height), load)
        np.testing.assert_array_equal(given.curve.area, own.curve.area)
        np.testing.assert_array_equal(given.gradient, own.gradient)
        np.testing.assert_array_equal(given.indentation, own.indentation)


@pytest.mark.parametrize("model", MODELS[2:], ids=repr)
def test_the_kernel_has_the_sensitivities_of_the_general_solver(model, monkeypatch):
    rng = np.random.default_rng(5)
    surface = mf.Surface.square_lattice(
        0.1 + rng.exponential(0.02, 25),
        (5, 5),
        radius=rng.uniform(0.4, 0.7, 25),
        material=mf.Material(1.0),
        block=mf.Block(20.0, 20.0, 3.0),
    )
    load = np.array([0.0, 0.05, 0.5])
    found = model.sensitivity(surface, load).gradient
    monkeypatch.setattr(interacting, "area_gradients", general_gradients)
    general = model.sensitivity(surface, load).gradient
    np.testing.assert_allclose(found, general, rtol=0.0, atol=1e-13 * np.abs(general).max())
