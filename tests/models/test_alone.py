"""Contacts without interaction at all loads against single equilibria."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.models.alone import contacts_alone
from tests.models.scenes import LAWS, scene


@pytest.mark.parametrize("name", ["hertz", *LAWS])
def test_contacts_are_those_of_single_equilibria(name):
    contact = mf.Hertz() if name == "hertz" else LAWS[name](1.0, 1.0)
    surface = scene()
    load = np.array([0.002, 0.02, 0.1])
    law = contact.for_material(surface.material)
    rescaled = load / surface.material.composite_modulus
    size, indentation = contacts_alone(law, surface.height, surface.radius, rescaled)
    for k, each in enumerate(load.tolist()):
        state = mf.equilibrium(surface, mf.Independent(contact=contact), load=each)
        assert_allclose(law.area(size[k]), state.asperity_area, rtol=1e-9, atol=1e-12)
        assert_allclose(indentation[k], state.approach - surface.gap, rtol=1e-9, atol=1e-12)
