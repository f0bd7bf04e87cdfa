"""Asperities coupled through the true block."""

import pytest
from numpy.testing import assert_allclose

import metafem as mf
from tests.models.scenes import PLACE, scene

# One solution of large cells, a second; the block is twelve times as wide as thick.
WIDE = mf.fe.Block3D(cell=0.5, edge_cell=0.1)


@pytest.fixture(autouse=True, scope="module")
def cache_folder(tmp_path_factory):
    """A cache folder of the tests' own."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("cache")
        patch.setattr("metafem.fe.block3d.cache.cache_folder", lambda: folder)
        yield


def test_a_wide_block_is_the_layer():
    surface = scene(PLACE - PLACE.mean(axis=0)).replaced(block=mf.Block(60.0, 60.0, 5.0))
    laws = [
        mf.friction_law(surface, mf.Interacting(substrate=substrate), load=[0.01, 0.05, 0.1])
        for substrate in (WIDE, mf.BondedLayer())
    ]
    # these cells err by 1e-4 /mm, that is by 1e-5 mm at 0.1 N
    assert_allclose(laws[0].area, laws[1].area, rtol=1e-4)
    assert_allclose(laws[0].separation, laws[1].separation, atol=1e-5)
