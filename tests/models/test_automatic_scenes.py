"""`Automatic` on random scenes from sparse to merged contacts: errors at every load of a curve."""

import numpy as np
import pytest

import metafem as mf

pytestmark = pytest.mark.slow

# Part of the tolerance up to which the estimated error of order 3 makes it the truth.
NEGLIGIBLE = 0.1

# Bound of the error by the size of contacts that is taken in place of an estimate.
NEGLIGIBLE_BOUND = 1e-5


def scene(seed):
    """Return 2 to 9 asperities, contacts from far apart to merged, a substrate, a tolerance and 8 loads."""
    rng = np.random.default_rng(seed)
    side = int(rng.integers(2, 4))
    count = int(rng.integers(2, side**2 + 1))
    pitch = 10.0 ** rng.uniform(-0.8, 1.0)
    row, column = np.divmod(rng.permutation(side**2)[:count], side)
    position = pitch * (np.column_stack([row, column]) + rng.uniform(-0.2, 0.2, (count, 2)))
    height = 0.3 - rng.uniform(0.0, 10.0 ** rng.uniform(-3.0, -1.3), count)
    block = mf.Block(1000.0, 1000.0, 10.0 ** rng.uniform(0.0, 1.0))
    surface = mf.Surface(position, height, rng.uniform(0.3, 0.6), mf.Material(1.0, 0.5), block=block)
    substrate = (mf.HalfSpace(), mf.BondedLayer())[seed % 2]
    load = np.geomspace(0.02, 1.0, 8) * 10.0 ** rng.uniform(-2.0, -0.5)
    return surface, substrate, (1e-3, 1e-2)[seed % 4 > 0], load


def truth(surface, substrate, tolerance, load):
    """Return A0 by order 3 where its error is negligible, else by contacts resolved twice as well."""
    try:
        third = mf.equilibrium(surface, mf.Interacting(3, substrate), load=load)
        if third.model_error <= NEGLIGIBLE * tolerance:
            return third.area, float(third.model_error)
    except mf.NotConverged:
        pass
    fine = mf.equilibrium(surface, mf.Automatic(0.5 * tolerance, substrate), load=load)
    if not isinstance(fine.model, mf.BoundaryElements):
        cell = np.sqrt(0.25 * tolerance * fine.area / (9.0 * surface.count))
        fine = mf.equilibrium(surface, mf.BoundaryElements(cell, substrate), load=load)
    return fine.area, float(fine.model_error)


@pytest.mark.parametrize("seed", range(36))
def test_errors_are_within_the_tolerance_and_as_estimated_at_every_load(seed):
    surface, substrate, tolerance, load = scene(seed)
    law = mf.friction_law(surface, mf.Automatic(tolerance, substrate), load=load)
    assert law.model_error <= tolerance
    for newtons, area in zip(load, law.area, strict=True):
        state = mf.equilibrium(surface, mf.Automatic(tolerance, substrate), load=newtons)
        # the cells of a curve are chosen once for all its resolved contacts
        resolved = isinstance(state.model, mf.BoundaryElements)
        assert area == pytest.approx(state.area, rel=2.0 * tolerance if resolved else 1e-9)
        exact, uncertainty = truth(surface, substrate, tolerance, newtons)
        error = abs(area / exact - 1.0)
        assert error <= tolerance + uncertainty
        estimate = law.model_error if resolved else state.model_error
        assert error <= 3.0 * estimate + uncertainty + 1e-12
        assert resolved or state.model_error <= law.model_error + NEGLIGIBLE_BOUND
        if isinstance(state.model, mf.Independent) and error > max(1e-4, 10.0 * uncertainty):
            assert state.model_error <= 5.0 * error
