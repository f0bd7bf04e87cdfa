"""The compiled load equation against a readable twin."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from metafem._kernels import independent as kernel
from metafem._kernels.law import hertz_law


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


def hertz(radius, shape):
    """Hertz's law for the kernels, for surfaces of this shape."""
    return hertz_law(np.broadcast_to(radius, shape).copy())


def curves(gap, radius, load):
    """Approach, load, area and slope of one surface at loads."""
    results = tuple(np.empty((1, len(load))) for _ in range(4))
    kernel.curves(hertz(radius, (1, len(gap))), gap[None], np.array(load), *results)
    return [part[0] for part in results]


@given(scenes, st.floats(1e-12, 10.0))
def test_sums_agree_with_exact_summation(scene, approach):
    gap, radius = build(scene)
    found = tuple(np.zeros(1) for _ in range(3))
    kernel.curve_at_approach(hertz(radius, gap.shape), gap, np.array([approach]), *found)
    np.testing.assert_allclose(np.array(found)[:, 0], sums_twin(gap, radius, approach), rtol=1e-13)


loads = st.lists(st.floats(-15.0, 3.0).map(lambda e: 10.0**e), min_size=1, max_size=8)


@given(scenes, loads)
def test_approach_solves_the_load_equation(scene, loads):
    gap, radius = build(scene)
    load = [0.0, *sorted(loads)]
    approach, carried, area, slope = curves(gap, radius, load)
    assert approach[0] == carried[0] == area[0] == slope[0] == 0.0
    for k in range(1, len(load)):
        top = (0.75 * load[k] / math.sqrt(radius[0])) ** (2.0 / 3.0)
        exact = brentq(
            lambda x, p=load[k]: sums_twin(gap, radius, x)[0] / p - 1.0,
            0.0,
            1.01 * top,
            xtol=1e-300,
            rtol=1e-14,
        )
        assert approach[k] == pytest.approx(exact, rel=1e-13)
        assert carried[k] == pytest.approx(load[k], rel=1e-13)
        twin = sums_twin(gap, radius, approach[k])
        assert (carried[k], area[k], slope[k]) == pytest.approx(twin, rel=1e-12)


@given(scenes)
def test_contacts_that_just_touch_have_a_solution(scene):
    gap, radius = build(scene)
    touching = np.unique([sums_twin(gap, radius, x)[0] for x in gap])
    np.testing.assert_allclose(curves(gap, radius, touching)[1], touching, rtol=1e-13)
