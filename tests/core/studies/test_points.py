"""Points of batches."""

import numpy as np
from numpy.testing import assert_array_equal

from metafem.studies.sampling.points import entropy, unit_points


def test_a_batch_depends_on_the_seed_and_its_number_alone():
    points = unit_points(7, 3, 64, 5)
    assert_array_equal(points, unit_points(7, 3, 64, 5))
    for other in (unit_points(7, 4, 64, 5), unit_points(8, 3, 64, 5)):
        assert not np.isin(points, other).any()
    assert points.min() > 0.0
    assert points.max() < 1.0
    assert entropy(5) == 5
    assert entropy(np.random.default_rng(1)) == entropy(np.random.default_rng(1))
