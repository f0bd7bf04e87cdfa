"""Arrangements: forecasts that price every exchange, and laws that the sites make better."""

import numpy as np
import pytest

import metafem as mf

LOAD = np.array([0.05, 0.15, 0.3])

TILT = mf.InsensitiveToTilt(LOAD)
BOTH = mf.WeightedObjectives([mf.FollowLaw(LOAD), TILT], [3.0, 1.0])


@pytest.fixture
def uneven():
    rng = np.random.default_rng(4)
    return mf.Surface.square_lattice(
        0.1 + rng.exponential(0.02, 36),
        (6, 6),
        radius=rng.uniform(0.4, 0.6, 36),
        material=mf.Material(1.36),
        block=mf.Block(12.0, 12.0, 7.2),
    )


def test_arrangement_is_the_same_for_the_same_seed(uneven):
    parts = ("position", "height", "radius")
    few = uneven.replaced(**{name: getattr(uneven, name)[:12] for name in parts})
    first, second = (mf.arrange(few, BOTH, rng=3).order for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_many_places_are_drawn(template):
    rng = np.random.default_rng(0)
    large = mf.Surface.square_lattice(
        rng.exponential(0.03, 144), (12, 12), radius=0.526, material=mf.Material(1.0)
    )
    result = mf.arrange(large, mf.FollowLaw([0.3, 0.6]), mf.Interacting(order=1))
    assert result.after < 0.3 * result.before


def test_empty_places_are_taken_where_they_help():
    """Two asperities as near as they can be move as far apart as they can."""
    row = np.column_stack([1.5 * np.arange(6), np.zeros(6)])
    pair = mf.Surface(row[2:4], [0.1, 0.11], 0.526, mf.Material(1.36))
    result = mf.arrange(pair, mf.FollowLaw([0.02, 0.04]), position=row)
    assert np.abs(np.diff(result.sites)) == [5]
    assert result.after < 0.3 * result.before
