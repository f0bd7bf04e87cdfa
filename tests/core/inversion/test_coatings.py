"""Asperities that differ in friction: by the template, or by tools with a shear strength."""

import math

import numpy as np
import pytest

import metafem as mf

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.4, 0.85)
CELL = mf.Surface.square_lattice(0.15, (3, 4), radius=0.526, material=MATERIAL, friction=FRICTION)
LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=MATERIAL, friction=FRICTION)
ELASTIC = mf.Independent(mf.Elastic())

KIT = (mf.Tool(0.5, mf.Power(2)), mf.Tool(0.5, mf.Power(2), 0.1), mf.Tool(0.3, mf.Power(4), 0.8))
UNCOATED = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4)), mf.Tool(0.6, mf.Power(1.5))]
WEIGHT = np.random.default_rng(0).choice([1.0, 0.25], 16)
COATED = mf.Friction(0.4 * WEIGHT, 0.85)


def forces_of(surface, load):
    """Return the friction forces [N] of power caps at loads [N]: own sums of closed forms, by bisection."""
    gap, size, friction = surface.height.max() - surface.height, surface.radius, surface.friction
    n = np.array([getattr(surface.cap.one(i), "exponent", 2.0) for i in range(surface.count)])
    stress = friction.shear_strength * friction.area_ratio * np.ones(surface.count)
    slope = math.sqrt(math.pi) / 2.0 * n * np.array([math.gamma(k / 2) / math.gamma((k + 1) / 2) for k in n])

    def contacts(approach):
        depth = np.maximum(approach - gap, 0.0)
        a = size * (depth / (0.5 * slope * size)) ** (1.0 / n)
        return (2.0 * n / (n + 1.0) * a * depth).sum(), (stress * math.pi * a * a).sum()

    found = []
    for p in load / surface.material.composite_modulus:
        low, high = 0.0, 1.0
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if contacts(middle)[0] < p else (low, middle)
        found.append(contacts(low)[1])
    return np.array(found)


def scene(seed, tools, count=8):
    """Return a surface of random heights whose asperities are made by random tools."""
    rng = np.random.default_rng(seed)
    made = [tools[i] for i in rng.integers(len(tools), size=count)]
    shape = {"radius": [tool.radius for tool in made], "cap": [tool.cap for tool in made]}
    friction = mf.Friction([tool.shear_strength or 0.4 for tool in made], 0.85)
    return CELL.only(slice(count), height=rng.uniform(0.08, 0.15, count), friction=friction, **shape)


def template(friction=COATED):
    """Return sixteen asperities that differ in friction."""
    return mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=MATERIAL, friction=friction)


@pytest.mark.parametrize("seed", [4, 5, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (0, 2, 3))])
def test_the_law_of_known_tools_is_recovered(seed):
    load = np.linspace(0.01, 0.3, 30)
    known = forces_of(scene(seed, KIT), load)
    target = mf.SampledLaw.from_forces(load, known, MATERIAL, FRICTION)
    found = mf.design(target, CELL, limits=mf.Limits(0.15), tools=KIT)
    assert found.misfit <= 2e-3
    force = forces_of(found.surface, load)
    assert np.sqrt(((force / known - 1.0) ** 2).mean()) == pytest.approx(found.misfit, abs=1e-9)
    np.testing.assert_allclose(found.law.friction_force, forces_of(found.surface, found.law.load), rtol=1e-9)


def test_forces_are_sums_over_the_tools_of_the_asperities():
    """The frictions of the surface are those of its tools, whatever the scale of the target."""
    found = mf.design(mf.LinearLaw(5.0), LATTICE, limits=mf.Limits(0.3), tools=KIT)
    sigma = np.broadcast_to(found.surface.friction.shear_strength, found.surface.count)
    made = [
        [tool for tool in KIT if tool.radius == radius and (tool.shear_strength or 0.4) == own]
        for radius, own in zip(found.surface.radius, sigma, strict=True)
    ]
    assert [tool.cap for (tool,) in made] == [found.surface.cap.one(i) for i in range(found.surface.count)]
    counts = [sum(tool == one for (one,) in made) for tool in KIT]
    assert found.parameters["tool_counts"].tolist() == counts
    area = mf.equilibrium(found.surface, ELASTIC, load=0.2).asperity_area
    law = mf.friction_law(found.surface, ELASTIC, load=[0.2])
    assert law.friction_force[0] == pytest.approx(0.85 * sigma @ area, rel=1e-10)
    assert law.rescaled_friction[0] == pytest.approx(law.friction_force[0] / (0.85 * sigma.max()), rel=1e-10)


@pytest.mark.parametrize("kit", [KIT, UNCOATED], ids=["coated", "uncoated"])
def test_random_surfaces_are_within_the_bounds_of_their_kit(kit):
    rng, load = np.random.default_rng(2), np.geomspace(0.01, 0.5, 20)
    low, high = mf.feasible_region(CELL.only(slice(6)), load, mf.Limits(1.0), kit, mf.Elastic())
    for seed in range(50):
        surface = scene(seed, kit, 6).replaced(height=rng.uniform(0.0, 0.05, 6))
        force = mf.friction_law(surface, ELASTIC, load=1.36 * load).friction_force
        assert (low * (1.0 - 1e-9) <= force / 0.34).all()
        assert (force / 0.34 <= high).all()


def test_points_on_coated_sites_are_met_exactly():
    """The forces at the points are sums over the contacts of the design."""
    load, force = np.array([0.05, 0.1, 0.2]), np.array([0.07, 0.14, 0.25])
    target = mf.OperatingPoints.from_forces(load, force, MATERIAL, COATED)
    design = mf.design(target, template(), limits=mf.Limits(0.27))
    assert design.status is mf.DesignStatus.EXACT
    for each, expected in zip(load, force, strict=True):
        state = mf.equilibrium(design.surface, load=each)
        assert 0.4 * 0.85 * WEIGHT @ state.asperity_area == pytest.approx(expected, rel=1e-9)


def test_an_exponent_below_that_of_one_friction():
    """Below 2/3, the smallest exponent of A0 for paraboloids of one radius."""
    target, limits = mf.PowerLaw(0.6, (0.05, 0.1)), mf.Limits(0.27)
    with pytest.raises(mf.Infeasible):
        mf.design(target, template(FRICTION), limits=limits)
    assert mf.design(target, template(), limits=limits).misfit < 0.01


def recovered(seed, model):
    """Return the design for the law of known heights on coated sites, and the misfit of its forces."""
    height, load = np.random.default_rng(seed).uniform(0.15, 0.25, 16), np.linspace(0.02, 0.12, 10)
    force = mf.friction_law(template().replaced(height=height), model, load=load).friction_force
    target = mf.SampledLaw.from_forces(load, force, MATERIAL, COATED)
    design = mf.design(target, template(), model, mf.Limits(0.27))
    assert design.surface.friction == COATED
    found = mf.friction_law(design.surface, model, load=load).friction_force
    return design, np.sqrt(((found / force - 1.0) ** 2).mean())


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting()], ids=repr)
def test_the_law_of_known_heights_is_recovered(model):
    design, misfit = recovered(0, model)
    assert design.misfit < 2e-3
    assert misfit == pytest.approx(design.misfit, rel=1e-9)


def test_equal_frictions_give_the_design_of_one_friction():
    one, equal = (
        mf.design(mf.PowerLaw(0.8, (0.05, 0.1)), template(friction), limits=mf.Limits(0.27))
        for friction in (FRICTION, mf.Friction([0.4] * 16, 0.85))
    )
    assert one.surface == equal.surface
    assert one.law == equal.law
