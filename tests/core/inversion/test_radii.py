"""A radius for each asperity, tools mixed on one surface, and the best common radius."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.inversion.height_density import ExponentialDensity
from metafem.inversion.search.asperities import OfRadii
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.strategies.mixture import Mixture
from metafem.inversion.tools.radii import Radii

TOOLS = [0.2, 0.8]

LIMITS = mf.Limits(0.27)
COMMON, THREE = mf.Limits(0.12, offset=0.05, height_sd=0.0009), [0.8, 0.2, 0.526]


@pytest.mark.parametrize("common", [False, True])
@pytest.mark.parametrize(("step", "most"), [(0.01, 61), (0.07, 11), (0.6, 3)])
def test_radii_of_a_range_are_those_of_tools(template, step, most, common):
    radii = mf.RadiusRange(0.2, 0.8, step)
    assert radii.step == mf.RadiusRange(0.2, 0.8).step or step != 0.01
    result = mf.design(mf.LinearLaw(4.5), template, limits=LIMITS, tools=radii, common_radius=common)
    tools = {0.2, 0.8, *(round(i * step, 12) for i in range(1000) if 0.2 < i * step < 0.8)}
    assert len(tools) == most
    assert {*result.surface.radius, *result.parameters["tried_radii"]} <= tools
    law = mf.friction_law(result.surface, load=result.law.load)
    np.testing.assert_allclose(law.area, result.law.area, rtol=1e-12)
    assert common or result.tools == radii


def test_one_tool_that_reaches_the_law_is_preferred(template):
    result = mf.design(mf.PowerLaw(1.2, (0.1, 0.4)), template, limits=LIMITS, tools=TOOLS)
    assert len(result.parameters["used_radii"]) == 1


def test_levels_of_different_radii_meet_points():
    """With three asperities, one radius cannot: the second point needs a large one after small ones."""
    three = mf.Surface.square_lattice(0.3, (1, 4), radius=1.0, material=mf.Material(1.0))
    built = three.replaced(height=[0.3, 0.3, 0.27, 0.25], radius=[0.1, 0.1, 2.0, 2.0])
    law = mf.friction_law(built, separation=[0.265, 0.2])
    target = mf.OperatingPoints(law.rescaled_load, law.rescaled_friction)
    with pytest.raises(mf.Infeasible):
        mf.design(target, three, limits=mf.Limits(0.3), tools=[0.1, 2.0], common_radius=True)
    result = mf.design(target, three, limits=mf.Limits(0.3), tools=[0.1, 2.0])
    assert result.misfit <= 1e-9
    assert set(result.surface.radius) == {0.1, 2.0}


def test_a_mixture_has_the_law_of_its_mean_radius():
    mixture = Mixture((0.2, 0.8), (3000, 1000))
    density = ExponentialDensity(0.03, 0.12)
    height = np.sort(-0.03 * np.log1p(-np.linspace(0.0, -np.expm1(-4.0), 4001)[1:]))[::-1]
    load = np.linspace(1.0, 10.0, 5)
    area = mf.Independent().curves(height, mixture.mixed(), load)[2][0]
    delta = np.linspace(0.12, 0.0, 2000)
    expected = np.interp(
        load, density.rescaled_load(delta, *mixture.asperities), density.area(delta, *mixture.asperities)
    )
    np.testing.assert_allclose(area, expected, rtol=2e-3)  # the ends of 4,000 intervals, not their middles


def test_a_mixture_reaches_between_the_tools(template):
    """10 times height_sd = 3 um leaves a gap between the slopes of the two tools."""
    limits = mf.Limits(0.12, offset=0.1, height_sd=0.003)
    friction = template.friction
    per_slope = friction.shear_strength * friction.area_ratio / template.material.composite_modulus
    low, high = (
        np.array(mf.achievable_friction_coefficients(template, limits, [radius])) / per_slope
        for radius in (0.2, 1.6)
    )
    slope = 0.5 * (low[1] + high[0])
    result = mf.design(mf.LinearLaw(slope), template, limits=limits, tools=[0.2, 1.6])
    assert result.parameters["used_radii"].tolist() == [0.2, 1.6]
    assert result.status is DesignStatus.APPROXIMATE
    assert not [note for note in result.notes if "height_sd" in note.text]
    reach = result.parameters["reachable_coefficients"] / per_slope
    np.testing.assert_allclose(reach, [low[0], high[1]])
    # without height_sd no largest slope is known, and one number is no range
    result = mf.design(mf.LinearLaw(slope), template, limits=mf.Limits(0.12, offset=0.1), tools=[0.2, 1.6])
    assert "reachable_coefficients" not in result.parameters
    assert result.parameters["lowest_coefficients"].shape == (2,)


@pytest.mark.parametrize("cap", [mf.Hertz(), mf.PowerCap(4), mf.SphericalCap()], ids=repr)
def test_gradients_by_radii_are_those_of_differences(cap):
    model, rng = mf.Independent(contact=cap), np.random.default_rng(1)
    space = OfRadii(1.0, 9, radii=Radii(0.1, 2.0, None), depth=0.05)
    target = TargetLaw.fixed(np.array([0.05, 0.2]), np.ones(2))
    at = space.joined(rng.uniform(0.1, 0.2, 9), rng.uniform(0.2, 0.8, 9))

    def law(unknowns):
        area, gradient = space.residual(model, target)(unknowns)
        return area, gradient()

    step = 1e-5
    for i in range(9, 18):
        e = step * np.eye(18)[i]
        slope = (
            (8.0 * (law(at + e)[0] - law(at - e)[0]) - law(at + 2 * e)[0] + law(at - 2 * e)[0]) / 12 / step
        )
        np.testing.assert_allclose(law(at)[1][:, i], slope, atol=1e-7)


def test_a_template_of_one_radius_is_the_default_choice(template):
    one = mf.design(mf.LinearLaw(7.0), template, limits=LIMITS, rng=1)
    assert one.tools is None
    same = mf.design(mf.LinearLaw(7.0), template, limits=LIMITS, rng=1, tools=[0.526])
    np.testing.assert_array_equal(same.surface.height, one.surface.height)
    assert same.tools == (0.526,)
    with pytest.raises(mf.InvalidInput, match="common_radius = 1 must be True or False"):
        mf.design(mf.LinearLaw(7.0), template, common_radius=1)


def test_a_law_of_one_tool_is_designed_with_it(template):
    """Six equal asperities of R carry A0 = pi R^(2/3) 6^(1/3) (3p/4)^(2/3), the most that N = 6 can."""
    six = mf.Surface.square_lattice(0.1, (2, 3), radius=1.0, material=mf.Material(1.36))
    load = np.linspace(0.01, 0.1, 8)
    law = mf.Independent().curve(six.replaced(radius=np.full(6, 0.4)), load)
    result = mf.design(
        mf.SampledLaw(load, law.area), six, limits=mf.Limits(0.5), tools=[0.3, 0.4, 0.5], common_radius=True
    )
    assert result.parameters["radius"] == 0.4
    assert result.misfit < 1e-3
    np.testing.assert_array_equal(result.surface.radius, 0.4)


def test_reach_of_each_tool_is_told(template):
    result = mf.design(mf.LinearLaw(7.0), template, limits=COMMON, tools=THREE, common_radius=True)
    found = result.parameters
    assert found["tried_radii"].tolist() == sorted(THREE)
    assert found["radius"] in THREE
    assert result.misfit == found["radius_misfits"].min()
    for i, radius in enumerate(found["tried_radii"]):
        bounds = mf.achievable_friction_coefficients(template.replaced(radius=radius), COMMON)
        assert (found["lowest_coefficients"][i], found["highest_coefficients"][i]) == bounds


def test_tools_out_of_reach_are_noted(template):
    """A slope below 3 pi/4 sqrt(R/h) asks for a smaller radius."""
    result = mf.design(mf.LinearLaw(4.5), template, limits=COMMON, tools=THREE, common_radius=True)
    assert result.parameters["radius"] == 0.2
    assert (
        "radii that cannot reach the target [mm]: 0.526, 0.8; slope 4.5 is not above" in result.notes[-1].text
    )
