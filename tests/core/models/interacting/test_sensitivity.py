"""Sensitivities of A0 to the heights against differences of high order."""

import numpy as np

import metafem as mf
from tests.core.models.test_sensitivity import scene

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
        load, surface = np.array([0.02, 0.08]), scene(mf.Sphere())
        given = model.sensitivity(surface.replaced(height=np.full(9, 0.1)), load, surface.height)
        own = model.sensitivity(surface, load)
        np.testing.assert_array_equal(given.curve.area, own.curve.area)
        np.testing.assert_array_equal(given.gradient, own.gradient)
        np.testing.assert_array_equal(given.indentation, own.indentation)
