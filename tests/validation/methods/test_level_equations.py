"""Levels for operating points, against points that known heights reach."""

import numpy as np
import pytest

from validation.methods.independent import areas, sums
from validation.methods.level_equations import levels

RADIUS = 0.526


def test_the_levels_of_known_heights_are_found_again():
    height, planes = np.array([0.27, 0.27, 0.25, 0.19, 0.19, 0.19, 0.185]), np.array([0.19, 0.16])
    friction, load = sums(height - planes[:, None], RADIUS)
    found = levels(load.tolist(), friction.tolist(), 0.27, RADIUS)
    assert found.count == pytest.approx([2, 3])
    assert found.level == pytest.approx([0.27, 0.19], abs=1e-12)
    assert found.adjustment == pytest.approx([0.25, 0.185], abs=1e-12)
    assert found.plane == pytest.approx(planes, abs=1e-12)


def test_points_that_no_heights_reach_are_refused():
    one = float(areas(np.array([0.2]), np.array([0.1]), RADIUS)[0])
    with pytest.raises(ArithmeticError, match="no height"):
        levels([0.1], [0.5 * one], 0.27, RADIUS)
