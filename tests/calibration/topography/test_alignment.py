"""Summits are matched to their sites whichever way the part lay on the map."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration.topography.alignment import aligned
from tests.calibration.topography.scenes import lattice
from validation.scenes.height_maps import Placement

RNG = np.random.default_rng(0)
DESIGN = lattice(RNG, (5, 4))


def seen(rotation, mirrored, summits):
    centre = Placement(rotation, (7.0, 5.0)).of(DESIGN.position[summits])
    centre = centre * np.array([-1.0, 1.0]) if mirrored else centre
    return centre + RNG.normal(0.0, 2e-4, centre.shape), DESIGN.height[summits] + RNG.normal(
        0.0, 1e-3, len(centre)
    )


@pytest.mark.parametrize("degrees", [10.0, -93.0, 172.0])
@pytest.mark.parametrize("mirrored", [False, True])
def test_all_ways_to_lie_give_the_sites(degrees, mirrored):
    summits = RNG.permutation(20)[:14]
    place = aligned(*seen(math.radians(degrees), mirrored, summits), DESIGN, None)
    assert place.site.tolist() == summits.tolist()
    assert place.mirrored == mirrored
    assert place.decided
    assert np.abs(place.position - DESIGN.position[summits]).max() < 1e-3
    turned = -degrees if mirrored else degrees
    assert math.remainder(place.rotation - math.radians(turned), math.tau) == pytest.approx(0.0, abs=1e-3)


def test_heights_decide_where_a_part_of_the_lattice_lies():
    summits = np.array([5, 6, 7, 9, 10, 11, 13, 14, 15])  # 3 x 3 sites fit in many places
    place = aligned(*seen(0.0, False, summits), DESIGN, False)
    assert place.site.tolist() == summits.tolist()


def test_equal_heights_decide_nothing():
    flat = DESIGN.replaced(height=np.full(20, 0.1))
    place = aligned(flat.position + 3.0, np.full(20, 0.1), flat, None)
    assert not place.decided
    assert place.site.tolist() == list(range(20))


def test_one_or_two_summits():
    pair = mf.Surface([[0.0, 0.0], [0.1, 1.5]], [0.1, 0.2], 0.526, mf.Material(1.36))
    place = aligned(pair.position[::-1] + 4.0, pair.height[::-1], pair, None)
    assert place.site.tolist() == [1, 0]
    np.testing.assert_allclose(place.position, pair.position[::-1], atol=1e-15)
    with pytest.raises(mf.InvalidInput, match="2 caps and the design has 20 asperities"):
        aligned(pair.position, pair.height, DESIGN, None)


def test_another_lattice_is_refused():
    with pytest.raises(mf.InvalidInput, match="caps are not on the sites"):
        aligned(0.7 * DESIGN.position, DESIGN.height, DESIGN, False)
