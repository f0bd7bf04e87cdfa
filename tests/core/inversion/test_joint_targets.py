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


@pytest.mark.parametrize("seed", range(3))
def test_two_laws_of_one_surface_are_met_together(seed):
    height = 0.12 * np.random.default_rng(seed).beta(2.0, 2.0, 64)
    found = mf.trade_off(*both_of(TEMPLATE.replaced(height=height)), TEMPLATE, weights=[0.5])
    assert found.misfits[found.best].max() < 2e-3
    # the stated misfits are those of the predictions
    for target, misfit, name in zip(
        found.targets, found.misfits[found.best], ("area", "rescaled_stiffness"), strict=True
    ):
        law = mf.friction_law(found.surfaces[found.best], load=1.36 * target.rescaled_load)
        difference = getattr(law, name) / target.rescaled_friction - 1.0
        assert np.sqrt(np.mean(difference**2)) == pytest.approx(misfit, rel=1e-6)


def test_no_surface_of_the_front_is_better_than_another():
    friction = mf.PowerLaw(0.9, RANGE, prefactor=6.5)
    stiffness = mf.PowerLaw(0.5, RANGE, prefactor=17.0, of="stiffness")
    found = mf.trade_off(friction, stiffness, TEMPLATE, weights=[0.1, 0.5, 0.9])
    assert (np.diff(found.misfits[:, 0]) > 0.0).all()
    assert (np.diff(found.misfits[:, 1]) < 0.0).all()
    # one radius cannot meet both: the friction fixes the heights, and these the stiffness
    assert found.misfits.max(axis=1).min() > 0.05
    ax = found.plot()
    assert ax.get_xlabel() == "misfit of the friction [%]"
    assert ax.get_ylabel() == "misfit of the stiffness [%]"
