"""Quadratic programs against non-negative least squares and the conditions of their minimum."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from metafem.models.boundary_elements import quadratic_program


class Dense:
    """A matrix, and a preconditioner that is no more than its diagonal."""

    def __init__(self, matrix):
        self.matrix = matrix

    def product(self, pressure):
        return self.matrix @ pressure

    def precondition(self, vector):
        return vector / np.diag(self.matrix)


def random_program(seed, size):
    """A positive definite matrix with a condition up to 1e4, and a gap of both signs."""
    rng = np.random.default_rng(seed)
    basis, _ = np.linalg.qr(rng.standard_normal((size, size)))
    matrix = basis @ np.diag(np.logspace(-2, 2, size)) @ basis.T
    return 0.5 * (matrix + matrix.T), rng.standard_normal(size)


def solve(matrix, gap, start, total=None, most=3000):
    return quadratic_program.Program(Dense(matrix), gap, total, 1e-9, most).minimum(start, 0.0)


seeds = st.integers(0, 10**6)


@settings(deadline=None, max_examples=20)
@example(525457, 6)  # gradient steps alone need more than 3,000 iterations
@given(seeds, st.integers(1, 40))
def test_minimum_is_that_of_non_negative_least_squares_and_keeps_a_given_sum(seed, size):
    matrix, gap = random_program(seed, size)
    start = np.random.default_rng(seed).random(size)
    found, _, _, error = solve(matrix, gap, start)
    root = np.linalg.cholesky(matrix).T
    expected, _ = nnls(root, -np.linalg.solve(root.T, gap))
    assert error <= 1e-9
    # the error in pressure is the gap's over the smallest eigenvalue, 1e-2
    np.testing.assert_allclose(found, expected, atol=1e-6)

    found, _, multiplier, _ = solve(matrix, gap, start, total=float(start.sum()))
    assert found.sum() == pytest.approx(start.sum(), rel=1e-12)
    w = matrix @ found + gap - multiplier
    assert found.min() >= 0.0
    assert np.abs(w[found > 0.0]).max() <= 1e-9
    assert w.min() >= -1e-9


def test_error_is_that_of_the_pressure_returned_when_stopped_early():
    matrix, gap = random_program(0, 30)
    found, _, _, error = solve(matrix, gap, np.ones(30), most=2)
    w = matrix @ found + gap
    closed = found > 0.0
    assert error == max(np.abs(w[closed]).max(), -w[~closed].min(initial=0.0)) > 1e-9


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=30), seeds)
def test_projection_on_a_sum_is_the_nearest_point(start, seed):
    start = np.array(start) + 0.1
    change = np.random.default_rng(seed).standard_normal(start.size)
    trial = start + change - change.mean()
    found = quadratic_program.project(trial, float(start.sum()))
    assert found.sum() == pytest.approx(start.sum(), rel=1e-12)
    assert found.min() >= 0.0
    # optimality: one shift for all that is kept, and no less for what is dropped
    shift = (trial - found)[found > 0.0]
    assert np.ptp(shift) <= 1e-12
    assert (trial[found == 0.0] <= shift[0] + 1e-12).all()


def test_system_on_a_face_is_solved_there():
    matrix, _ = random_program(1, 20)
    face = np.arange(20) % 3 > 0
    zero = np.zeros(20)
    program = quadratic_program.Program(Dense(matrix), zero - 1.0, None, 1e-10)
    found, _, _ = program.on_face(face, zero, zero - 1.0, 0.0, 0.0, 500)
    assert (found[~face] == 0.0).all()
    np.testing.assert_allclose((matrix @ found)[face], 1.0, rtol=1e-9)
