"""Cubics in logarithms: powers are exact, and the inverse is that of the function."""

import numpy as np
from numpy.testing import assert_allclose

from metafem.contact.by_indentation import LogCubic


def test_powers_are_joined_with_continuous_slopes():
    function = LogCubic.powers([(1.0, 1.0), (0.9, 1.5), (2.0, 1.0)], [(1.0, 2.0), (5.0, 8.0)])
    x = np.geomspace(0.1, 100.0, 500)
    y, slope = function.at(x)
    assert (np.diff(y) > 0.0).all()
    assert (slope > 0.0).all()
    assert_allclose(function.inverse(y), x, rtol=1e-14)
    assert_allclose(y[x < 1.0], x[x < 1.0], rtol=1e-13)
    assert_allclose(y[x > 8.0], 2.0 * x[x > 8.0], rtol=1e-13)
    for edge in (1.0, 2.0, 5.0, 8.0):
        (low, high), (left, right) = function.at(edge * np.array([1.0 - 1e-12, 1.0 + 1e-12]))
        assert_allclose(low, high, rtol=1e-11)
        assert_allclose(left, right, rtol=1e-9)
