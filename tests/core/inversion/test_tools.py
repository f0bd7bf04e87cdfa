"""Tools with caps of several shapes: lists of tools, ranges of exponents, their bounds and their refusals."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.search.asperities import OfExponents
from metafem.inversion.search.mixed_tools import grouped
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.tools.kit_bounds import least_ratio

LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=mf.Material(1.36))
CELL = mf.Surface.square_lattice(0.15, (2, 3), radius=0.526, material=mf.Material(1.36))
LIMITS, RANGE = mf.Limits(0.3), mf.PowerRange(1.2, 6.0)
ELASTIC = mf.Independent(mf.Elastic())
KIT = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4)), mf.Tool(0.6, mf.Power(1.5))]


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


def test_groups_of_exponents_are_means_of_neighbours():
    found = grouped(np.array([1.5, 1.6, 4.0, 4.1, 4.2]), 2)
    np.testing.assert_allclose(np.unique(found), [math.sqrt(2.4), (4.0 * 4.1 * 4.2) ** (1 / 3)])


def test_all_asperities_may_have_one_tool():
    found = mf.design(mf.LinearLaw(7.0), LATTICE, limits=LIMITS, tools=KIT, common_radius=True)
    assert sorted(found.parameters["tool_counts"].tolist())[:2] == [0, 0]
