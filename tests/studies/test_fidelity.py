"""Laws of a small design under all models, with finite elements of its block and its caps."""

from functools import partial
from importlib import import_module

import numpy as np
import pytest

import metafem as mf
from metafem.studies import summary
from metafem.studies.caps import caps_of

# Radius of the cylinder with the base area of the block [mm].
SIDE = 20.0 / np.sqrt(np.pi)


@pytest.fixture(scope="module")
def fidelity(design, tmp_path_factory):
    """The laws under all models, on a block of large cells, and the table of its caps by finite elements."""
    kept, module = [], import_module("metafem.studies.models")
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("cache")
        patch.setattr("metafem.fe.block3d.cache_folder", lambda: folder)
        patch.setattr("metafem.fe.Block3D", partial(mf.fe.Block3D, cell=0.5, edge_cell=0.05))
        patch.setattr(module, "caps_of", lambda *given: kept.append(caps_of(*given)) or kept[0])
        return mf.studies.fidelity(design), kept[0]


def test_tabulated_caps_are_those_of_the_finite_elements(fidelity):
    _, contact = fidelity
    h, a = np.mean(contact.height), 0.08
    single = mf.fe.press(a, 0.526, height=h, thickness=7.2, block_radius=SIDE)
    radius, load = contact.solve(np.array([h, h]), np.array([single.indentation, -0.01]))
    # an order above the error that the table finds of itself, at another place
    assert contact.error < 1e-3
    np.testing.assert_allclose(radius, [a, 0.0], rtol=10.0 * contact.error)
    np.testing.assert_allclose(load, [single.rescaled_load, 0.0], rtol=30.0 * contact.error)


def test_fidelity_holds_all_models(fidelity):
    found, _ = fidelity
    assert list(found.model.values) == ["independent", "half-space", "layer", "block", "fe"]
    # the block lies between layer and half-space; each model sinks less than the half-space does
    sinking = found.sinking.isel(rescaled_load=-1)
    assert sinking.sel(model="layer") < sinking.sel(model="block") < sinking.sel(model="half-space")
    # small strain and the cap's shape: a load more than Hertz's at the same radius, so less area
    assert -0.05 < found.area_change.sel(model="fe").isel(rescaled_load=-1) < 0.0
    assert len(summary(found).rows) == 5
