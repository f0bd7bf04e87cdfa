"""Tools of several radii and caps: bounds, steps of ranges, and one tool where it suffices."""

import numpy as np
import pytest

import metafem as mf

LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=mf.Material(1.36))
KIT = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4)), mf.Tool(0.6, mf.Power(1.5))]
LIMITS, ELASTIC = mf.Limits(0.3), mf.Independent(mf.Elastic())


def test_levels_of_different_radii_meet_points():
    """With three asperities, one radius cannot: the second point needs a large one after small ones."""
    three = mf.Surface.square_lattice(0.3, (1, 4), radius=1.0, material=mf.Material(1.0))
    built = three.replaced(height=[0.3, 0.3, 0.27, 0.25], radius=[0.1, 0.1, 2.0, 2.0])
    law = mf.friction_law(built, separation=[0.265, 0.2])
    target = mf.OperatingPoints(law.rescaled_load, law.rescaled_friction)
    for radius in (0.1, 2.0):
        with pytest.raises(mf.Infeasible):
            mf.design(target, three, limits=LIMITS, tools=[radius])
    result = mf.design(target, three, limits=LIMITS, tools=[0.1, 2.0])
    assert result.misfit <= 1e-9
    assert set(result.surface.radius) == {0.1, 2.0}


def test_one_tool_is_used_where_it_reaches_the_target():
    """A list of tools is one of radii where their caps are those of the template."""
    plain = mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS, rng=1)
    one = mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS, rng=1, tools=[0.526])
    assert (plain.tools, one.tools, one.surface) == (None, (0.526,), plain.surface)
    for given in ([0.2, 0.8], [mf.Tool(0.8), mf.Tool(0.2)]):
        mixed = mf.design(mf.PowerLaw(0.9, (0.1, 0.4)), LATTICE, limits=LIMITS, tools=given)
        assert len(set(mixed.surface.radius)) == 1
    kit = mf.design(mf.PowerLaw(0.9, (0.1, 0.4)), LATTICE, limits=LIMITS, tools=KIT)
    assert sorted(kit.parameters["tool_counts"].tolist()) == [0, 0, kit.surface.count]


def test_points_below_those_of_one_radius_are_met_by_two():
    """F grows by less than P^(2/3)."""
    target = mf.OperatingPoints([0.144, 0.336], [0.84, 0.84 * (0.336 / 0.144) ** 0.65])
    for radius in (0.2, 0.8):
        with pytest.raises(mf.Infeasible, match=r"point 2|at load"):
            mf.design(target, LATTICE, limits=LIMITS, tools=[radius])
    assert mf.design(target, LATTICE, limits=LIMITS, tools=[0.2, 0.8]).misfit <= 1e-9


def test_radii_of_a_range_are_those_of_its_steps(template):
    """By default 50 um up to 1 mm, and 0.1 mm above, as ball-end mills are sold."""
    np.testing.assert_allclose(mf.RadiusRange(0.83, 1.27).radii, [0.83, 0.85, 0.9, 0.95, 1.0, 1.1, 1.2, 1.27])
    tools = mf.RadiusRange(0.2, 0.8)
    found = mf.design(mf.LinearLaw(4.5), template, limits=LIMITS, tools=tools)
    assert found.tools == tools
    assert set(found.surface.radius) <= set(np.arange(4, 17) / 20)
