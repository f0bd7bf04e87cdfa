"""Laws of a small design under all models, with finite elements of its block."""

from functools import partial

import metafem as mf
from metafem.studies import summary


def test_fidelity_holds_all_models(design, tmp_path, monkeypatch):
    monkeypatch.setattr("metafem.fe.block3d.cache_folder", lambda: tmp_path)
    monkeypatch.setattr("metafem.fe.Block3D", partial(mf.fe.Block3D, cell=0.5, edge_cell=0.05))
    found = mf.studies.fidelity(design)
    names = ["independent", "half-space", "layer", "layer with pedestals", "block"]
    assert list(found.model.values) == names
    # the block lies between layer and half-space; pedestals yield, so the plane sinks more
    sinking = found.sinking.isel(rescaled_load=-1)
    assert sinking.sel(model="layer") < sinking.sel(model="block") < sinking.sel(model="half-space")
    assert sinking.sel(model="layer") < sinking.sel(model="layer with pedestals")
    assert len(summary(found).rows) == len(names)
