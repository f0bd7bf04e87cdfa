"""Jumps of many interacting adhesive asperities."""

import numpy as np

import metafem as mf
from tests.core.models.adhesion.test_jumps import ENERGY, check_jumps, scene_of

LARGEST = 0.3


def test_64_asperities_at_200_loads():
    substrate = mf.BondedLayer()
    height = 0.15 - np.random.default_rng(2).uniform(0.0, 0.04, 64)
    surface, scene = scene_of(height, substrate)
    model = mf.Interacting(substrate=substrate, contact=mf.JKR(ENERGY))
    load = np.linspace(0.0, LARGEST, 200)
    curves = [model.curve(surface, load, unloading=way) for way in (False, True)]
    for curve in curves:
        assert curve.converged
        assert (curve.stiffness > 0.0).all()
        assert (np.diff(curve.area) > 0.0).all()
    assert (curves[1].area >= curves[0].area * (1.0 - 1e-12)).all()
    for way in (False, True):
        check_jumps(scene, LARGEST, way, [2, 30, 50])
