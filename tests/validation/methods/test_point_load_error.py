"""Leading error of point loads, for two contacts in closed form."""

import numpy as np
import pytest

from validation.methods.point_load_error import area_error


def test_two_equal_contacts():
    distance = np.array([[0.0, 1.5], [1.5, 0.0]])
    expected = 4.0 / (9.0 * np.pi) * (0.2 / 1.5) ** 3
    assert area_error(np.array([0.2, 0.2]), distance) == pytest.approx(expected, rel=1e-14)
