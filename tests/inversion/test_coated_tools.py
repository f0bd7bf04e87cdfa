"""Tools with a shear strength: the search chooses cap, radius and coating of each asperity."""

import math

import numpy as np
import pytest

import metafem as mf

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.4, 0.85)
CELL = mf.Surface.square_lattice(0.15, (3, 4), radius=0.526, material=MATERIAL, friction=FRICTION)
LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=MATERIAL, friction=FRICTION)
LIMITS = mf.Limits(0.15)
KIT = (mf.Tool(0.3), mf.Tool(0.6, shear_strength=0.1), mf.Tool(0.3, mf.Power(4), shear_strength=0.8))
ELASTIC = mf.Independent(mf.Elastic())
PARABOLOIDS = (mf.Tool(0.526, mf.Paraboloid()), mf.Tool(0.526, mf.Paraboloid(), shear_strength=0.1))


def forces_of(surface, load):
    """Return the friction forces [N] of power caps at loads [N]: own sums of closed forms, by bisection."""
    gap, modulus = surface.height.max() - surface.height, surface.material.composite_modulus
    size = surface.radius
    n = np.array([exponent(surface.cap.one(i)) for i in range(surface.count)])
    each = np.broadcast_to(surface.friction.shear_strength * surface.friction.area_ratio, n.shape)
    slope = math.sqrt(math.pi) / 2.0 * n * np.array([math.gamma(k / 2) / math.gamma((k + 1) / 2) for k in n])

    def contacts(approach):
        depth = np.maximum(approach - gap, 0.0)
        a = size * (depth / (0.5 * slope * size)) ** (1.0 / n)
        return (2.0 * n / (n + 1.0) * a * depth).sum(), (each * math.pi * a * a).sum()

    found = []
    for p in load / modulus:
        low, high = 0.0, 1.0
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if contacts(middle)[0] < p else (low, middle)
        found.append(contacts(low)[1])
    return np.array(found)


def exponent(cap):
    return cap.exponent if isinstance(cap, mf.Power) else 2.0


def scene(seed, tools, count=8):
    """Return a surface of random heights whose asperities are made by random tools."""
    rng = np.random.default_rng(seed)
    made = [tools[i] for i in rng.integers(len(tools), size=count)]
    sigma = [0.4 if tool.shear_strength is None else tool.shear_strength for tool in made]
    return CELL.only(
        slice(count),
        height=rng.uniform(0.08, 0.15, count),
        radius=[tool.radius for tool in made],
        cap=[tool.cap for tool in made],
        friction=mf.Friction(sigma, 0.85),
    )


POWERS = (mf.Tool(0.5, mf.Power(2)), mf.Tool(0.5, mf.Power(2), shear_strength=0.1), mf.Tool(0.3, mf.Power(4), 0.8))


@pytest.mark.parametrize("seed", range(4))
def test_the_law_of_known_coated_tools_is_recovered(seed):
    load = np.linspace(0.01, 0.3, 30)
    known = forces_of(scene(seed, POWERS), load)
    target = mf.SampledLaw.from_forces(load, known, MATERIAL, FRICTION)
    found = mf.design(target, CELL, limits=LIMITS, tools=POWERS)
    assert found.misfit <= 2e-3
    np.testing.assert_allclose(forces_of(found.surface, load), known, rtol=0.01)
    rms = np.sqrt(((forces_of(found.surface, load) / known - 1.0) ** 2).mean())
    assert rms == pytest.approx(found.misfit, abs=1e-9)
    np.testing.assert_allclose(found.law.friction_force, forces_of(found.surface, found.law.load), rtol=1e-9)
