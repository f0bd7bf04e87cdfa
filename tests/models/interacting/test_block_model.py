"""Asperities coupled through the true block."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.contact import pedestal_compliance
from tests.models.scenes import PLACE, scene

# One solution of large cells, a second; the block is twelve times as wide as thick.
WIDE = mf.fe.Block3D(cell=0.5, edge_cell=0.1)
LAYER = mf.BondedLayer()
THICKNESS = 5.0
LOADS = np.array([0.01, 0.05, 0.1])


@pytest.fixture(autouse=True, scope="module")
def cache_folder(tmp_path_factory):
    """A cache folder of the tests' own."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("cache")
        patch.setattr("metafem.fe.block3d.cache.cache_folder", lambda: folder)
        yield


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 3])
def test_a_wide_block_is_the_layer(order):
    surface = scene(PLACE - PLACE.mean(axis=0)).replaced(block=mf.Block(60.0, 60.0, THICKNESS))
    laws = [
        mf.friction_law(surface, mf.Interacting(order=order, substrate=substrate), load=LOADS)
        for substrate in (WIDE, LAYER)
    ]
    # these cells err by 1e-4 /mm, that is by 1e-5 mm at 0.1 N
    assert_allclose(laws[0].area, laws[1].area, rtol=1e-4)
    assert_allclose(laws[0].separation, laws[1].separation, atol=1e-5)


@dataclass(frozen=True)
class Raised:
    """The half-space as matrices, as a block gives them, with self terms (n,) on the diagonal [1/mm]."""

    own: tuple[float, ...]

    def for_surface(self, surface):
        return self

    def influence_matrix(self, surface):
        return mf.HalfSpace().influence_matrix(surface) + np.diag(self.own)

    def influence_derivatives(self, surface):
        return mf.HalfSpace().influence_derivatives(surface)


@pytest.mark.parametrize("order", [1, 3])
def test_pedestals_are_self_terms_of_the_matrix(order):
    surface = scene(PLACE)
    own = pedestal_compliance(surface.height, surface.radius) / np.pi
    plain, raised = Raised((0.0,) * surface.count), Raised(tuple(own.tolist()))
    first = mf.friction_law(surface, mf.Interacting(order=order, substrate=plain, pedestal=True), load=LOADS)
    second = mf.friction_law(surface, mf.Interacting(order=order, substrate=raised), load=LOADS)
    assert_allclose(first.area, second.area, rtol=1e-12)
    assert_allclose(first.separation, second.separation, atol=1e-12)
