"""Friction that differs from asperity to asperity: laws and sensitivities of all models."""

import numpy as np
import pytest

import metafem as mf
from metafem.surface import Surface

SPHERE = mf.Sphere()
MATERIAL = mf.Material(1.36)
LOAD = np.array([0.02, 0.08, 0.2]) / MATERIAL.composite_modulus
RNG = np.random.default_rng(1)
POSITION = 1.1 * np.stack(np.meshgrid(np.arange(3.0), np.arange(3.0)), axis=-1).reshape(-1, 2)
HEIGHT = RNG.uniform(0.08, 0.12, 9)
STRENGTH, RATIO = RNG.uniform(0.1, 0.5, 9), RNG.uniform(0.5, 1.0, 9)
COATED = mf.Friction(STRENGTH, RATIO)
CAPS = [mf.Sphere(), mf.Power(3)] * 4 + [mf.Paraboloid()]
MODELS = [
    mf.Independent(mf.Elastic()),
    mf.Independent(mf.KogutEtsion(10.0)),
    mf.Interacting(pedestal=True),
    mf.Interacting(1, contact=mf.JKR(9e-6)),
]


def scene(friction=COATED, height=HEIGHT, cap=SPHERE, **others):
    """Nine asperities on a block."""
    block = mf.Block(20.0, 20.0, 7.2)
    return Surface(POSITION, height, 0.526, MATERIAL, friction, block, cap, **others)


def cap_for(model):
    return CAPS if model.contact == mf.Elastic() else SPHERE


def test_closed_form_of_two_contacts():
    """``F = sum sigma_i B_i pi R d_i`` of independent paraboloids at a given approach."""
    friction = mf.Friction([0.4, 0.1], [0.9, 0.8])
    surface = Surface([[0, 0], [1.5, 0]], [0.12, 0.1], 0.526, MATERIAL, friction)
    law = mf.friction_law(surface, separation=[0.08, 0.11])
    depth = np.maximum(surface.height - law.separation[:, None], 0.0)
    expected = (np.pi * 0.526 * depth) @ np.array([0.36, 0.08])
    np.testing.assert_allclose(law.friction_force, expected, rtol=1e-12)
    np.testing.assert_allclose(law.rescaled_friction, expected / 0.36, rtol=1e-12)
    np.testing.assert_allclose(law.area, np.pi * 0.526 * depth.sum(axis=1), rtol=1e-12)
    # gradient: A'_i - P'_i sum A' / sum P' with weighted A' = pi R w and P' = 2 sqrt(R d)
    found = mf.Independent().sensitivity(surface, law.rescaled_load[-1:])
    widening, stiffness = np.pi * 0.526 * np.array([1.0, 0.08 / 0.36]), 2.0 * np.sqrt(0.526 * depth[-1])
    expected = widening - stiffness * widening.sum() / stiffness.sum()
    np.testing.assert_allclose(found.gradient[0], expected, rtol=1e-11)


@pytest.mark.slow
def test_force_is_the_sum_over_the_contacts():
    for model in (*MODELS, mf.BoundaryElements(0.03)):
        surface = scene(cap=cap_for(model))
        law = mf.friction_law(surface, model, load=1.36 * LOAD)
        for i, load in enumerate(law.load):
            state = mf.equilibrium(surface, model, load=load)
            expected = (STRENGTH * RATIO) @ state.asperity_area
            assert law.friction_force[i] == pytest.approx(expected, rel=1e-11)
        assert law.friction_coefficient == pytest.approx(law.friction_force / law.load, rel=1e-14)
        areas = model.areas(surface, LOAD, HEIGHT[None])[0]
        np.testing.assert_allclose(areas, law.rescaled_friction, rtol=1e-11)


@pytest.mark.slow
def test_equal_frictions_give_the_bits_of_one_friction():
    for model in (mf.Interacting(), mf.BoundaryElements(0.02)):
        one, equal = mf.Friction(0.4, 0.85), mf.Friction([0.4] * 9, [0.85] * 9)
        assert scene(equal).friction == one
        first, second = (
            mf.friction_law(scene(friction), model, load=1.36 * LOAD) for friction in (one, equal)
        )
        assert first.friction_area is None
        assert first.friction_force.tobytes() == second.friction_force.tobytes()
        products = mf.Friction([0.4, 0.2], [0.5, 1.0])
        assert products.weights == 1.0
        assert not products.differs


def test_a_reference_scales_the_rescaled_friction_and_not_the_forces():
    surface = mf.Surface.square_lattice(0.1, (1, 3), radius=0.5, material=mf.Material(1.36))
    for sigma in ([0.1, 0.2, 0.4], 0.2, [0.2, 0.2, 0.2]):
        laws = [
            mf.friction_law(surface.replaced(friction=mf.Friction(sigma, 0.5, reference)), load=[0.1, 0.2])
            for reference in (None, 0.05, 0.1, 0.7)
        ]
        for law, reference in zip(laws[1:], (0.05, 0.1, 0.7), strict=True):
            np.testing.assert_allclose(law.friction_force, laws[0].friction_force, rtol=1e-14)
            np.testing.assert_allclose(law.rescaled_friction * reference, law.friction_force, rtol=1e-14)


def test_a_reference_that_is_the_common_stress_is_left_out():
    friction = mf.Friction([0.4, 0.4], 0.5, 0.2)
    assert friction.of(2) == mf.Friction(0.4, 0.5)
    assert mf.Friction(0.4, 0.5, 0.3).of(2) == mf.Friction([0.4, 0.4], 0.5, 0.3)
