"""A radius for each asperity, tools mixed on one surface, and the best common radius."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus
from tests.models.scenes import said

TOOLS = [0.2, 0.8]
RANGE = mf.RadiusRange(0.2, 0.8)
LIMITS = mf.Limits(0.27)

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


@pytest.mark.slow
def test_proportional_laws_and_branches_take_tools(template):
    wide = mf.achievable_load_range(mf.LinearLaw(12.0), template, LIMITS, TOOLS)
    narrow = mf.achievable_load_range(mf.LinearLaw(12.0), template, LIMITS, TOOLS[:1])
    assert wide[1] / wide[0] > 1.5 * narrow[1] / narrow[0]
    assert mf.design(mf.LinearLaw(12.0, wide), template, limits=LIMITS, tools=TOOLS).misfit <= 0.01
    target = mf.MultilinearLaw([6.0, 12.0], [0.15], (0.1, 0.3))
    assert mf.design(target, template, limits=LIMITS, tools=TOOLS).misfit <= 1e-3


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


def test_a_range_is_searched_around_its_best(template):
    target = mf.PowerLaw(1.2, (0.1, 0.4))
    result = mf.design(
        target, template, limits=mf.Limits(0.27), tools=mf.RadiusRange(0.3, 0.8), common_radius=True
    )
    assert len(result.parameters["tried_radii"]) > 7
    assert 0.3 <= result.parameters["radius"] <= 0.8
    assert result.status is DesignStatus.REACHED
