"""Approaches of adhesive contacts by tables, compared with interpolation by numpy."""

import numpy as np
import pytest

from metafem._kernels import adhesion

# Closed contacts of three states.
CLOSED = np.array([[True, False, False], [True, True, False], [True, True, True]])


@pytest.fixture
def scene():
    """Two tables of contacts that pull after their jump, and contacts with them."""
    depth = np.linspace(0.0, 1.0, 50)
    tables = np.array(
        [[depth, 0.1 + depth, depth**2 + depth - pull, 2.0 * depth + 1.0] for pull in (0.1, 0.2)]
    )
    return tables, np.array([0, 1, 0]), np.array([0.0, 0.1, 0.3])


def carried(scene, closed, x):
    """The sum of the interpolated loads of the closed contacts."""
    tables, which, gap = scene
    return sum(np.interp(x - gap[i], *tables[which[i]][[0, 2]]) for i in np.flatnonzero(closed))


def test_loads_are_sums_of_interpolated_ones(scene):
    x = np.array([0.05, 0.2, 2.0])
    expected = [carried(scene, *each) for each in zip(CLOSED, x, strict=True)]
    np.testing.assert_allclose(adhesion.loads(*scene, CLOSED, x), expected, rtol=1e-13)


def test_approaches_carry_the_loads(scene):
    x = np.array([0.9, 0.9, 0.9])
    load = np.array([0.03, 0.2, 0.7])
    radius = adhesion.approached(*scene, CLOSED, load, x, 1e-12, 60)
    found = [carried(scene, *each) for each in zip(CLOSED, x, strict=True)]
    np.testing.assert_allclose(found, load, rtol=1e-10)
    np.testing.assert_allclose(radius[2], 0.1 + x[2] - scene[2], rtol=1e-12)
