"""Estimated Sobol indices, means and deviations against closed forms."""

import numpy as np

from validation.scenes.sobol_functions import EXACT, GROUPS, both, sobol_indices


def test_estimates_lie_within_their_errors():
    found = sobol_indices(both, GROUPS, 60_000, 0)
    for estimate, exact in zip(found, EXACT, strict=True):
        assert estimate.value.shape == exact.shape
        # four standard errors: 16 numbers fail together with a probability of 1e-2 (Student, 15 degrees)
        assert (np.abs(estimate.value - exact) <= 4.0 * estimate.error + 1e-12).all()
        assert (estimate.error[..., 1] <= 2e-3).all()


def test_a_function_of_one_group_has_exact_indices():
    found = sobol_indices(lambda x: np.exp(x[..., :2].sum(axis=-1, keepdims=True)), [[0, 1], [2]], 100,
                          1)  # fmt: skip
    for estimate in (found.first_order, found.total):
        np.testing.assert_allclose(estimate.value, [[1.0], [0.0]], atol=1e-13)
        np.testing.assert_allclose(estimate.error, 0.0, atol=1e-13)
