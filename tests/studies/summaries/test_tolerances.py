"""How exact heights and plane must be, in words."""

import math

import numpy as np
import pytest

from metafem.studies.summaries.tolerances import reach, shown


def test_the_scatter_is_interpolated_from_zero():
    value = np.array([1.0, 2.0, 3.0])
    assert reach(value, np.array([0.02, 0.04, 0.06])) == pytest.approx(0.5)
    assert reach(value, np.array([0.005, 0.015, 0.05])) == pytest.approx(1.5)
    assert reach(value, np.array([0.001, 0.002, 0.01])) == math.inf


@pytest.mark.parametrize(("count", "step"), [(1, 1), (12, 1), (13, 2), (31, 5), (1000, 100)])
def test_a_table_has_at_most_twelve_rows_and_the_last(count, step):
    rows = shown(count)
    assert (rows[-1], len(rows) <= 12, set(np.diff(rows)) <= {step}) == (count - 1, True, True)
