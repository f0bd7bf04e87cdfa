"""Geometry of caps against the equation of the sphere."""

import numpy as np
import pytest

import metafem as mf
from metafem.caps import SPHERE, Caps
from metafem.caps.shapes import foot_radius, sphere_profile


def test_the_profile_reaches_the_height_at_the_foot():
    radius = 0.3
    height = radius * np.array([1e-9, 0.2, 1.0])
    foot = foot_radius(height, radius)
    assert sphere_profile(foot, radius) == pytest.approx(height, rel=1e-12)
    assert foot**2 + (radius - height) ** 2 == pytest.approx(np.full(3, radius**2), rel=1e-12)


HEIGHT, RADIUS = np.array([1e-3, 0.01, 0.12, 0.4]), np.array([0.526, 0.3, 0.526, 0.9])


def test_a_sphere_given_by_its_profile_is_a_sphere():
    shape = mf.Profile(lambda rho: sphere_profile(rho, 1.0), 1.0)
    height, radius = np.array([1e-3, 0.01, 0.12, 0.4]), np.ones(4)
    np.testing.assert_allclose(
        shape.foot_radius(height, radius), SPHERE.foot_radius(height, radius), rtol=1e-12
    )
    across, z = SPHERE.rings(height, radius, 5)
    np.testing.assert_allclose(shape.rings(height, radius, 5), (across, z), rtol=1e-12)
    # at equal distances along the meridian, here through 4097 points, and as near as the chord error says
    angle = np.arcsin(across)
    np.testing.assert_allclose(angle, angle[:, -1:] * np.arange(6) / 5.0, atol=1e-6)
    step = np.sqrt(8.0 * 2e-4 / (1.0 + (np.pi / 3.0) ** 2))
    np.testing.assert_allclose(
        SPHERE.ring_count(height, radius, 2e-4), np.arcsin(across[:, -1]) / step, rtol=1e-3
    )


def test_the_foot_has_the_depth_of_the_height_and_the_summit_its_curvature():
    shape = mf.Power(4, 0.3)
    np.testing.assert_allclose(shape.depth_at(shape.foot_radius(HEIGHT, RADIUS), RADIUS), HEIGHT, rtol=1e-12)
    assert np.isinf(shape.tallest(RADIUS)).all()
    radius = np.array([0.3, 0.5])
    power = mf.Power(2, 0.25)
    assert power.summit_radius(radius).tolist() == [0.6, 1.0]
    mixed = Caps.of([power, mf.Paraboloid()])
    assert mixed.summit_radius(radius).tolist() == [0.6, 0.5]
    parabola = mf.Profile(lambda rho: rho**2 / 0.8, 0.3)
    np.testing.assert_allclose(parabola.summit_radius(radius), 0.4, rtol=1e-12)


def test_a_profile_has_one_foot_for_all_radii_and_ends():
    shape = mf.Profile([[0.0, 0.1, 0.2, 0.3], [0.0, 0.01, 0.04, 0.09]])
    np.testing.assert_allclose(shape.foot_radius(np.full(4, 0.04), RADIUS), 0.2, rtol=1e-12)
    np.testing.assert_allclose(shape.tallest(RADIUS), 0.09, rtol=1e-12)
    with pytest.raises(mf.InvalidInput, match=r"0\.09 mm .* 0\.3 mm; .* 0\.1 mm"):
        shape.foot_radius(np.array([0.05, 0.1]), RADIUS[:2])


def test_caps_of_each_asperity_have_the_geometry_of_their_kinds():
    kinds = [mf.Power(4), mf.Sphere(), mf.Power(4), mf.Paraboloid()]
    caps = Caps.of(kinds)
    assert [caps.one(i) for i in range(4)] == kinds
    assert len(caps.kinds) == 3
    assert np.array_equal(caps.tallest(RADIUS), [np.inf, 0.3, np.inf, np.inf])
    own = [cap.foot_radius(HEIGHT[i : i + 1], RADIUS[i : i + 1])[0] for i, cap in enumerate(kinds)]
    np.testing.assert_allclose(caps.foot_radius(HEIGHT, RADIUS), own, rtol=1e-14)
    assert caps.ring_count(HEIGHT, RADIUS, 2e-4)[1] == mf.Sphere().ring_count(HEIGHT[1:2], RADIUS[1:2], 2e-4)
    assert caps.at([1]) == mf.Sphere()
    assert caps.at([0, 2]) == mf.Power(4)
    assert caps.at([3, 1]).one(1) == mf.Sphere()
