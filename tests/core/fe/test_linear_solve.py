"""Sparse systems with small, vanishing and no pivots."""

import math

import numpy as np
from scipy.sparse import csc_array, csc_matrix

from metafem.fe.linear_solve import RESIDUAL, LinearStatus, solve


def test_a_small_pivot_is_repaired_by_pivoting():
    matrix = csc_matrix(np.array([[1e-20, 1.0, 0.0], [1.0, 1e-20, 1.0], [0.0, 1.0, 1.0]]))
    solved = solve(matrix, np.array([[1.0], [2.0], [3.0]]))
    assert solved.residual < RESIDUAL
    np.testing.assert_allclose(matrix @ solved.value, [[1.0], [2.0], [3.0]], rtol=1e-12)


def test_vanishing_pivots_are_solved_with_pivoting():
    solved = solve(csc_array(np.array([[0.0, 1.0], [1.0, 0.0]])), np.array([[1.0], [2.0]]))
    np.testing.assert_allclose(solved.value, [[2.0], [1.0]])
    assert solved.status is not LinearStatus.NOT_CONVERGED
    assert solved.residual < 1e-15


def test_a_singular_matrix_is_reported():
    solved = solve(csc_array((2, 2)), np.ones((2, 1)))
    assert (solved.residual, solved.status) == (math.inf, LinearStatus.NOT_CONVERGED)
