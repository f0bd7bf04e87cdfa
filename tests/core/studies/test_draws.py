"""Seeds and generators of the parts of a study."""

import numpy as np
from numpy.testing import assert_array_equal

from metafem.studies.draws import generator_of, seed_of


def test_a_part_depends_on_the_seed_and_its_number_alone():
    points = generator_of(7, 3).random(64)
    assert_array_equal(points, generator_of(7, 3).random(64))
    for other in (generator_of(7, 4), generator_of(8, 3)):
        assert not np.isin(points, other.random(64)).any()
    assert seed_of(5) == 5
    assert seed_of(np.random.default_rng(1)) == seed_of(np.random.default_rng(1))
