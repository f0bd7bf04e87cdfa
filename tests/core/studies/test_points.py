"""Points of batches."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from metafem.studies.sampling.points import batch_size, entropy, unit_points


@pytest.mark.parametrize("plain", [True, False])
def test_a_batch_depends_on_the_seed_and_its_number_alone(plain):
    points = unit_points(7, 3, 64, 5, plain=plain)
    assert_array_equal(points, unit_points(7, 3, 64, 5, plain=plain))
    for other in (unit_points(7, 4, 64, 5, plain=plain), unit_points(8, 3, 64, 5, plain=plain)):
        assert not np.isin(points, other).any()
    assert points.min() > 0.0
    assert points.max() < 1.0


def test_a_batch_has_one_point_in_each_interval_of_each_coordinate():
    points = np.sort(unit_points(0, 0, 64, 5), axis=0)
    assert_array_equal(np.floor(64 * points), np.tile(np.arange(64)[:, None], 5))


def test_the_size_of_a_batch_and_the_seed():
    for draws in (2, 16, 100, 10_000, 10**7):
        size = batch_size(draws)
        assert size & (size - 1) == 0
        assert -(-draws // size) >= min(draws, 16)
    assert entropy(5) == 5
    assert entropy(np.random.default_rng(1)) == entropy(np.random.default_rng(1))
