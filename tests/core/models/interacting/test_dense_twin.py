"""The kernels for paraboloids against the dense twin."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from tests.models.interacting.dense_twin import Twin
from tests.models.scenes import lattice, scene


def test_paraboloids_are_those_of_the_kernels():
    for order in (1, 3):
        thin = mf.BondedLayer(1.0, 0.3)
        for substrate in (mf.HalfSpace(), mf.BondedLayer(), thin):
            layer = {"thickness": 1.0, "poisson_ratio": 0.3} if substrate == thin else {}
            model = mf.Interacting(order, substrate)
            for surface in (scene(**layer), lattice(0.1 + 0.01 * np.arange(9.0), **layer)):
                twin = Twin(surface, mf.Hertz(), order, substrate)
                for load in (0.01, 0.1):
                    state = mf.equilibrium(surface, model, load=load)
                    approach, p, area, residual = twin.solve(load=load / 1.36)
                    assert residual <= 1e-12
                    assert approach == pytest.approx(state.approach, rel=1e-11)
                    assert_allclose(p, state.asperity_load / 1.36, rtol=1e-10, atol=1e-15)
                    assert_allclose(area, state.asperity_area, rtol=1e-10, atol=1e-15)
                    at = twin.solve(approach=approach)
                    assert at[1].sum() == pytest.approx(load / 1.36, rel=1e-10)
