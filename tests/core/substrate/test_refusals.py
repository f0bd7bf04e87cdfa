"""Refused values of the substrates."""

import numpy as np
import pytest

import metafem as mf
from tests.refusals import faults

BLOCK = mf.Block(20.0, 20.0, 7.2)
FREE = mf.Surface([[0, 0], [1, 0]], [0.1, 0.1], 0.5, mf.Material(1, 0.45))
SURFACE = FREE.replaced(block=BLOCK)
PERIODIC = FREE.replaced(cell=mf.PeriodicCell(3.0, 3.0))


class Mine(mf.substrate.Radial):
    """A substrate without a transform."""

    self_influence = self_curvature = 0.0

    def regular_derivatives(self, distance):
        return distance, distance, distance


REFUSALS = [
    (lambda: mf.BondedLayer(0.0), "thickness", "0"),
    (lambda: mf.BondedLayer(1.0, 0.51), "poisson_ratio", "0.51"),
    (lambda: mf.BondedLayer().influence(1.0), "thickness", "for_surface"),
    (lambda: mf.BondedLayer(5.0).for_surface(SURFACE), "thickness = 5", "7.2"),
    (lambda: mf.BondedLayer(7.2, 0.3).for_surface(SURFACE), "poisson_ratio = 0.3", "0.45"),
    (lambda: mf.BondedLayer().for_surface(FREE), "BondedLayer", "block"),
    (lambda: mf.HalfSpace().influence(0.0), "distance", "0.0"),
    (lambda: mf.HalfSpace().influence(np.nan), "distance", "nan"),
    (lambda: mf.equilibrium(PERIODIC, mf.Interacting(substrate=Mine()), load=0.01), "transform", "Mine"),
]


@pytest.mark.parametrize(("call", "key", "value"), REFUSALS)
def test_refusals(call, key, value):
    assert faults([(call, key, value)]) == []
