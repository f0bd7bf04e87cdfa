"""Geometry of caps against the equation of the sphere."""

import numpy as np
import pytest

from metafem.contact.cap_geometry import foot_radius, sphere_profile


@pytest.mark.parametrize("radius", [0.3, 1.0])
def test_the_profile_reaches_the_height_at_the_foot(radius):
    height = radius * np.array([1e-9, 0.2, 1.0])
    foot = foot_radius(height, radius)
    assert sphere_profile(foot, radius) == pytest.approx(height, rel=1e-12)
    assert foot**2 + (radius - height) ** 2 == pytest.approx(np.full(3, radius**2), rel=1e-12)
