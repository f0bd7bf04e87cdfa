"""Heights within absolute limits, of which some are given."""

import numpy as np

from metafem.inversion.search.levenberg_marquardt import descend
from metafem.inversion.search.spaces import Bounded

SPACE = Bounded(0.0, 1.0, np.array([1]), np.array([0.5]))


def test_heights_are_within_the_limits_and_given_ones_stay():
    np.testing.assert_array_equal(SPACE.project(np.array([-1.0, 3.0, 2.0])), [0.0, 0.5, 1.0])


def test_heights_at_a_limit_stay_where_a_step_would_pass_it():
    residual = SPACE.held(lambda height: (np.array([1.0]), lambda: np.array([[2.0, 3.0, 4.0]])))
    # down the gradient all heights sink
    np.testing.assert_array_equal(residual(np.array([0.0, 0.5, 1.0]))[1](), [[0.0, 0.0, 4.0]])
    np.testing.assert_array_equal(residual(np.array([0.1, 0.5, 1.0]))[1](), [[2.0, 0.0, 4.0]])


def test_a_descent_ends_at_the_least_squares_within_the_limits():
    """Of the squares of h - (2, 0.2, 0.7) the least within the limits is at (1, 0.5, 0.7)."""
    wanted = np.array([2.0, 0.2, 0.7])
    found = descend(
        lambda height: (height - wanted, lambda: np.eye(3)), np.array([0.2, 0.5, 0.1]), SPACE, 0.0, True
    )
    np.testing.assert_allclose(found.unknowns, [1.0, 0.5, 0.7], atol=1e-6)


def test_random_changes_add_and_remove_asperities_but_keep_the_given_ones():
    rng, start = np.random.default_rng(0), np.array([0.3, 0.5, 0.8, *[SPACE.absent] * 5])
    numbers = set()
    for _ in range(50):
        height = SPACE.changed(start, rng, (0.3, 1.0, 3.0))
        exists = SPACE.exists(height)
        assert height[1] == 0.5
        assert (height[exists] >= 0.0).all()
        assert (height[exists] <= 1.0).all()
        assert (height[~exists] == SPACE.absent).all()
        numbers.add(int(exists.sum()))
    assert min(numbers) < 3 < max(numbers)
