"""Tools with caps of several shapes: lists of tools, ranges of exponents, their bounds and their refusals."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.search.asperities import OfExponents
from metafem.inversion.search.mixed_tools import grouped
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.tools.kit_bounds import least_ratio
from validation.scenes.cells import cell

LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=mf.Material(1.36))
CELL = mf.Surface.square_lattice(0.15, (2, 3), radius=0.526, material=mf.Material(1.36))
LIMITS, RANGE = mf.Limits(0.3), mf.PowerRange(1.2, 6.0)
ELASTIC = mf.Independent(mf.Elastic())
KIT = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4)), mf.Tool(0.6, mf.Power(1.5))]


def law_of(surface, load):
    """Return the law of a surface by bisection of the closed forms of its power caps."""
    gap = surface.height.max() - surface.height
    laws = [mf.PowerCap(cap.exponent, cap.coefficient) for cap in caps_of(surface)]

    def contacts(approach):
        depth = np.maximum(approach - gap, 0.0)
        a = [law.contact_radius(d, r) for law, d, r in zip(laws, depth, surface.radius, strict=True)]
        loads = [law.load(x, r) for law, x, r in zip(laws, a, surface.radius, strict=True)]
        return sum(loads), math.pi * sum(x * x for x in a)

    found = []
    for p in load:
        low, high = 0.0, 1.0
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if contacts(middle)[0] < p else (low, middle)
        found.append(contacts(low)[1])
    return np.array(found)


def caps_of(surface):
    return [surface.cap.one(i) for i in range(surface.count)]


def scene(seed, count=6):
    """Return the sampled law of a cell of random heights and exponents."""
    rng = np.random.default_rng(seed)
    cap = [mf.Power(n) for n in rng.uniform(1.3, 5.0, count)]
    surface = CELL.only(slice(count), height=rng.uniform(0.05, 0.15, count), cap=cap)
    load = np.linspace(0.01, 0.3, 30)
    return mf.SampledLaw(load, mf.friction_law(surface, ELASTIC, load=1.36 * load).area)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.5])
def test_power_laws_below_and_above_those_of_one_cap_are_met_by_a_range_of_exponents(exponent):
    found = mf.design(mf.PowerLaw(exponent, (0.1, 0.4)), LATTICE, limits=LIMITS, tools=RANGE)
    assert found.misfit <= 5e-3
    assert all(isinstance(cap, mf.Power) and 1.2 <= cap.exponent <= 6.0 for cap in caps_of(found.surface))
    used, counts = (found.parameters[name] for name in ("used_exponents", "exponent_counts"))
    np.testing.assert_allclose(used * 10.0, np.rint(used * 10.0), rtol=1e-12)
    assert counts.sum() == found.surface.count


def test_the_law_of_the_design_is_that_of_its_caps():
    found = mf.design(mf.PowerLaw(1.4, (0.1, 0.4)), LATTICE, limits=LIMITS, tools=RANGE)
    load = np.geomspace(0.1, 0.4, 30)
    area = law_of(found.surface, load)
    target = found.parameters["prefactor"] * load**1.4
    assert abs(np.sqrt(((area / target - 1.0) ** 2).mean()) - found.misfit) <= 1e-9


def test_laws_of_cells_with_random_exponents_are_recovered():
    for seed in range(5):
        found = mf.design(scene(seed), CELL, limits=mf.Limits(0.15), tools=RANGE)
        assert found.misfit <= 2e-3, seed


def test_a_single_tool_is_used_if_it_reaches_the_target():
    surface = LATTICE.replaced(height=np.linspace(0.2, 0.3, 64), radius=0.3, cap=mf.Power(4))
    load = np.linspace(0.02, 0.2, 30)
    law = mf.SampledLaw(load, mf.friction_law(surface, ELASTIC, load=1.36 * load).area)
    found = mf.design(law, LATTICE, limits=LIMITS, tools=KIT)
    assert found.misfit <= 2e-3
    assert found.surface.cap == mf.Power(4)
    assert found.parameters["tool_counts"].tolist() == [0, found.surface.count, 0]


@pytest.mark.parametrize(
    "target",
    [
        mf.OperatingPoints([0.05, 0.1, 0.2], [0.8, 1.15, 2.0]),
        mf.MultilinearLaw([9.0, 3.5], [(0.1, 0.15)], (0.05, 0.3)),
        mf.LinearLaw(8.0, (0.05, 0.1)),
        mf.Band([0.05, 0.1, 0.2], [0.4, 0.6, 0.9], [0.5, 0.7, 1.0]),
        mf.LinearLaw(7.0),
    ],
    ids=lambda target: type(target).__name__,
)
def test_every_kind_of_target_is_met_by_a_kit(target):
    found = mf.design(target, LATTICE, limits=LIMITS, tools=KIT)
    assert found.misfit <= (0.1 if found.density else 0.01)
    if isinstance(target, mf.OperatingPoints):
        assert found.misfit <= 1e-9
    assert found.parameters["tool_counts"].sum() == found.surface.count


def test_plain_radii_and_tools_of_one_cap_are_the_same():
    target = mf.PowerLaw(0.64, (0.1, 0.2))
    plain = mf.design(target, LATTICE, limits=LIMITS, tools=[0.2, 0.8])
    tools = mf.design(target, LATTICE, limits=LIMITS, tools=[mf.Tool(0.8), mf.Tool(0.2)])
    assert plain == tools
    assert plain.tools == (0.2, 0.8)


@pytest.mark.parametrize("area", [(math.pi, 2.0), (2.0, 1.0)], ids=["area", "stiffness"])
def test_gradients_by_exponents_are_those_of_differences(area):
    rng = np.random.default_rng(3)
    space = OfExponents(1.0, 9, range=mf.PowerRange(1.1, 7.0), radius=0.526, depth=0.05, area=area)
    residual = space.residual(ELASTIC, TargetLaw.fixed(np.array([0.05, 0.2]), np.ones(2)))
    at = space.joined(rng.uniform(0.1, 0.2, 9), rng.uniform(1.3, 5.0, 9))
    gradient, step = residual(at)[1](), 1e-5
    for i in range(18):
        e = step * np.eye(18)[i]
        first, second = (residual(at + k * e)[0] - residual(at - k * e)[0] for k in (1, 2))
        np.testing.assert_allclose(gradient[:, i], (8.0 * first - second) / (12.0 * step), atol=1e-7)


def test_no_random_contacts_have_a_smaller_local_exponent_than_the_bound():
    rng, least = np.random.default_rng(0), least_ratio(8)
    for _ in range(20000):
        count = int(rng.integers(1, 9))
        a, n = np.exp(rng.uniform(-9.0, 0.0, count)), rng.uniform(1.2, 6.0, count)
        depth = np.exp(rng.uniform(-9.0, 0.0, count))  # any size of the caps, so that d is free
        load, stiffness = 2.0 * n / (n + 1.0) * a * depth, 2.0 * a
        area, growth = a * a, 2.0 * a * a / (n * depth)
        exponent = load.sum() / stiffness.sum() * growth.sum() / area.sum()
        assert exponent >= 2.0 / 7.0 * least * (1.0 - 1e-12)


def test_the_least_ratio_of_sums_is_that_of_random_sizes():
    rng = np.random.default_rng(1)
    a = np.exp(rng.uniform(-6.0, 0.0, (100000, 3)))
    ratio = (a**1.5).sum(axis=1) ** 2 / (a.sum(axis=1) * (a**2).sum(axis=1))
    assert least_ratio(3) <= ratio.min() <= least_ratio(3) * 1.001


def test_laws_of_random_kits_are_within_their_bounds():
    rng, load = np.random.default_rng(2), np.geomspace(0.01, 0.5, 20)
    low, high = mf.feasible_region(CELL, load, mf.Limits(1.0), KIT, mf.Elastic())
    for _ in range(50):
        which = rng.integers(3, size=6)
        caps, radius = [KIT[i].cap for i in which], [KIT[i].radius for i in which]
        surface = CELL.replaced(height=rng.uniform(0.0, 0.05, 6), cap=caps, radius=radius)
        area = ELASTIC.curve(surface, load).area
        assert (low * (1.0 - 1e-9) <= area).all()
        assert (area <= high).all()


def test_exponents_that_no_tool_reaches_are_refused_with_the_bound():
    with pytest.raises(
        mf.Infeasible, match=r"at least 0\.1647 .* with 64 asperities of power caps of exponents"
    ):
        mf.design(mf.PowerLaw(0.1, (0.1, 0.4)), LATTICE, limits=LIMITS, tools=RANGE)
    with pytest.raises(mf.Infeasible, match=r"of 3 tools"):
        mf.design(mf.PowerLaw(9.0, (0.1, 0.4)), LATTICE, limits=LIMITS, tools=KIT)


@pytest.mark.parametrize(
    ("tools", "words"),
    [
        (lambda: [mf.Tool(0.0)], "radius = 0 must be greater than 0"),
        (lambda: [mf.Tool(0.3, mf.Power(1.0))], "exponent = 1 must be greater than 1"),
        (lambda: [mf.Tool(0.3, "sphere")], "cap = 'sphere' must be one cap"),
        (lambda: mf.PowerRange(1.0, 3.0), "low = 1 must be greater than 1"),
        (lambda: mf.PowerRange(4.0, 3.0), "high = 3 must be greater than 4"),
        (lambda: mf.PowerRange(2.0, 3.0, step=2.0), "step = 2 exceeds the range"),
        (lambda: [mf.Tool(0.3), "x"], r"tools\[1\] = 'x' must be a list of metafem.Tool"),
        (lambda: 3, "tools = 3 must be a list of metafem.Tool"),
        (lambda: [mf.Tool(0.9, mf.Power(4)), mf.Tool(0.3)], "a foot 1.6.* mm wide .* sites are 1.5 mm apart"),
        (lambda: [mf.Tool(0.2), mf.Tool(0.5, mf.Power(4))], "caps of at most 0.2 mm, but limits allow"),
    ],
)
def test_tools_that_do_not_fit_are_named(tools, words):
    with pytest.raises(mf.InvalidInput, match=words):
        mf.design(mf.PowerLaw(1.0, (0.1, 0.2)), LATTICE, limits=LIMITS, tools=tools())


def test_a_hollow_profile_is_no_tool():
    with pytest.raises(mf.InvalidInput, match="must begin with 0 and increase"):
        mf.Tool(0.5, mf.Profile([[0.0, 0.1, 0.2], [0.0, -0.01, 0.02]]))


def test_hertz_contacts_need_caps_with_a_curvature():
    with pytest.raises(mf.InvalidInput, match=r"use contact = Elastic\(\)"):
        mf.design(mf.PowerLaw(1.0, (0.1, 0.2)), LATTICE, mf.Independent(), LIMITS, tools=RANGE)


def test_a_template_with_several_caps_needs_tools():
    mixed = CELL.replaced(cap=[mf.Power(n) for n in (2, 3, 2, 3, 4, 4)])
    with pytest.raises(mf.InvalidInput, match="one common cap is needed here, and the argument tools allows"):
        mf.design(mf.PowerLaw(1.0, (0.1, 0.2)), mixed, ELASTIC)


def test_groups_of_exponents_are_means_of_neighbours():
    found = grouped(np.array([1.5, 1.6, 4.0, 4.1, 4.2]), 2)
    np.testing.assert_allclose(np.unique(found), [math.sqrt(2.4), (4.0 * 4.1 * 4.2) ** (1 / 3)])


def test_a_design_with_tools_is_loaded_as_it_was_saved(tmp_path):
    found = mf.design(scene(0), CELL, limits=mf.Limits(0.15), tools=RANGE)
    mf.save(found, tmp_path / "design")
    assert mf.load(tmp_path / "design") == found


@pytest.mark.parametrize("model", [mf.Interacting(contact=mf.Elastic()), mf.MeanField(mf.Elastic())])
def test_heights_are_refined_under_the_model(model):
    found = mf.design(mf.PowerLaw(1.2, (0.1, 0.4)), LATTICE, model, LIMITS, tools=KIT)
    assert found.misfit <= 0.01


def test_prescribed_heights_steps_and_layouts_keep_the_caps():
    limits = mf.Limits(0.3, height_step=0.002, pinned={9: 0.25, 3: None})
    tools = [mf.Tool(0.3), mf.Tool(0.3, mf.Power(4))]
    found = mf.design(mf.PowerLaw(0.6, (0.02, 0.05)), LATTICE, limits=limits, tools=tools)
    assert found.parameters["tool_counts"].sum() == found.surface.count
    assert 3 not in found.sites
    np.testing.assert_array_equal(found.surface.height[found.sites == 9], [0.25])


def test_all_asperities_may_have_one_tool():
    found = mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS, tools=KIT, common_radius=True)
    assert sorted(found.parameters["tool_counts"].tolist())[:2] == [0, 0]


def test_points_that_no_tools_meet_are_refused():
    points = mf.OperatingPoints([0.05, 0.1, 0.2], [0.8, 1.0, 2.5])
    with pytest.raises(mf.Infeasible, match="use more tools or a wider range"):
        mf.design(points, LATTICE, limits=LIMITS, tools=KIT)


def test_tools_that_others_can_replace_are_left_out():
    two = mf.Tool(0.526), mf.Tool(0.3, mf.Power(4))
    kit = [*two, mf.Tool(0.52), mf.Tool(0.31, mf.Power(4)), mf.Tool(0.3, mf.Power(3.9))]
    surface = LATTICE.only(slice(12), height=np.linspace(0.2, 0.3, 12), cap=[tool.cap for tool in two] * 6)
    surface = surface.replaced(radius=[0.526, 0.3] * 6)
    load = np.linspace(0.02, 0.2, 30)
    law = mf.SampledLaw(load, ELASTIC.curve(surface, load).area)
    found = mf.design(law, LATTICE, limits=LIMITS, tools=kit)
    assert found.misfit <= 2e-3
    assert (found.parameters["tool_counts"] > 0).sum() <= 3


@pytest.mark.parametrize("seed", range(3))
def test_exponents_of_periodic_cells_are_corrected_for_interaction(seed):
    model, rng = mf.Interacting(contact=mf.Elastic()), np.random.default_rng(seed)
    cap = [mf.Power(n) for n in rng.uniform(1.3, 5.0, 6)]
    cell = mf.PeriodicCell(4.5, 3.0)
    known = CELL.replaced(cap=cap, height=rng.uniform(0.05, 0.15, 6), cell=cell)
    load = np.linspace(0.005, 0.15, 30)
    target = mf.SampledLaw(load, model.curve(known, load).area)
    template = known.replaced(cap=mf.Sphere(), height=np.full(6, 0.15))
    tools = mf.PowerRange(1.2, 6.0, None)
    assert mf.design(target, template, model, mf.Limits(0.15), tools=tools).misfit <= 3e-3


@pytest.mark.parametrize("seed", [95, 120])
def test_exponents_of_periodic_cells_are_searched_under_the_model(seed):
    """Corrections for interaction alone leave 0.3 % and more of these laws."""
    model, (surface, load) = mf.Interacting(contact=mf.Elastic()), cell(seed)
    known = surface.replaced(cell=mf.PeriodicCell(4.5, 4.5))
    target = mf.SampledLaw(load, model.curve(known, load).area)
    template = known.replaced(cap=mf.Sphere(), height=np.full(known.count, 0.15))
    tools = mf.PowerRange(1.2, 6.0, None)
    assert mf.design(target, template, model, mf.Limits(0.15), tools=tools).misfit <= 2e-3


def test_layouts_count_the_caps():
    model, tools = mf.Interacting(contact=mf.Elastic()), [mf.Tool(0.3), mf.Tool(0.3, mf.Power(4))]
    template = LATTICE.only(slice(16))
    target, layout = mf.PowerLaw(0.6, (0.01, 0.03)), mf.Layout(tilt=0.0005)
    found = mf.design(target, template, model, LIMITS, tools=tools, layout=layout)
    assert found.parameters["layout_after"] <= found.parameters["layout_before"]
    assert found.misfit <= 0.01


@pytest.mark.slow
def test_a_line_that_is_missed_states_the_range_that_tools_reach():
    tools, line = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4))], mf.LinearLaw(8.0)
    low, high = mf.achievable_load_range(line, LATTICE, LIMITS, tools, mf.Elastic())
    found = mf.design(mf.LinearLaw(8.0, (low, high)), LATTICE, limits=LIMITS, tools=tools)
    assert found.misfit <= 0.01


def test_a_hardness_is_checked_with_tools():
    tools, target = [mf.Tool(0.526), mf.Tool(0.3, mf.Paraboloid())], mf.PowerLaw(0.9, (0.1, 0.4))
    found = mf.design_for_hardness(target, LATTICE, 10.0, limits=LIMITS, tools=tools)
    assert "the contacts stay elastic" in str(found.notes[0])


@pytest.mark.parametrize("tools", [RANGE, KIT], ids=["range", "kit"])
@pytest.mark.parametrize("of", ["stiffness", "tangential_stiffness", "conductance"])
def test_other_quantities_are_met_by_tools(of, tools):
    load = np.geomspace(0.05, 0.3, 20)
    law = mf.SampledLaw(load, 8.0 * load**0.6, of=of)
    found = mf.design(law, LATTICE, limits=LIMITS, tools=tools)
    assert found.misfit <= 5e-3
    if of == "stiffness":
        stiffness = ELASTIC.curve(found.surface, load).stiffness
        np.testing.assert_allclose(stiffness, 8.0 * load**0.6, rtol=0.02)


def test_a_range_of_exponents_needs_contacts_without_adhesion():
    sticky = mf.Independent(mf.JKR(9e-6, mf.Elastic()))
    with pytest.raises(mf.InvalidInput, match="a range of exponents needs contacts without adhesion"):
        mf.design(mf.PowerLaw(0.9, (0.1, 0.4)), LATTICE, sticky, LIMITS, tools=RANGE)


def test_two_targets_need_caps_of_one_shape():
    friction = mf.PowerLaw(0.9, (0.1, 0.4))
    with pytest.raises(mf.InvalidInput, match="must have caps of one shape and one friction for two targets"):
        mf.trade_off(friction, friction, LATTICE, limits=LIMITS, tools=KIT)
