"""Synthetic pictures against exact areas and moments."""

import numpy as np
import pytest

from validation.scenes.pictures import coverage

SHAPE = (90, 110)
CENTRE, AXES, ANGLE = (52.3, 40.9), (23.0, 14.0), 0.6


def moments(covered):
    """Return area, centre and second moments about it, (3,): xx, yy, xy."""
    x = np.arange(covered.shape[1]) + 0.5
    y = covered.shape[0] - np.arange(covered.shape[0])[:, None] - 0.5
    area = covered.sum()
    mean = np.array([(covered * x).sum(), (covered * y).sum()]) / area
    dx, dy = x - mean[0], y - mean[1]
    second = [(covered * part).sum() / area for part in (dx**2, dy**2, dx * dy)]
    return area, mean, np.array(second)


@pytest.mark.parametrize("blur", [0.7, 1.5, 4.0])
def test_area_centre_and_moments_are_those_of_the_ellipse(blur):
    a, b = AXES
    area, mean, second = moments(coverage(SHAPE, [CENTRE], [AXES], ANGLE, blur=blur))
    assert area == pytest.approx(np.pi * a * b, rel=1e-8)
    assert mean == pytest.approx(CENTRE, abs=1e-7)
    # a Gaussian adds its variance, a pixel 1/12
    cos, sin = np.cos(ANGLE), np.sin(ANGLE)
    wanted = np.array(
        [(a * cos) ** 2 + (b * sin) ** 2, (a * sin) ** 2 + (b * cos) ** 2, (a**2 - b**2) * sin * cos]
    )
    assert second == pytest.approx(wanted / 4.0 + (blur**2 + 1.0 / 12.0) * np.array([1, 1, 0]), rel=1e-6)


def test_contacts_outside_the_frame_are_cut_at_its_edge():
    whole = coverage((40, 40), [(20.0, 20.0)], [8.0])
    assert coverage((40, 20), [(20.0, 20.0)], [8.0]) == pytest.approx(whole[:, :20], abs=1e-12)
    assert not coverage((40, 40), [(-90.0, 20.0), (90.0, 20.0)], [8.0, 8.0]).any()
