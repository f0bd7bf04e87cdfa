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


WITHOUT_STRONG = mf.Limits(0.27, pinned={int(i): None for i in np.flatnonzero(WEIGHT == 1.0)})


@pytest.mark.parametrize(
    ("target", "options", "words"),
    [
        (mf.LinearLaw(4.0), {}, "target must be a law over a load range if the asperities differ"),
        (mf.PowerLaw(0.8, (0.05, 0.1)), {"tools": [0.3, 0.5]}, "tools cannot be used if the asperities"),
        (mf.PowerLaw(0.8, (0.05, 0.1)), {"layout": mf.Layout()}, "layout cannot be used"),
        (mf.PowerLaw(0.8, (0.05, 0.1)), {"robust": mf.Tolerances(0.001)}, "robust cannot be used"),
        (mf.PowerLaw(0.8, (0.05, 0.1)), {"limits": mf.Limits(0.2, pinned={0: 0.1})}, "pinned heights cannot"),
        (mf.PowerLaw(0.8, (0.05, 0.1)), {"limits": WITHOUT_STRONG}, "all sites of the largest"),
    ],
)
def test_what_is_not_supported_is_refused(target, options, words):
    with pytest.raises(mf.InvalidInput, match=words):
        mf.design(target, template(), **{"limits": LIMITS, **options})


def test_bounds_of_one_friction_are_refused():
    refused = r"friction\.shear_strength has one value for each asperity, which {} does not support"
    with pytest.raises(mf.InvalidInput, match=refused.format("metafem.feasible_region")):
        mf.feasible_region(template(), [0.1], LIMITS)
    with pytest.raises(mf.InvalidInput, match=refused.format("metafem.achievable_friction_coefficients")):
        mf.achievable_friction_coefficients(template(), LIMITS)
    with pytest.raises(mf.InvalidInput, match=refused.format("metafem.arrange")):
        mf.arrange(template(), mf.FollowLaw([0.1]), mf.Interacting())
