"""Sums of the kernels."""

import math

import numpy as np
import pytest

from metafem._kernels import vectors


def test_a_sum_of_opposite_numbers_keeps_its_digits():
    values = np.array([1.0, 1e100, 1.0, -1e100])
    assert vectors.exact_sum(values) == 2.0
    values = np.random.default_rng(0).exponential(size=1000)
    assert vectors.exact_sum(values) == pytest.approx(math.fsum(values), rel=1e-15)
