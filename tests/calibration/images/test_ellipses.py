"""Ellipses with the moments of contacts, and the compactness of circles that touch."""

import numpy as np
import pytest

from metafem.calibration.images.boundary import compactness


@pytest.mark.parametrize(("a", "b", "angle"), [(3.0, 3.0, 0.0), (5.0, 2.0, 0.3), (9.0, 1.0, 1.2)])
def test_ellipses_have_the_compactness_one(a, b, angle):
    cos, sin, area = np.cos(angle), np.sin(angle), np.pi * a * b
    moment = (
        area
        / 4.0
        * np.array(
            [(a * cos) ** 2 + (b * sin) ** 2, (a * sin) ** 2 + (b * cos) ** 2, (a * a - b * b) * sin * cos]
        )
    )
    assert compactness(np.array([area]), moment[None])[0] == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(("ratio", "expected"), [(1.0, 0.894), (0.5, 0.896), (0.3, 0.945)])
def test_circles_that_touch(ratio, expected):
    # parallel axes: the distance 1 + ratio, and the reduced area
    areas = np.pi * np.array([1.0, ratio**2])
    own = areas @ np.array([1.0, ratio**2]) / 4.0
    along = own + areas.prod() / areas.sum() * (1.0 + ratio) ** 2
    assert compactness(areas.sum(keepdims=True), np.array([[along, own, 0.0]]))[0] == pytest.approx(
        expected, abs=1e-3
    )


def test_squares():
    moment = np.array([[1.0 / 12.0, 1.0 / 12.0, 0.0]])
    assert compactness(np.ones(1), moment)[0] == pytest.approx(3.0 / np.pi, rel=1e-12)
