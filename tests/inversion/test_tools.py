"""Searches with tools of several radii, and caps."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import achievable_load_range
from tests.core.inversion.test_tools import ELASTIC, KIT, LATTICE, LIMITS
from validation.benchmark import designs

RANGE = mf.PowerRange(1.2, 6.0)
TALL, LAYER = mf.Limits(0.27), mf.Interacting(substrate=mf.BondedLayer(7.2, 0.5))
COUPLED = mf.Interacting(contact=mf.Elastic())
TWO, RADII = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4))], mf.RadiusRange(0.2, 0.8)


@pytest.mark.parametrize("exponent", [0.5, 1.4])
def test_powers_beyond_those_of_one_cap_are_met_by_a_range_of_exponents(exponent, tmp_path):
    found = mf.design(mf.PowerLaw(exponent, (0.1, 0.4)), LATTICE, limits=LIMITS, tools=RANGE)
    assert found.misfit <= 5e-3
    used, counts = (found.parameters[name] for name in ("used_exponents", "exponent_counts"))
    assert counts.sum() == found.surface.count
    assert 1.2 <= used.min() <= used.max() <= 6.0
    np.testing.assert_allclose(used * 10.0, np.rint(used * 10.0), rtol=1e-12)
    mf.save(found, tmp_path / "design")
    assert mf.load(tmp_path / "design") == found


@pytest.mark.parametrize("seed", [0, 3])
def test_laws_of_cells_with_random_exponents_are_recovered(seed):
    rng, load = np.random.default_rng(seed), np.linspace(0.01, 0.3, 30)
    template = mf.Surface.square_lattice(0.15, (2, 3), radius=0.526, material=mf.Material(1.36))
    cap = [mf.Power(n) for n in rng.uniform(1.3, 5.0, 6)]
    surface = template.replaced(height=rng.uniform(0.05, 0.15, 6), cap=cap)
    target = mf.SampledLaw(load, ELASTIC.curve(surface, load).area)
    assert mf.design(target, template, limits=mf.Limits(0.15), tools=RANGE).misfit <= 2e-3


def test_a_law_of_one_tool_or_of_two_is_met_by_a_kit_that_holds_them():
    """One tool is used if it reaches the target."""
    load = np.linspace(0.02, 0.2, 30)
    one = LATTICE.replaced(height=np.linspace(0.2, 0.3, 64), radius=0.3, cap=mf.Power(4))
    target = mf.SampledLaw(load, ELASTIC.curve(one, load).area)
    found = mf.design(target, LATTICE, limits=LIMITS, tools=KIT)
    assert found.misfit <= 2e-3
    assert found.surface.cap in (mf.Sphere(), mf.Power(4))
    twelve = LATTICE.only(slice(12))
    two = twelve.replaced(
        height=np.linspace(0.2, 0.3, 12), cap=[tool.cap for tool in TWO] * 6, radius=[0.526, 0.3] * 6
    )
    target = mf.SampledLaw(load, ELASTIC.curve(two, load).area)
    kit = [*TWO, mf.Tool(0.52), mf.Tool(0.31, mf.Power(4)), mf.Tool(0.3, mf.Power(3.9))]
    found = mf.design(target, LATTICE, limits=LIMITS, tools=kit)
    assert found.misfit <= 2.5e-3
    area = ELASTIC.curve(found.surface, load).area
    rms = np.sqrt(((area / target.rescaled_friction - 1.0) ** 2).mean())
    assert rms == pytest.approx(found.misfit, abs=1e-9)
    made = [(radius, found.surface.cap.one(i)) for i, radius in enumerate(found.surface.radius)]
    counts = [made.count((tool.radius, tool.cap)) for tool in kit]
    assert counts == found.parameters["tool_counts"].tolist()


def test_heights_are_refined_and_arranged_under_the_model():
    assert mf.design(mf.PowerLaw(1.2, (0.1, 0.4)), LATTICE, COUPLED, LIMITS, tools=KIT).misfit <= 0.01
    target, template = mf.PowerLaw(0.6, (0.01, 0.03)), LATTICE.only(slice(16))
    found = mf.arrange(mf.design(target, template, COUPLED, LIMITS, tools=TWO), 0.0005)
    assert found.parameters["tilt_after"] <= found.parameters["tilt_before"]
    assert found.misfit <= 0.01


@pytest.mark.nightly
def test_a_line_that_is_missed_states_the_range_that_tools_reach():
    ends = achievable_load_range(mf.LinearLaw(8.0), LATTICE, LIMITS, TWO, mf.Elastic())
    assert mf.design(mf.LinearLaw(8.0, ends), LATTICE, limits=LIMITS, tools=TWO).misfit <= 0.01


@pytest.mark.parametrize(
    ("exponent", "tools", "model"),
    [
        (0.645, RADII, LAYER),
        (0.645, [0.2, 0.8], None),
        (1.55, [0.2, 0.8], mf.Interacting()),
        (1.5, RADII, None),
    ],
)
def test_powers_beyond_one_radius(template, exponent, tools, model):
    """One radius has at least 2/3, and reaches about 1.44 within 1 % over this range."""
    result = mf.design(mf.PowerLaw(exponent, (0.1, 0.4)), template, model, TALL, tools=tools)
    assert result.misfit <= 6e-3
    allowed = {i / 20 for i in range(4, 17)} if tools is RADII else {0.2, 0.8}
    assert set(result.surface.radius) <= allowed
    if exponent < 2 / 3:
        assert len(set(result.surface.radius)) > 1


@pytest.mark.parametrize(("kind", "number"), [("two summits", 14), ("two summits", 37), ("cells", 109)])
def test_the_verdict_on_laws_of_mixtures_does_not_depend_on_the_seed(kind, number):
    """Several seeds missed these laws while tools were exchanged in pairs."""
    for seed in range(4):
        assert designs.outcome(kind, number, seed).misfit <= 2e-3


@pytest.mark.parametrize("seed", range(3))
def test_laws_of_random_mixtures_are_recovered(seed):
    rng, load = np.random.default_rng(seed), np.linspace(0.02, 0.5, 30)
    lattice = mf.Surface.square_lattice(0.12, radius=1.0, material=mf.Material(1.0))
    radius = rng.choice([0.2, 0.5, 0.9], 64, p=[0.3, 0.3, 0.4])
    mixed = lattice.replaced(height=rng.exponential(0.03, 64), radius=radius)
    target = mf.SampledLaw(load, mf.friction_law(mixed, load=load).area)
    result = mf.design(target, lattice, limits=mf.Limits(0.4), tools=[0.2, 0.5, 0.9])
    assert result.misfit <= 2.5e-3


@pytest.mark.parametrize(("tools", "model"), [([0.2, 0.8], mf.Interacting()), (RADII, LAYER)])
def test_points_below_those_of_one_radius_are_met(template, tools, model):
    """F grows by less than P^(2/3)."""
    target = mf.OperatingPoints([0.144, 0.336], [0.84, 0.84 * (0.336 / 0.144) ** 0.65])
    assert mf.design(target, template, model, TALL, tools=tools).misfit <= 1e-9


def test_proportional_laws_and_branches_take_tools(template):
    wide = achievable_load_range(mf.LinearLaw(12.0), template, TALL, [0.2, 0.8])
    narrow = achievable_load_range(mf.LinearLaw(12.0), template, TALL, [0.2])
    assert wide[1] / wide[0] > 1.5 * narrow[1] / narrow[0]
    assert mf.design(mf.LinearLaw(12.0, wide), template, limits=TALL, tools=[0.2, 0.8]).misfit <= 0.01
    target = mf.MultilinearLaw([6.0, 12.0], [0.15], (0.1, 0.3))
    assert mf.design(target, template, limits=TALL, tools=[0.2, 0.8]).misfit <= 2e-3
    # of small radii no intercept leaves the nearest law positive: that is no perfect hit
    target = mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26))
    assert mf.design(target, template, limits=TALL, tools=[0.2, 0.526]).misfit < 0.01
