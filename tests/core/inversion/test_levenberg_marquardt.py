"""Descents: the least squares of a smooth problem, its limits, and the options that end them."""

import numpy as np
import pytest

from metafem.inversion.search.levenberg_marquardt import SearchOptions, descend
from metafem.inversion.search.spaces import Heights

START = np.array([0.3, 0.2, 0.1])


def bent(height):
    """Return a residual of two rows with its Jacobian; its roots have differences of 0.1 and 0.25."""
    first, second = height[0] - height[1] - 0.1, height[1] - height[2] - 0.25
    gradient = np.array([[1.0, -1.0, 0.0], [0.0, 1.0 + 2.0 * second, -1.0 - 2.0 * second]])
    return np.array([first, second + second**2]), lambda: gradient


def test_a_descent_converges_to_rounding():
    found = descend(bent, START, Heights(1.0), 1e-14, to_rounding=True)
    assert found.misfit <= 1e-14
    np.testing.assert_allclose(-np.diff(found.unknowns), [0.1, 0.25], rtol=1e-12)


def test_heights_stay_within_the_span():
    found = descend(bent, START, Heights(0.3), 1e-14, to_rounding=True)
    assert np.ptp(found.unknowns) == pytest.approx(0.3, rel=1e-12)
    assert 0.0 < found.misfit < 0.05


def test_the_options_limit_the_steps():
    start = Heights(1.0).project(START)
    found = descend(bent, start, Heights(1.0), 1e-14, options=SearchOptions(most_steps=0))
    np.testing.assert_array_equal(found.unknowns, start)


def test_a_residual_that_no_unknown_changes_ends_the_descent():
    found = descend(lambda _: (np.ones(2), lambda: np.zeros((2, 3))), START, Heights(1.0), 1e-3)
    assert found.misfit == 1.0


def test_the_jacobian_is_computed_only_where_a_step_starts():
    calls = []

    def counted(height):
        calls.append("residual")
        residual, jacobian = bent(height)
        return residual, lambda: calls.append("jacobian") or jacobian()

    found = descend(counted, START, Heights(1.0), 1e-14, to_rounding=True)
    assert found.misfit <= 1e-14
    assert calls[-1] == "residual"
    assert calls.count("jacobian") < calls.count("residual")
