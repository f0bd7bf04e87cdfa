"""Conductance against Barber's identity, discs in parallel and resolved contacts."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from validation.fidelity.order3_against_resolved import irregular as irregular_scene

LOADS = np.array([0.01, 0.05, 0.1, 0.3])


@pytest.fixture
def irregular():
    return irregular_scene().surface


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_resolved_contacts_on_a_layer(share, irregular):
    """Order 3 is off by .03 % from cells of 5 um; the cells themselves by .01 %."""
    surface = irregular.replaced(block=mf.Block(20.0, 20.0, 1.0))
    order3, resolved = (
        model.conductance(surface, LOADS[1:], share)
        for model in (
            mf.Interacting(substrate=mf.BondedLayer()),
            mf.BoundaryElements(0.005, substrate=mf.BondedLayer()),
        )
    )
    assert_allclose(order3, resolved, rtol=1e-3)
