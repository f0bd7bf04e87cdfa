"""Two targets at once: known surfaces, fronts of misfits, and refusals."""

import numpy as np
import pytest

import metafem as mf

TEMPLATE = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
RANGE = (0.05, 0.2)


def both_of(surface, model=None):
    law = mf.friction_law(surface, model, load=np.linspace(0.05, 0.3, 10))
    friction = mf.SampledLaw(law.rescaled_load, law.area)
    return friction, mf.SampledLaw(law.rescaled_load, law.rescaled_stiffness, of="stiffness")


@pytest.mark.parametrize("model", [mf.Interacting(1), mf.Interacting(), mf.MeanField()])
def test_two_laws_of_one_surface_are_met_together_under_interaction(model):
    surface = TEMPLATE.replaced(height=0.12 * np.random.default_rng(1).beta(2.0, 2.0, 64))
    found = mf.trade_off(*both_of(surface, model), TEMPLATE, model, weights=[0.5])
    assert found.misfits[found.best].max() < 2e-3
    for target, misfit, name in zip(
        found.targets, found.misfits[found.best], ("area", "rescaled_stiffness"), strict=True
    ):
        law = mf.friction_law(found.surfaces[found.best], model, load=1.36 * target.rescaled_load)
        difference = getattr(law, name) / target.rescaled_friction - 1.0
        assert np.sqrt(np.mean(difference**2)) == pytest.approx(misfit, rel=1e-6)


@pytest.mark.slow
def test_several_radii_meet_what_one_cannot():
    friction = mf.PowerLaw(0.9, RANGE, prefactor=6.5)
    stiffness = mf.PowerLaw(0.5, RANGE, prefactor=17.0, of="stiffness")
    found = mf.trade_off(friction, stiffness, TEMPLATE, tools=[0.2, 0.526, 1.0], weights=[0.3, 0.5, 0.7])
    assert found.misfits.max(axis=1).min() < 0.01
    assert set(found.surfaces[found.best].radius) <= {0.2, 0.526, 1.0}
