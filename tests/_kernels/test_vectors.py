import math

import numpy as np
import pytest

from metafem._kernels import vectors


@pytest.mark.parametrize("size", [0, 1, 4, 1003])
def test_dot_is_the_sum_of_products(size):
    a, b = np.random.default_rng(0).random((2, size))
    assert vectors.dot(a, b) == pytest.approx(math.fsum(a * b), rel=1e-14)


def test_violations_are_largest_error_inside_and_overlap_outside():
    w = np.array([0.1, -0.3, 0.9, -0.2, 0.0])
    face = np.array([True, True, False, False, False])
    assert vectors.violations(w, face) == (0.3, 0.2)
