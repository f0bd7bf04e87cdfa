"""Tools with a shear strength: the search chooses cap, radius and coating of each asperity."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.tools.kit_bounds import least_ratio

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


POWERS = (
    mf.Tool(0.5, mf.Power(2)),
    mf.Tool(0.5, mf.Power(2), shear_strength=0.1),
    mf.Tool(0.3, mf.Power(4), 0.8),
)


@pytest.mark.parametrize(
    ("count", "seed"),
    [(5, 6), (5, 7), (8, 4), *(pytest.param(8, seed, marks=pytest.mark.slow) for seed in (0, 1, 2, 3, 5, 6))],
)
def test_the_law_of_known_coated_tools_is_recovered(count, seed):
    load = np.linspace(0.01, 0.3, 30)
    known = forces_of(scene(seed, POWERS, count), load)
    target = mf.SampledLaw.from_forces(load, known, MATERIAL, FRICTION)
    found = mf.design(target, CELL, limits=LIMITS, tools=POWERS)
    assert found.misfit <= 2e-3
    np.testing.assert_allclose(forces_of(found.surface, load), known, rtol=0.01)
    rms = np.sqrt(((forces_of(found.surface, load) / known - 1.0) ** 2).mean())
    assert rms == pytest.approx(found.misfit, abs=1e-9)
    np.testing.assert_allclose(found.law.friction_force, forces_of(found.surface, found.law.load), rtol=1e-9)


def sampled(surface, load, model=None):
    """Return the friction forces of a surface at loads [N] as a target."""
    law = mf.friction_law(surface, model, load=load)
    return mf.SampledLaw.from_forces(load, law.friction_force, MATERIAL, FRICTION), law.friction_force


def test_forces_are_sums_over_the_tools_of_the_asperities():
    """The frictions of the surface are those of its tools, whatever the scale of the target."""
    target, _ = sampled(scene(1, KIT, 4), np.linspace(0.01, 0.3, 30), ELASTIC)
    found = mf.design(target, CELL, limits=LIMITS, tools=KIT)
    sigma = found.surface.friction.shear_strength
    made = [
        [tool for tool in KIT if tool.radius == radius and (tool.shear_strength or 0.4) == own]
        for radius, own in zip(found.surface.radius, sigma, strict=True)
    ]
    assert [tool.cap for (tool,) in made] == [found.surface.cap.one(i) for i in range(found.surface.count)]
    counts = [sum(tool == one for (one,) in made) for tool in KIT]
    assert found.parameters["tool_counts"].tolist() == counts
    assert "one more asperity" not in repr(found)
    for load in (0.05, 0.2):
        state = mf.equilibrium(found.surface, ELASTIC, load=load)
        law = mf.friction_law(found.surface, ELASTIC, load=[load])
        assert law.friction_force[0] == pytest.approx(0.85 * sigma @ state.asperity_area, rel=1e-10)
        assert law.rescaled_friction[0] == pytest.approx(sigma / 0.4 @ state.asperity_area, rel=1e-10)


def test_the_exponent_of_a_coated_kit_is_below_those_of_its_areas():
    """Forces that level off: first contacts of a strong coating, then many of a weak one."""
    target, limits = mf.PowerLaw(0.55, (0.05, 0.1)), mf.Limits(0.27)
    template = LATTICE.only(slice(16))
    bare = [mf.Tool(0.526, mf.Paraboloid())]
    with pytest.raises(mf.Infeasible, match=r"at least 0\.6667"):
        mf.design(target, template, limits=limits, tools=bare)
    found = mf.design(target, template, limits=limits, tools=PARABOLOIDS)
    assert found.misfit <= 0.01
    load = 1.36 * np.geomspace(0.05, 0.1, 20)
    force = forces_of(found.surface, load)
    assert np.ptp(np.log(force / load**0.55)) <= 0.04


def test_a_common_coated_tool():
    found = mf.design(
        mf.LinearLaw(1.5), LATTICE, limits=mf.Limits(0.3), tools=PARABOLOIDS, common_radius=True
    )
    assert found.parameters["tool_counts"].tolist() == [0, found.surface.count]
    np.testing.assert_array_equal(found.surface.friction.shear_strength, 0.1)
    (_, fit), slope = found.fits[0], found.fits[0][0].slope
    assert fit.slope == pytest.approx(slope, rel=0.1)
    assert fit.friction_coefficient == pytest.approx(fit.slope * 0.34 / 1.36, rel=1e-12)


def test_shear_strengths_of_the_template_are_those_of_no_coating():
    target = mf.LinearLaw(7.0)
    plain = mf.design(target, LATTICE, limits=mf.Limits(0.3), tools=[0.2, 0.8])
    coated = [mf.Tool(0.2, shear_strength=0.4), mf.Tool(0.8)]
    assert mf.design(target, LATTICE, limits=mf.Limits(0.3), tools=coated) == plain


def test_random_coated_surfaces_are_within_the_bounds_of_their_kit():
    rng, load = np.random.default_rng(2), np.geomspace(0.01, 0.5, 20)
    template = CELL.only(slice(6))
    low, high = mf.feasible_region(template, load, mf.Limits(1.0), POWERS, mf.Elastic())
    for seed in range(50):
        surface = scene(seed, POWERS, 6).replaced(height=rng.uniform(0.0, 0.05, 6))
        force = mf.friction_law(surface, ELASTIC, load=1.36 * load).friction_force
        assert (low * (1.0 - 1e-9) <= force / 0.34).all()
        assert (force / 0.34 <= high).all()


def test_exponents_that_no_coating_reaches_are_refused_with_the_bound():
    least = 2.0 / 3.0 * least_ratio(64, 4.0)
    with pytest.raises(mf.Infeasible, match=f"at least {least:.4g} .* with 64 asperities of 2 tools"):
        mf.design(mf.PowerLaw(0.1, (0.1, 0.4)), LATTICE, limits=mf.Limits(0.3), tools=PARABOLOIDS)


def test_the_least_ratio_of_weighted_sums_is_that_of_random_sizes_and_weights():
    rng = np.random.default_rng(1)
    a, w = np.exp(rng.uniform(-8.0, 0.0, (400000, 3))), rng.choice([1.0, 0.2], (400000, 3))
    ratio = (w**0.5 * a**1.5).sum(axis=1) ** 2 / (a.sum(axis=1) * (w * a**2).sum(axis=1))
    assert least_ratio(3, 5.0) <= ratio.min() <= least_ratio(3, 5.0) * 1.001
