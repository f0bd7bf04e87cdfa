"""Bands: which law is chosen, which bands are refused, and what the misfit is."""

import numpy as np
import pytest

import metafem as mf
from validation.scenes.random_laws import LATTICE, random_law

LIMITS = mf.Limits(0.6)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_wider_bands_stay_feasible(seed):
    law = random_law(seed, 12)
    for width in (0.005, 0.02, 0.1):
        low, high = (1.0 - width) * law.rescaled_friction, (1.0 + width) * law.rescaled_friction
        found = mf.design(mf.Band(law.rescaled_load, low, high), LATTICE, limits=LIMITS)
        assert found.misfit == 0.0
        assert 0.0 < found.parameters["band_margin"] <= 1.0


@pytest.mark.slow
def test_the_model_decides():
    law, model = random_law(1, 6), mf.Interacting()
    low, high = 0.94 * law.rescaled_friction, 1.0 * law.rescaled_friction
    found = mf.design(mf.Band(law.rescaled_load, low, high), LATTICE, model, LIMITS)
    area = mf.friction_law(found.surface, model, load=1.36 * law.rescaled_load).area
    assert found.misfit == 0.0
    assert np.all((area >= low) & (area <= high))
