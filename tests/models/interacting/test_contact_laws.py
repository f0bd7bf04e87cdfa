"""Interacting asperities of any elastic law at loads of many decades."""

import numpy as np
import pytest

import metafem as mf
from tests.models.scenes import lattice


@pytest.mark.parametrize("law", [mf.PowerCap(8), mf.PowerCap(4), mf.PowerCap(1)], ids=repr)
def test_every_load_of_many_decades_converges(law):
    surface = lattice(0.12 - np.minimum(np.random.default_rng(1).exponential(0.035, 16), 0.12))
    for substrate in (mf.HalfSpace(), mf.BondedLayer()):
        curve = mf.Interacting(substrate=substrate, contact=law).curve(surface, np.geomspace(1e-10, 0.3, 40))
        assert curve.converged
        assert (np.diff(curve.area) > 0.0).all()
