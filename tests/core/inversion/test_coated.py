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


def test_operating_points_are_met_exactly():
    """The forces at the points are sums over the contacts of the design."""
    load, force = np.array([0.05, 0.1, 0.2]), np.array([0.07, 0.14, 0.25])
    target = mf.OperatingPoints.from_forces(load, force, MATERIAL, COATED)
    design = mf.design(target, template(), limits=LIMITS)
    assert design.status.name == "EXACT"
    for each, expected in zip(load, force, strict=True):
        state = mf.equilibrium(design.surface, load=each)
        assert 0.4 * 0.85 * WEIGHT @ state.asperity_area == pytest.approx(expected, rel=1e-9)


def test_an_exponent_below_that_of_one_friction():
    """Below 2/3, the smallest exponent of A0 for paraboloids of one radius."""
    target = mf.PowerLaw(0.6, (0.05, 0.1))
    with pytest.raises(mf.Infeasible):
        mf.design(target, template(mf.Friction(0.4, 0.85)), limits=LIMITS)
    assert mf.design(target, template(), limits=LIMITS).misfit < 0.01


def test_a_band_and_steps():
    law = law_of(np.random.default_rng(4).uniform(0.15, 0.25, 16))
    band = mf.Band(law.rescaled_load, 0.95 * law.rescaled_friction, 1.05 * law.rescaled_friction)
    design = mf.design(band, template(), limits=LIMITS)
    low, high = 0.95 * law.rescaled_friction, 1.05 * law.rescaled_friction
    found = mf.friction_law(design.surface, load=law.load).rescaled_friction
    assert ((found >= low) & (found <= high)).all()
    coarse = mf.Limits(0.27, height_step=0.001)
    stepped = mf.design(mf.PowerLaw(0.8, (0.05, 0.1)), template(), limits=coarse)
    assert stepped.misfit < 0.02
    np.testing.assert_allclose(stepped.surface.height / 0.001 % 1.0, 0.5, atol=1e-6)


def test_equal_frictions_give_the_design_of_one_friction():
    target = mf.PowerLaw(0.8, (0.05, 0.1))
    one, equal = (
        mf.design(target, template(friction), limits=LIMITS)
        for friction in (mf.Friction(0.4, 0.85), mf.Friction([0.4] * 16, 0.85))
    )
    assert one.surface == equal.surface
    assert one.law == equal.law
