"""Sums and products of the kernels of resolved contacts."""

import math

import numpy as np
import pytest

from metafem._kernels import vectors


def test_dot_is_the_sum_of_products():
    for size in (0, 1003):
        a, b = np.random.default_rng(0).random((2, size))
        assert vectors.dot(a, b) == pytest.approx(math.fsum(a * b), rel=1e-14)


def test_shifted_dot_keeps_the_digits_of_small_differences():
    for size in (0, 1003):
        a, w = np.random.default_rng(0).random((2, size))
        b = 1e6 + w
        assert vectors.shifted_dot(a, b, 1e6) == pytest.approx(math.fsum(a * (b - 1e6)), rel=1e-14)


def test_multiple_is_added_in_double_precision():
    total, vector = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3], dtype=np.float32)
    expected = total + 1e-9 * vector.astype(np.float64)
    vectors.add_multiple(total, 1e-9, vector)
    np.testing.assert_array_equal(total, expected)


def test_shortage_is_that_of_the_face():
    v, face = np.array([0.1, 0.5, 0.9]), np.array([True, False, True])
    np.testing.assert_array_equal(vectors.shortage(v, 0.5, face), [0.4, 0.0, -0.4])


def test_violations_are_largest_error_inside_and_overlap_outside():
    w = np.array([0.125, -0.25, 0.875, -0.1875, 0.0])
    face = np.array([True, True, False, False, False])
    assert vectors.violations(2.0 + w, 2.0, face) == (0.25, 0.1875)


def test_a_sum_of_opposite_numbers_keeps_its_digits():
    values = np.array([1.0, 1e100, 1.0, -1e100])
    assert vectors.exact_sum(values) == 2.0
    values = np.random.default_rng(0).exponential(size=1000)
    assert vectors.exact_sum(values) == pytest.approx(math.fsum(values), rel=1e-15)
