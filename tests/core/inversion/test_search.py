"""Descents within limits, random changes, changes of tools, and laws with open parameters."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.guesses import in_order
from metafem.inversion.problem import Asperities, Problem
from metafem.inversion.search import Residual, changed, descend, search, with_tools
from metafem.inversion.target_law import TargetLaw

MATERIAL, LOAD = mf.Material(1.36), np.geomspace(0.1, 0.4, 30)
SITES = mf.Surface.square_lattice(0.12, (3, 3), radius=0.526, material=MATERIAL)
LIMITS = mf.Limits(0.12, offset=0.05, pinned={1: 0.12, 5: None})
TOOLS = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4))]
FEW = np.array([0.004, 0.01, 0.02])


def problem_of(heights, limits=LIMITS, tools=None, which=0):
    """The problem whose target is the law of asperities of a tool, and these asperities."""
    given = mf.SampledLaw(FEW, FEW)
    problem = Problem.checked(given, SITES, limits=limits, tools=tools)
    at = Asperities(np.append(heights, np.full(9 - len(heights), 0.05)), np.full(9, which))
    at.tool[len(heights) :] = -1
    area = problem.uncoupled.curve(problem.surface(at), FEW).area
    return replace(problem, target=mf.SampledLaw(FEW, area)), at


def test_a_descent_converges_to_rounding():
    problem, wanted = problem_of([0.16, 0.12, 0.15, 0.13])
    start = wanted.with_heights(np.array([0.161, 0.12, 0.149, 0.131]))
    found = descend(Residual(problem, problem.law), start, 1e-14, exact=True)
    assert found.misfit <= 1e-13
    area = problem.uncoupled.curve(problem.surface(found.asperities), FEW).area
    np.testing.assert_allclose(area, problem.target.rescaled_friction, rtol=1e-12)


def test_a_descent_stays_within_the_limits_and_keeps_given_heights():
    wide, wanted = problem_of([0.17, 0.12, 0.07, 0.05], mf.Limits(0.17))
    narrow = Problem.checked(wide.target, SITES, limits=mf.Limits(0.04, offset=0.1, pinned={1: 0.12}))
    start = wanted.with_heights(np.array([0.14, 0.12, 0.11, 0.1]))
    found = descend(Residual(narrow, narrow.law), start, 0.0, exact=True)
    height = found.asperities.height[found.asperities.sites]
    assert height[1] == 0.12
    assert ((height >= 0.1) & (height <= 0.14)).all()


def test_a_search_meets_its_goal():
    problem, wanted = problem_of([0.16, 0.12, 0.15, 0.13])
    start = wanted.with_heights(np.array([0.14, 0.12, 0.08, 0.06]))
    residual = Residual(problem, problem.law)
    found = search(residual, [start], 6e-4, np.random.default_rng(0))
    assert found.misfit <= 6e-4


@pytest.mark.parametrize("tools", [None, TOOLS], ids=["one", "two"])
def test_the_jacobian_is_that_of_differences(tools):
    """Its last row is that of the clearance of the base, which counts for asperities pressed flat."""
    problem, at = problem_of([0.1, 0.08, 0.07, 0.06], mf.Limits(0.12), tools)
    at.tool[1] = len(problem.tools) - 1
    law = TargetLaw.of(np.array([0.01, 0.05, 0.35]), np.array([0.1, 0.4, 1.0]))
    residual = Residual(problem, law)
    value, jacobian = residual(at)
    assert value[-1] != 0.0
    heights = at.height[at.sites]
    for i in range(4):
        step = 1e-6 * np.eye(4)[i]
        up, down = (residual(at.with_heights(heights + sign * step))[0] for sign in (1.0, -1.0))
        np.testing.assert_allclose(jacobian()[:, i], (up - down) / 2e-6, rtol=1e-5, atol=1e-5)


def test_random_changes_keep_given_heights_empty_sites_and_limits():
    problem, at = problem_of([0.16, 0.12, 0.15, 0.13], tools=TOOLS)
    rng, numbers, tools = np.random.default_rng(0), set(), set()
    for _ in range(60):
        found = changed(at, problem, rng)
        some = found.sites
        assert found.height[1] == 0.12
        assert 1 in some
        assert 5 not in some
        assert ((found.height[some] >= 0.05) & (found.height[some] <= 0.17)).all()
        numbers.add(len(some))
        tools |= set(found.tool[some].tolist())
    assert min(numbers) < 4 < max(numbers)
    assert tools == {0, 1}


@pytest.mark.parametrize("seed", range(6))
def test_a_search_finds_the_asperity_that_touches_only_at_the_last_load(seed):
    law, height = mf.Independent(mf.Elastic(mf.Power(6, 0.4))), np.full(9, 0.2)
    height[1:] -= 1e-3 * np.array([0.23, 0.37, 1.69, 2.06, 3.14, 3.4, 3.58, 7.92])
    load = 2.07e-5 * 10.0 ** np.arange(4)
    curve = law.curve(SITES.replaced(height=height), load)
    limits = mf.Limits(0.2, offset=float(curve.approach[-1]))
    design = mf.design(mf.SampledLaw(load, curve.area), SITES, law, limits, seed)
    assert design.misfit < 1e-3


def test_a_change_of_tools_finds_the_one_that_lowers_the_misfit():
    """The law is that of four asperities, one of which is made by the other tool."""
    problem, wanted = problem_of([0.16, 0.155, 0.15, 0.13], mf.Limits(0.12, offset=0.05), TOOLS)
    wanted.tool[2] = 1
    area = problem.uncoupled.curve(problem.surface(wanted), FEW).area
    problem = replace(problem, target=mf.SampledLaw(FEW, area))
    residual = Residual(problem, problem.law)
    same = Asperities(wanted.height, np.where(wanted.exists, 0, -1))
    before = descend(residual, same, 1e-6)
    assert with_tools(residual, before, 1e-6).misfit < before.misfit


def test_many_laws_are_those_of_each():
    line = TargetLaw.of(LOAD, np.zeros(30), free=np.column_stack([LOAD, np.ones(30)]))
    area = 9.0 * LOAD**0.85 * (1.0 + 0.05 * np.random.default_rng(0).standard_normal((20, 30)))
    # far from a line: the nearest one is not positive
    area[0] = 1e-3 + 1e3 * LOAD**8
    for law in (TargetLaw.of(LOAD, 7.0 * LOAD), mf.PowerLaw(0.9, (0.1, 0.4)).curve(), line):
        np.testing.assert_allclose(law.laws(area), [law.law(row) for row in area], rtol=1e-12)


def test_a_thinned_law_keeps_its_ends_and_weights():
    law = TargetLaw.of(LOAD, 7.0 * LOAD, weight=np.arange(1.0, 31.0))
    thin = law.thinned(7)
    assert (len(thin.load), thin.load[0], thin.load[-1]) == (7, 0.1, 0.4)
    assert thin.weight.mean() == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_array_equal(thin.lower, 7.0 * thin.load)
    assert law.thinned(30) is law


def test_no_asperity_enters_where_the_earlier_ones_have_load_and_area():
    """The law of one asperity: between two samples the first has both, up to rounding."""
    for law in (mf.Elastic(mf.Power(3.7)), mf.KogutEtsion(14.0).for_material(MATERIAL)):
        for depth in np.random.default_rng(0).uniform(1e-3, 0.02, 20):
            one = law.contacts(depth * np.geomspace(0.01, 1.0, 6), np.array(0.526))
            height = in_order(law, one.load, one.area, 0.526, 4)
            assert len(height) >= 1
            assert ((-depth <= height) & (height <= 0.0)).all()
