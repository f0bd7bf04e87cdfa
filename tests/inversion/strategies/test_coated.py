"""Designs whose asperities differ in friction."""

import numpy as np
import pytest

import metafem as mf
from metafem.surface import Surface

MATERIAL, LIMITS = mf.Material(1.36), mf.Limits(0.27)
WEIGHT = np.random.default_rng(0).choice([1.0, 0.25], 16)
COATED = mf.Friction(0.4 * WEIGHT, 0.85)


def template(friction=COATED, **others):
    return Surface.square_lattice(0.12, (4, 4), radius=0.526, material=MATERIAL, friction=friction, **others)


def law_of(height, model=None):
    return mf.friction_law(template().replaced(height=height), model, load=np.linspace(0.02, 0.12, 10))


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting()], ids=repr)
def test_the_law_of_known_heights_is_recovered(model):
    law = law_of(np.random.default_rng(2).uniform(0.15, 0.25, 16), model)
    target = mf.SampledLaw.from_forces(law.load, law.friction_force, MATERIAL, COATED)
    design = mf.design(target, template(), model, LIMITS)
    assert design.misfit < 5e-3
    assert design.surface.friction == COATED
    found = mf.friction_law(design.surface, model, load=law.load)
    np.testing.assert_allclose(found.friction_force, law.friction_force, rtol=0.01)
