"""Large scenes: thin layers, tilted lattices, and the number of products."""

import numpy as np
import pytest

import metafem as mf
from metafem._kernels.continuation import Results
from metafem.models.contact_tables import tables
from metafem.models.interacting.large import LargeScene
from metafem.models.interacting.sums.fft_sums import LatticeSums, find_lattice
from tests.core.models.interacting.test_large import SUBSTRATES, large, rough
from tests.models.scenes import lattice

__all__ = ["large"]  # a fixture


def test_large_lattices_have_rough_sums_in_single_precision():
    surface, substrate = lattice(rough(260**2)), mf.HalfSpace()
    sums = LatticeSums(find_lattice(surface.position), substrate)
    load = np.random.default_rng(0).random(surface.count)
    exact, found = sums.displacement(load), sums.rough.displacement(load)
    assert 1e-12 < np.abs(found - exact).max() / np.abs(exact).max() < 1e-5


@pytest.mark.usefixtures("large")
def test_tilted_lattice_with_contact_on_one_side_alone():
    surface = lattice(rough(900)).tilted(0.004, 0.001)
    for substrate in SUBSTRATES:
        law = mf.friction_law(
            surface, mf.Interacting(order=1, substrate=substrate), load=[0.01, 0.1, 1.0, 10.0]
        )
        assert (np.diff(law.area) > 0.0).all()


def test_products_do_not_grow_with_the_layer_s_lattice():
    counts = []
    for side in (8, 72):
        surface = mf.Surface.square_lattice(
            rough(side**2), (side, side), radius=0.526, material=mf.Material(1.0), block=mf.Block(20, 20, 7.2)
        )
        large_scene = LargeScene(surface, SUBSTRATES[1], 1)
        results = [np.zeros(1) for _ in Results._fields]
        large_scene.follow(
            tables(mf.Hertz(), surface.radius),
            np.zeros(side**2),
            surface.gap,
            np.array([0.003 * side**2]),
            True,
            Results(*results),
        )
        counts.append(large_scene.sums.products)
    assert max(counts) < 40
