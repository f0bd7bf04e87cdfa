"""Surfaces that a load has flattened: unloading and second loading."""

from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf

MATERIAL = mf.Material(1.36, 0.3)
LAWS = [law.for_material(MATERIAL) for law in (mf.KogutEtsion(0.05), mf.JacksonGreen(0.01))]


@pytest.fixture
def surface():
    height = 0.2 - np.random.default_rng(5).exponential(0.03, 16).clip(0.0, 0.15)
    return mf.Surface.square_lattice(height, (4, 4), radius=0.526, material=MATERIAL)


MODELS = [mf.Independent, partial(mf.Interacting, 1, mf.BondedLayer(7.2))]
CASES = [(MODELS[0], LAWS[0]), (MODELS[1], LAWS[1])]


@pytest.mark.parametrize(("kind", "law"), CASES)
def test_a_second_loading_returns_to_the_first_at_the_earlier_load(surface, law, kind):
    model = kind(contact=law)
    largest = 0.05
    after, second = mf.flattened(surface, model, load=largest)
    load = largest * np.array([0.1, 0.5, 0.9, 1.0, 1.5])
    first, again = mf.friction_law(surface, model, load=load), mf.friction_law(after, second, load=load)
    assert_allclose(again.area[3:], first.area[3:], rtol=1e-9)
    assert_allclose(again.separation[3:], first.separation[3:], rtol=1e-9)
    # flattened contacts keep a larger area, and the plane stays nearer
    assert (again.area[:3] > first.area[:3]).all()
    assert (again.separation[:3] < first.separation[:3]).all()
    # the unloading is the second loading
    back = mf.friction_law(surface, model, load=load[:4], unloading=True)
    assert_allclose(back.area, again.area[:4], rtol=1e-11)
    assert_allclose(back.separation, again.separation[:4], rtol=1e-11)
    assert_allclose(back.approach, surface.height.max() - back.separation, atol=1e-14)
    assert back.model == second
    nearest = mf.friction_law(surface, model, separation=back.separation, unloading=True)
    assert_allclose(nearest.load, load[:4], rtol=1e-8)


def test_elastic_contacts_unload_as_they_were_loaded(surface):
    for kind in MODELS:
        first, back = (
            mf.friction_law(surface, kind(), load=[0.01, 0.03], unloading=way) for way in (False, True)
        )
        assert_allclose(back.area, first.area, rtol=0)


def test_an_elastic_law_and_a_load_of_zero_change_nothing(surface):
    assert mf.flattened(surface, load=0.1) == (surface, mf.Independent())
    after, _ = mf.flattened(surface, mf.Independent(LAWS[0]), load=0.0)
    assert_allclose(after.height, surface.height, rtol=0)
