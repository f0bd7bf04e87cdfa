"""Studies under contact laws other than Hertz's."""

import numpy as np
import pytest

import metafem as mf

CAP = mf.PowerCap(4)


@pytest.fixture(scope="module")
def surface():
    height = 0.2 - np.random.default_rng(3).exponential(0.02, 16)
    return mf.Surface.square_lattice(height, (4, 4), radius=0.526, material=mf.Material(1.36))


def test_designs_are_compared_with_their_own_law(surface):
    target = mf.OperatingPoints([0.05, 0.1], [0.5, 0.9])
    design = mf.design(target, surface, mf.Independent(contact=CAP), mf.Limits(0.2))
    found = mf.studies.interaction(design, placements=3)
    alone = mf.Independent(contact=CAP).curve(design.surface, design.law.rescaled_load).area
    coupled = mf.Interacting(contact=CAP).curve(design.surface, design.law.rescaled_load).area
    np.testing.assert_allclose(found.area_change[0, 1], coupled / alone - 1.0, rtol=1e-9, atol=1e-12)
    fidelity = mf.studies.fidelity(design)
    np.testing.assert_allclose(fidelity.area.sel(model="independent"), alone, rtol=1e-9)
    assert "fe is left out" in fidelity.attrs["notes"]
    chances = mf.studies.combined(
        design, mf.Tolerances(0.001), requirement=mf.studies.Requirement(0.1), draws=32
    )
    assert (chances.area_sd > 0.0).all()
