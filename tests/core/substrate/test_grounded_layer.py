"""The grounded conducting layer against its series of images."""

import math

import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.substrate import GroundedLayer

THICKNESS = 0.8


def by_images(r):
    """Return G(r) by the alternating series over images, extrapolated."""

    def term(m):
        return 2 * (-1) ** int(m) / mpmath.sqrt(r**2 + (2 * m * THICKNESS) ** 2)

    return float((1 / mpmath.mpf(r) + mpmath.nsum(term, [1, mpmath.inf])) / mpmath.pi)


def test_influence_is_the_series_of_images():
    """Far away the difference of two nearly equal terms keeps digits of 1/(pi r) alone."""
    for r in (0.05, 0.3, 1.0, 3.0, 5.0):
        assert GroundedLayer(THICKNESS).influence(r) == pytest.approx(by_images(r), abs=1e-13 / r)


def test_self_terms_are_sums_over_the_images():
    layer = GroundedLayer(THICKNESS)
    assert layer.self_influence == pytest.approx(-math.log(2.0) / (math.pi * THICKNESS), rel=1e-14)
    cubes = 2.0 * 0.75 * float(mpmath.zeta(3)) / (2.0 * THICKNESS) ** 3  # 3/4 zeta(3) = sum (-1)^(m+1)/m^3
    assert layer.self_curvature == pytest.approx(cubes / math.pi, rel=1e-13)


def test_derivatives_are_those_of_the_influence():
    layer, r, step = GroundedLayer(THICKNESS), np.array([0.3, 0.9, 2.0]), 1e-4
    _, first, second = layer.influence(r, derivatives=True)
    high, low = (layer.influence(each, derivatives=True) for each in (r + step, r - step))
    for derivative, k in ((first, 0), (second, 1)):  # differences of second order
        assert_allclose(derivative, (high[k] - low[k]) / (2.0 * step), rtol=1e-6)


def test_share_scales_the_images_alone():
    r, half = np.array([0.3, 2.0, 40.0]), mf.HalfSpace().influence([0.3, 2.0, 40.0])
    whole, part = GroundedLayer(THICKNESS), GroundedLayer(THICKNESS, 0.3)
    assert_allclose(part.influence(r), half + 0.3 * (whole.influence(r) - half), rtol=1e-13)
    assert part.self_influence == pytest.approx(0.3 * whole.self_influence, rel=1e-15)
    assert part.self_curvature == pytest.approx(0.3 * whole.self_curvature, rel=1e-15)
    q = np.array([0.0, 0.5, 3.0])
    assert_allclose(part.transform(q), 0.3 * whole.transform(q), rtol=1e-15)


def test_periodic_sum_is_that_over_the_periods():
    layer, cell = GroundedLayer(0.5), mf.PeriodicCell(2.0, 1.5)
    x, y = np.array([0.4]), np.array([0.7])
    i, j = np.meshgrid(np.arange(-12, 13), np.arange(-12, 13))
    expected = layer.influence(np.hypot(0.4 - 2.0 * i, 0.7 - 1.5 * j)).sum()
    assert layer.periodic(cell, x, y).value[0] == pytest.approx(expected, rel=1e-12)
