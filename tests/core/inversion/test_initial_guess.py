"""The first guess of heights for samples of a law."""

import numpy as np
import pytest

import metafem as mf
from metafem.contact.law import contacts
from metafem.inversion.search.initial_guess import initial_heights

MATERIAL = mf.Material(1.36)


@pytest.mark.parametrize("law", [mf.PowerCap(3.7), mf.KogutEtsion(14.0), mf.JacksonGreen(5.0)], ids=repr)
def test_no_asperity_enters_where_the_earlier_ones_have_load_and_area(law):
    """The law of one asperity: between two samples the first has both, up to rounding."""
    own = law.for_material(MATERIAL)
    for depth in np.random.default_rng(0).uniform(1e-3, 0.02, 50):
        one = contacts(own, depth * np.geomspace(0.01, 1.0, 6), np.array(0.526))
        height, radius, _ = initial_heights(own, one.load, one.area, np.full(6, 0.526), 4)
        assert len(height) == len(radius) >= 1
        assert ((-depth <= height) & (height <= 0.0)).all()
