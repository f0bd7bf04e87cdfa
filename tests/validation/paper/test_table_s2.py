"""Each height of Table S2 has an allowance of its own; those beyond it are a difference, not an agreement."""

import numpy as np
import pytest

from validation.check import Check, Difference
from validation.paper import table_s2
from validation.paper.surfaces import fig5


@pytest.mark.parametrize(("colour", "outside"), [("red", 26), ("blue", 5)])
def test_heights_beyond_their_own_allowance_are_no_agreeing_numbers(colour, outside):
    rows = [row for row in table_s2.claim().rows if row.name.startswith(colour)]
    (agreeing,) = (row for row in rows if isinstance(row, Check) and row.source.quantity)
    assert agreeing.source.numbers == 64 - outside
    assert agreeing.passed
    (apart,) = (row for row in rows if isinstance(row, Difference) and "than the digits explain" in row.name)
    assert apart.computed == outside


def test_the_allowance_of_a_low_height_is_less_than_that_of_the_tallest():
    allowed = table_s2.allowance("red")
    assert allowed.shape == (64,)
    assert allowed[12] == pytest.approx(0.0545, abs=1e-4)  # of 52.9 µm
    assert allowed[12] < 0.5 * allowed.max()
    # only the tallest heights are allowed what one allowance for all would be
    difference = table_s2._difference(fig5("red"), "red")
    assert difference.max() < allowed.max()
    assert np.count_nonzero(difference > allowed) == 26
