"""Geometry of caps against the equation of the sphere."""

import numpy as np
import pytest

import metafem as mf
from metafem.caps import SPHERE, Cap, Caps
from metafem.caps.shapes import foot_radius, sphere_profile


def test_the_profile_reaches_the_height_at_the_foot():
    radius = 0.3
    height = radius * np.array([1e-9, 0.2, 1.0])
    foot = foot_radius(height, radius)
    assert sphere_profile(foot, radius) == pytest.approx(height, rel=1e-12)
    assert foot**2 + (radius - height) ** 2 == pytest.approx(np.full(3, radius**2), rel=1e-12)


HEIGHT, RADIUS = np.array([1e-3, 0.01, 0.12, 0.4]), np.array([0.526, 0.3, 0.526, 0.9])


class Unit(Cap):
    """A sphere that is given by its profile alone."""

    extent = 1.0

    def unit_profile(self, rho):
        return sphere_profile(np.minimum(rho, 1.0), 1.0)

    def summit_radius(self, radius):
        return radius


def test_a_sphere_given_by_its_profile_is_a_sphere():
    shape = Unit()
    for name in ("foot_radius", "volume"):
        np.testing.assert_allclose(
            getattr(shape, name)(HEIGHT, RADIUS), getattr(SPHERE, name)(HEIGHT, RADIUS), rtol=1e-12
        )
    assert (shape.largest_area(HEIGHT, RADIUS) > SPHERE.largest_area(HEIGHT, RADIUS)).all()
    # both are at equal distances along the meridian, here through 4097 points
    for mine, other in zip(shape.rings(HEIGHT, RADIUS, 5), SPHERE.rings(HEIGHT, RADIUS, 5), strict=True):
        np.testing.assert_allclose(mine, other, atol=1e-6)
    # slopes by differences
    np.testing.assert_allclose(
        shape.ring_count(HEIGHT, RADIUS, 2e-4), SPHERE.ring_count(HEIGHT, RADIUS, 2e-4), rtol=1e-3
    )


def test_the_foot_has_the_depth_of_the_height_and_the_summit_its_curvature():
    shape = mf.Power(4, 0.3)
    np.testing.assert_allclose(shape.depth_at(shape.foot_radius(HEIGHT, RADIUS), RADIUS), HEIGHT, rtol=1e-12)
    n = shape.exponent
    exact = np.pi * shape.foot_radius(HEIGHT, RADIUS) ** 2 * HEIGHT * n / (n + 2.0)
    np.testing.assert_allclose(shape.volume(HEIGHT, RADIUS), exact, rtol=1e-6)
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
    for name in ("foot_radius", "volume", "largest_area"):
        found = getattr(caps, name)(HEIGHT, RADIUS)
        own = [getattr(cap, name)(HEIGHT[i : i + 1], RADIUS[i : i + 1])[0] for i, cap in enumerate(kinds)]
        np.testing.assert_allclose(found, own, rtol=1e-14)
    assert caps.at([1]) == mf.Sphere()
    assert caps.at([0, 2]) == mf.Power(4)
    assert caps.at([3, 1]).one(1) == mf.Sphere()
