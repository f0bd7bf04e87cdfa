"""Tools with a shear strength: the search chooses cap, radius and coating of each asperity."""

import numpy as np
import pytest

import metafem as mf

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.4, 0.85)
CELL = mf.Surface.square_lattice(0.15, (3, 4), radius=0.526, material=MATERIAL, friction=FRICTION)
LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=MATERIAL, friction=FRICTION)
LIMITS = mf.Limits(0.15)

PARABOLOIDS = (mf.Tool(0.526, mf.Paraboloid()), mf.Tool(0.526, mf.Paraboloid(), shear_strength=0.1))


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


def sampled(surface, load, model=None):
    """Return the friction forces of a surface at loads [N] as a target."""
    law = mf.friction_law(surface, model, load=load)
    return mf.SampledLaw.from_forces(load, law.friction_force, MATERIAL, FRICTION), law.friction_force


@pytest.mark.parametrize("model", [mf.Interacting(), mf.MeanField()], ids=repr)
def test_heights_are_refined_under_the_model_with_the_frictions(model):
    tools = [mf.Tool(0.526), mf.Tool(0.526, shear_strength=0.1)]
    target, force = sampled(scene(3, tools), np.linspace(0.02, 0.3, 30), model)
    found = mf.design(target, CELL, model, LIMITS, tools=tools)
    assert found.misfit <= 2e-3
    law = mf.friction_law(found.surface, model, load=target.rescaled_load * 1.36)
    assert np.abs(law.friction_force / force - 1.0).max() <= 0.01


@pytest.mark.parametrize(
    "target",
    [
        mf.OperatingPoints([0.05, 0.1, 0.2], [0.2, 0.32, 0.58]),
        mf.MultilinearLaw([2.0, 2.8], [(0.1, 0.15)], (0.05, 0.3)),
        mf.LinearLaw(2.6, (0.05, 0.1)),
        mf.BilinearLaw([2.0, 3.4], 0.3),
        mf.Band([0.05, 0.1, 0.2], [0.2, 0.3, 0.5], [0.25, 0.35, 0.6]),
        mf.LinearLaw(2.0),
    ],
    ids=lambda target: type(target).__name__,
)
def test_every_kind_of_target_is_met_by_coated_tools(target):
    tools = [mf.Tool(0.526, shear_strength=0.1), mf.Tool(0.526, shear_strength=0.2)]
    found = mf.design(target, LATTICE, limits=mf.Limits(0.3), tools=tools)
    assert found.misfit <= (0.1 if found.density else 0.01)
    if isinstance(target, mf.OperatingPoints):
        assert found.misfit <= 1e-9
        force = mf.friction_law(found.surface, load=1.36 * target.rescaled_load).friction_force
        np.testing.assert_allclose(force, 0.34 * target.rescaled_friction, rtol=1e-8)
    assert found.parameters["tool_counts"].sum() == found.surface.count


def test_steps_prescribed_heights_and_tolerances_keep_the_coatings():
    limits = mf.Limits(0.15, height_step=0.002, pinned={9: 0.125, 3: None})
    tolerances = mf.Tolerances(height_sd=0.002, angle=0.0005)
    target, _ = sampled(scene(0, PARABOLOIDS, 4), np.linspace(0.01, 0.3, 30))
    found = mf.design(target, CELL, limits=limits, tools=PARABOLOIDS, robust=tolerances)
    assert found.parameters["tool_counts"].sum() == found.surface.count
    assert set(found.surface.friction.shear_strength) <= {0.1, 0.4}
    assert 3 not in found.sites
    force = mf.friction_law(found.surface, load=found.law.load).friction_force
    np.testing.assert_allclose(found.law.friction_force, force, rtol=1e-12)


def test_a_design_with_coated_tools_is_loaded_as_it_was_saved(tmp_path):
    target, _ = sampled(scene(0, PARABOLOIDS, 4), np.linspace(0.01, 0.3, 30))
    found = mf.design(target, CELL, limits=LIMITS, tools=PARABOLOIDS)
    mf.save(found, tmp_path / "design")
    assert mf.load(tmp_path / "design") == found
    assert found.tools == PARABOLOIDS
