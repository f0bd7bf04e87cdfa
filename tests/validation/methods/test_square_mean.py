"""Mean displacement under a square, against its closed form."""

import numpy as np
import pytest

from validation.methods.square_mean import mean_influence


def test_it_is_the_closed_form():
    root = np.sqrt(2.0)
    expected = 4.0 / np.pi * (np.log(1.0 + root) - (root - 1.0) / 3.0)
    assert mean_influence() == pytest.approx(expected, rel=1e-13)
