"""The estimated error of interacting asperities of a periodic cell."""

import metafem as mf
from tests.core.models.interacting.test_periodic_cell import ONE
from validation.scenes.periodic import MATERIAL, RADIUS


def test_the_estimated_error_bounds_that_of_resolved_contacts():
    load = 4.0 / 3.0 * 0.35**3 / RADIUS * MATERIAL.composite_modulus
    found = mf.equilibrium(ONE, mf.Interacting(), load=load)
    coarse, fine = (mf.equilibrium(ONE, mf.BoundaryElements(cell), load=load).area for cell in (0.01, 0.005))
    error = found.area / (fine + (fine - coarse) / 3.0) - 1.0
    assert 0.0 < error < found.model_error < 2.0 * error
