"""Adhesive contacts far apart, and with faint adhesion."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from tests.models.scenes import lattice, said, scene

JKR = mf.JKR(9e-6)
MODELS = [
    mf.MeanField(JKR),
    mf.Interacting(order=3, contact=JKR),
    mf.Interacting(order=3, substrate=mf.BondedLayer(), contact=JKR, pedestal=True),
]


HEIGHT = 0.15 - np.random.default_rng(4).uniform(0.0, 0.03, 9)


@pytest.mark.parametrize("unloading", [False, True])
@pytest.mark.parametrize("cap", [mf.Hertz(), mf.PowerCap(1.5)], ids=repr)
def test_distant_asperities_are_independent(cap, unloading):
    """Two solutions of their own: one in the approach alone, one that follows all contact radii."""
    law, load = mf.JKR(9e-6, cap), np.linspace(0.0, 0.02, 5)
    surface = scene(1e7 * np.arange(8.0).reshape(4, 2), HEIGHT[:4], 0.526)
    one, other = (
        model.curve(surface, load, unloading=unloading)
        for model in (mf.Independent(law), mf.Interacting(contact=law))
    )
    assert one.converged
    assert other.converged
    for name in ("approach", "area", "stiffness"):
        assert_allclose(getattr(other, name), getattr(one, name), rtol=2e-6)
    assert said(one) == said(other)
    assert "jumps of A0" in said(one)


@pytest.mark.parametrize("model", MODELS, ids=repr)
@pytest.mark.parametrize("unloading", [False, True])
def test_without_adhesion_the_law_is_that_of_the_cap(model, unloading):
    surface, load = lattice(HEIGHT), np.array([0.002, 0.05])
    changed, plain, none = (replace(model, contact=law) for law in (mf.JKR(1e-23), mf.Hertz(), mf.JKR(0.0)))
    found, expected = changed.curve(surface, load, unloading=unloading), plain.curve(surface, load)
    # the difference is of the order of sqrt(w); the stiffness without adhesion leaves out squares of order 3
    for name, tolerance in (("approach", 1e-9), ("area", 1e-9), ("stiffness", 1e-8)):
        assert_allclose(getattr(found, name), getattr(expected, name), rtol=tolerance)
    assert_allclose(none.curve(surface, load, unloading=unloading).area, expected.area, rtol=1e-12)
