"""Geometry of caps against the equation of the sphere."""

import numpy as np
import pytest

import metafem as mf
from metafem.contact.cap_geometry import SPHERES, ProfileCaps, foot_radius, sphere_profile


@pytest.mark.parametrize("radius", [0.3, 1.0])
def test_the_profile_reaches_the_height_at_the_foot(radius):
    height = radius * np.array([1e-9, 0.2, 1.0])
    foot = foot_radius(height, radius)
    assert sphere_profile(foot, radius) == pytest.approx(height, rel=1e-12)
    assert foot**2 + (radius - height) ** 2 == pytest.approx(np.full(3, radius**2), rel=1e-12)


HEIGHT, RADIUS = np.array([1e-3, 0.01, 0.12, 0.4]), np.array([0.526, 0.3, 0.526, 0.9])


def test_a_sphere_given_by_its_profile_is_a_sphere():
    shape = ProfileCaps(lambda x: sphere_profile(np.minimum(x, 1.0), 1.0), scaled=True, extent=1.0)
    for name in ("foot_radius", "volume"):
        np.testing.assert_allclose(
            getattr(shape, name)(HEIGHT, RADIUS), getattr(SPHERES, name)(HEIGHT, RADIUS), rtol=1e-12
        )
    assert (shape.largest_area(HEIGHT, RADIUS) > SPHERES.largest_area(HEIGHT, RADIUS)).all()
    # both are at equal distances along the meridian, here through 4097 points
    for mine, other in zip(shape.rings(HEIGHT, RADIUS, 5), SPHERES.rings(HEIGHT, RADIUS, 5), strict=True):
        np.testing.assert_allclose(mine, other, atol=1e-6)
    # slopes by differences
    np.testing.assert_allclose(
        shape.ring_count(HEIGHT, RADIUS, 2e-4), SPHERES.ring_count(HEIGHT, RADIUS, 2e-4), rtol=1e-3
    )


@pytest.mark.parametrize("law", [mf.PowerCap(1.5), mf.PowerCap(4, 0.3), mf.JKR(9e-6, mf.PowerCap(8))])
def test_the_foot_is_where_the_depth_is_the_height(law):
    shape, cap = law.shape(), getattr(law, "cap", law)
    np.testing.assert_allclose(cap.depth_at(shape.foot_radius(HEIGHT, RADIUS), RADIUS), HEIGHT, rtol=1e-12)
    n = cap.exponent
    exact = np.pi * shape.foot_radius(HEIGHT, RADIUS) ** 2 * HEIGHT * n / (n + 2.0)
    np.testing.assert_allclose(shape.volume(HEIGHT, RADIUS), exact, rtol=1e-6)
    assert np.isinf(shape.tallest(RADIUS)).all()


def test_a_profile_has_one_foot_for_all_radii_and_ends():
    shape = mf.AxisymmetricCap([[0.0, 0.1, 0.2, 0.3], [0.0, 0.01, 0.04, 0.09]]).shape()
    np.testing.assert_allclose(shape.foot_radius(np.full(4, 0.04), RADIUS), 0.2, rtol=1e-12)
    np.testing.assert_allclose(shape.tallest(RADIUS), 0.09, rtol=1e-12)
    with pytest.raises(
        mf.InvalidInput, match=r"ends 0\.09 mm below the summit, at its extent of 0\.3 mm; .* 0\.1 mm"
    ):
        shape.foot_radius(np.array([0.05, 0.1]), RADIUS[:2])


@pytest.mark.parametrize(
    "law", [mf.Hertz(), mf.SphericalCap(), mf.JKR(9e-6), mf.KogutEtsion(10.0), mf.JacksonGreen(4.0)]
)
def test_other_laws_have_spheres(law):
    assert law.shape() is SPHERES
