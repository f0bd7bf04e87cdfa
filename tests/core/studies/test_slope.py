"""The slope of a law over a range of loads."""

import numpy as np
import pytest

import metafem as mf
from metafem.studies.slope import slope, slope_loads


def test_the_slope_is_that_of_a_fitted_line_up_to_the_lowest_summit(rough):
    load = slope_loads(rough, (0.02, 0.3), mf.Independent())
    area = mf.Independent().curve(rough, load).area
    assert slope(load, area) == pytest.approx(np.polyfit(load, area, 1)[0], rel=1e-12)
    assert load[[0, -1]].tolist() == [0.02, 0.3]
    low, *_, high = slope_loads(rough, None, mf.Independent())
    assert low == pytest.approx(0.25 * high)
    assert mf.Independent().curve(rough, np.array([high])).approach[0] == pytest.approx(np.ptp(rough.height))
