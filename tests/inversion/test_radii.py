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
from tests.models.scenes import said

TOOLS = [0.2, 0.8]
RANGE = mf.RadiusRange(0.2, 0.8)
LIMITS = mf.Limits(0.27)
COMMON, THREE = mf.Limits(0.12, offset=0.05, height_sd=0.0009), [0.8, 0.2, 0.526]
MODELS = [
    mf.Independent(),
    mf.Interacting(),
    mf.Interacting(substrate=mf.BondedLayer(7.2, 0.5)),
]


# The claim `several_radii` of the validation has all twelve cases.
CASES = [
    pytest.param(0.645, RANGE, MODELS[2], id="0.645-range-layer"),
    pytest.param(0.645, TOOLS, MODELS[0], id="0.645-tools-alone"),
    pytest.param(1.55, TOOLS, MODELS[1], id="1.55-tools-half-space"),
]


@pytest.mark.parametrize(("exponent", "radii", "model"), CASES)
def test_powers_beyond_one_radius(template, exponent, radii, model):
    """One radius has at least 2/3, and reaches about 1.44 within 1 % over this range."""
    result = mf.design(mf.PowerLaw(exponent, (0.1, 0.4)), template, model, LIMITS, tools=radii)
    assert result.misfit <= 1.5e-3
    moved = "heights were moved" in said(result)
    assert result.status is (DesignStatus.REFINED if moved else DesignStatus.REACHED)
    assert model.couples or not moved
    assert 0.2 <= result.surface.radius.min() < result.surface.radius.max() <= 0.8
    if radii is RANGE:
        assert set(result.surface.radius) <= {i / 100 for i in range(20, 81)}
    else:
        assert set(result.surface.radius) == set(TOOLS)
        assert result.parameters["radius_counts"].sum() == result.surface.count


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


def test_a_step_is_no_larger_than_its_range_whose_ends_are_tried():
    with pytest.raises(
        mf.InvalidInput, match=r"step = 0.01 exceeds the range from 0.523 to 0.529; give a smaller step"
    ):
        mf.RadiusRange(0.523, 0.529)
    tried = Radii.given(mf.RadiusRange(0.207, 0.803)).tried
    assert (tried[0], tried[-1]) == (0.207, 0.803)


def test_a_step_of_radii_is_positive_or_none():
    assert mf.RadiusRange(0.2, 0.8, None).step is None
    with pytest.raises(mf.InvalidInput, match="step = 0 must be greater than 0"):
        mf.RadiusRange(0.2, 0.8, 0.0)


@pytest.mark.parametrize("seed", range(8))
def test_laws_of_random_mixtures_are_recovered(seed):
    rng = np.random.default_rng(seed)
    lattice = mf.Surface.square_lattice(0.12, radius=1.0, material=mf.Material(1.0))
    mixed = lattice.replaced(
        height=rng.exponential(0.03, 64), radius=rng.choice([0.2, 0.5, 0.9], 64, p=[0.3, 0.3, 0.4])
    )
    load = np.linspace(0.02, 0.5, 30)
    target = mf.SampledLaw(load, mf.friction_law(mixed, load=load).area)
    result = mf.design(target, lattice, limits=mf.Limits(0.4), tools=[0.2, 0.5, 0.9])
    assert result.misfit <= 2e-3


def test_one_tool_that_reaches_the_law_is_preferred(template):
    result = mf.design(mf.PowerLaw(1.2, (0.1, 0.4)), template, limits=LIMITS, tools=TOOLS)
    assert len(result.parameters["used_radii"]) == 1


@pytest.mark.parametrize(
    "model",
    [MODELS[0], *(pytest.param(model, marks=pytest.mark.slow) for model in MODELS[1:])],
    ids=["alone", "half-space", "layer"],
)
@pytest.mark.parametrize(
    "radii", [TOOLS, pytest.param(RANGE, marks=pytest.mark.slow)], ids=["tools", "range"]
)
def test_points_below_those_of_one_radius_are_met(template, radii, model):
    """F grows by less than P^(2/3)."""
    target = mf.OperatingPoints([0.144, 0.336], [0.84, 0.84 * (0.336 / 0.144) ** 0.65])
    with pytest.raises(mf.Infeasible, match=r"no radius .* point 2"):
        mf.design(target, template, limits=LIMITS, tools=TOOLS, common_radius=True)
    result = mf.design(target, template, model, LIMITS, tools=radii)
    assert result.misfit <= 1e-9
    assert result.status is DesignStatus.EXACT


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


@pytest.mark.slow
def test_proportional_laws_and_branches_take_tools(template):
    wide = mf.achievable_load_range(mf.LinearLaw(12.0), template, LIMITS, TOOLS)
    narrow = mf.achievable_load_range(mf.LinearLaw(12.0), template, LIMITS, TOOLS[:1])
    assert wide[1] / wide[0] > 1.5 * narrow[1] / narrow[0]
    assert mf.design(mf.LinearLaw(12.0, wide), template, limits=LIMITS, tools=TOOLS).misfit <= 0.01
    target = mf.MultilinearLaw([6.0, 12.0], [0.15], (0.1, 0.3))
    assert mf.design(target, template, limits=LIMITS, tools=TOOLS).misfit <= 1e-3


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


def test_a_target_beyond_all_radii_says_why(template):
    with pytest.raises(mf.Infeasible, match=r"at least 0\.6283 .* radii from 0\.2 to 0\.8 mm"):
        mf.design(mf.PowerLaw(0.62, (0.1, 0.4)), template, limits=LIMITS, tools=TOOLS)
    with pytest.raises(mf.Infeasible, match=r"no radius reaches the target: with a radius of 0\.2 mm"):
        mf.design(mf.LinearLaw(1.0), template, limits=LIMITS, tools=TOOLS)


def test_a_mixed_design_survives_its_files(template, tmp_path):
    limits = mf.Limits(0.15, offset=0.02)
    result = mf.design(mf.PowerLaw(1.5, (0.1, 0.3)), template, limits=limits, tools=RANGE)
    mf.save(result, tmp_path / "mixed")
    again = mf.load(tmp_path / "mixed")
    np.testing.assert_array_equal(again.surface.radius, result.surface.radius)
    assert again.tools == RANGE


def test_branches_far_from_those_of_one_tool_are_designed_with_the_other(template):
    """Of small radii no intercept leaves the nearest law positive: that is no perfect hit."""
    target = mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26))
    assert mf.design(target, template, limits=LIMITS, tools=[0.2, 0.526]).misfit < 1e-3
    assert mf.design(target, template, limits=LIMITS, tools=[0.2]).misfit > 0.1


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


def test_a_range_is_searched_around_its_best(template):
    target = mf.PowerLaw(1.2, (0.1, 0.4))
    result = mf.design(
        target, template, limits=mf.Limits(0.27), tools=mf.RadiusRange(0.3, 0.8), common_radius=True
    )
    assert len(result.parameters["tried_radii"]) > 7
    assert 0.3 <= result.parameters["radius"] <= 0.8
    assert result.status is DesignStatus.REACHED


def test_a_target_beyond_all_common_radii_says_why(template):
    with pytest.raises(
        mf.Infeasible, match=r"no radius .* of 0.2 mm, slope 1 .* of 0.8 mm, slope 1"
    ) as caught:
        mf.design(mf.LinearLaw(1.0), template, limits=COMMON, tools=THREE, common_radius=True)
    near = mf.design(caught.value.nearest, template, limits=COMMON, tools=THREE, common_radius=True)
    assert near.parameters["radius"] == 0.2


@pytest.mark.parametrize(
    ("radii", "words"),
    [
        ([], "tools"),
        ([0.3, -0.1], r"tools\[1\] = -0.1 must be greater than 0"),
        ([0.3, np.nan], "tools"),
    ],
)
def test_bad_radii_are_named(template, radii, words):
    with pytest.raises(mf.InvalidInput, match=words):
        mf.design(mf.LinearLaw(7.0), template, tools=radii, common_radius=True)


def test_a_range_must_increase():
    with pytest.raises(mf.InvalidInput, match=r"high = 0\.2 must be greater than 0\.3"):
        mf.RadiusRange(0.3, 0.2)
