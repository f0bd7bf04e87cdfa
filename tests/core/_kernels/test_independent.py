"""The compiled load equation against a readable twin."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from metafem._kernels import independent as kernel


def sums_twin(gap, radius, approach):
    """P/E*, A0 and slope in plain Python with exact summation."""
    d = [max(approach - g, 0.0) for g in gap]
    pairs = list(zip(d, radius, strict=True))
    return (
        4 / 3 * math.fsum(math.sqrt(r) * x**1.5 for x, r in pairs),
        math.pi * math.fsum(r * x for x, r in pairs),
        2 * math.fsum(math.sqrt(r * x) for x, r in pairs),
    )


scenes = st.tuples(
    st.lists(st.floats(0.0, 1.0), min_size=0, max_size=20),
    st.floats(-3.0, 3.0).map(lambda e: 10.0**e),
    st.integers(0, 1000),
)


def build(scene):
    gaps, spread, seed = scene
    gap = np.sort(np.array([0.0, *gaps]))
    return gap, spread ** np.random.default_rng(seed).uniform(-0.5, 0.5, len(gap))


@given(scenes, st.floats(1e-12, 10.0))
def test_sums_agree_with_exact_summation(scene, approach):
    gap, radius = build(scene)
    np.testing.assert_allclose(
        kernel.sums(gap, np.sqrt(radius), 0.0, approach), sums_twin(gap, radius, approach), rtol=1e-13
    )


@given(scenes, st.floats(-15.0, 3.0).map(lambda e: 10.0**e), st.floats(0.0, 0.999))
def test_approach_solves_the_load_equation(scene, load, start):
    gap, radius = build(scene)
    top = (0.75 * load / math.sqrt(radius[0])) ** (2.0 / 3.0)
    exact = brentq(
        lambda x: sums_twin(gap, radius, x)[0] / load - 1.0, 0.0, 1.01 * top, xtol=1e-300, rtol=1e-14
    )
    found = kernel.approach_at_load(gap, np.sqrt(radius), load, start * exact)
    assert found == pytest.approx(exact, rel=1e-13)
    assert sums_twin(gap, radius, found)[0] == pytest.approx(load, rel=1e-12)


@given(scenes, st.lists(st.floats(-15.0, 3.0).map(lambda e: 10.0**e), min_size=1, max_size=8))
def test_areas_alone_are_those_of_the_curves(scene, loads):
    gap, radius = build(scene)
    rows, root, load = gap[None], np.sqrt(radius)[None], np.array([0.0, *sorted(loads)])
    results, area = kernel.empty_results(1, len(load)), np.full((1, len(load)), -1.0)
    kernel.curves(rows, root, load, *results)
    kernel.areas(rows, root, load, area)
    np.testing.assert_allclose(area, results[2], rtol=1e-12)


@given(scenes)
def test_areas_have_a_solution_where_a_contact_just_touches(scene):
    gap, radius = build(scene)
    rows, root = gap[None], np.sqrt(radius)[None]
    touching = np.unique([kernel.load_and_slope(gap, root[0], x)[0] for x in gap])
    results, area = kernel.empty_results(1, len(touching)), np.empty((1, len(touching)))
    kernel.curves(rows, root, touching, *results)
    kernel.areas(rows, root, touching, area)
    # the last step, relative 1e-8, is one of Newton's; the curvature of a contact that opens is unbounded
    np.testing.assert_allclose(area, results[2], rtol=1e-10)


def test_no_load_needs_no_approach():
    assert kernel.approach_at_load(np.zeros(1), np.ones(1), 0.0, 0.0) == 0.0
