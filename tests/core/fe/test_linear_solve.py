"""Sparse systems with small, vanishing and no pivots."""

import numpy as np
import pytest
from scipy.sparse import csr_array

import metafem as mf
from metafem.fe.elements import RESIDUAL, solve

NONE = np.array([], dtype=np.intp)


def solved(matrix, load):
    return solve(csr_array(matrix), NONE, np.zeros(load.shape), load)


def test_a_small_pivot_is_repaired_by_pivoting():
    matrix = np.array([[1e-20, 1.0, 0.0], [1.0, 1e-20, 1.0], [0.0, 1.0, 1.0]])
    value, residual = solved(matrix, np.array([[1.0], [2.0], [3.0]]))
    assert residual < RESIDUAL
    np.testing.assert_allclose(matrix @ value, [[1.0], [2.0], [3.0]], rtol=1e-12)


def test_vanishing_pivots_are_solved_with_pivoting():
    value, residual = solved(np.array([[0.0, 1.0], [1.0, 0.0]]), np.array([[1.0], [2.0]]))
    np.testing.assert_allclose(value, [[2.0], [1.0]])
    assert residual < 1e-15


def test_fixed_unknowns_keep_their_values():
    matrix = csr_array(np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]]))
    value, _ = solve(matrix, np.array([0, 2]), np.array([[1.0], [7.0], [3.0]]))
    np.testing.assert_allclose(value, [[1.0], [2.0], [3.0]], rtol=1e-15)


def test_a_singular_matrix_is_reported():
    with pytest.raises(mf.NotConverged, match="residual of inf"):
        solved(np.zeros((2, 2)), np.ones((2, 1)))
