"""The slope of a law over a range of loads."""

import numpy as np
import pytest

import metafem as mf
from metafem.studies.slope import Slope


def test_the_slope_is_that_of_a_fitted_line_up_to_the_lowest_summit(rough):
    slope = Slope.of(rough, (0.02, 0.3), mf.Independent())
    area = mf.Independent().curve(rough, slope.load).area
    assert slope.fitted(area) == pytest.approx(np.polyfit(slope.load, area, 1)[0], rel=1e-12)
    assert slope.load_range == [0.02, 0.3]
    low, high = Slope.of(rough, None, mf.Independent()).load_range
    assert low == pytest.approx(0.25 * high)
    assert mf.Independent().curve(rough, np.array([high])).approach[0] == pytest.approx(np.ptp(rough.height))
