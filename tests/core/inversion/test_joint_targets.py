"""Two targets at once: known surfaces, and fronts of misfits."""

import numpy as np
import pytest

import metafem as mf

TEMPLATE = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
FRICTION = mf.PowerLaw(0.9, (0.05, 0.2), prefactor=6.5)
STIFFNESS = mf.PowerLaw(0.5, (0.05, 0.2), prefactor=17.0, of="stiffness")


def assert_both_are_met(seed, model):
    """Meet the friction and the stiffness of one surface; the stated misfits are those of predictions."""
    known = TEMPLATE.replaced(height=0.12 * np.random.default_rng(seed).beta(2.0, 2.0, 64))
    law = mf.friction_law(known, model, load=np.linspace(0.05, 0.3, 10))
    laws = [law.area, law.rescaled_stiffness]
    targets = [mf.SampledLaw(law.rescaled_load, laws[0])]
    targets.append(mf.SampledLaw(law.rescaled_load, laws[1], of="stiffness"))
    found = mf.trade_off(*targets, TEMPLATE, model, weights=[0.5])
    assert found.misfits[found.best].max() < 2e-3
    again = mf.friction_law(found.surfaces[found.best], model, load=law.load)
    difference = np.array([again.area, again.rescaled_stiffness]) / laws - 1.0
    assert found.misfits[found.best] == pytest.approx(np.sqrt((difference**2).mean(axis=1)), rel=1e-6)


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(1)], ids=repr)
def test_two_laws_of_one_surface_are_met_together(model):
    assert_both_are_met(1, model)


def test_no_surface_of_the_front_is_better_than_another():
    found = mf.trade_off(FRICTION, STIFFNESS, TEMPLATE, weights=[0.2, 0.8])
    assert (np.diff(found.misfits[:, 0]) > 0.0).all()
    assert (np.diff(found.misfits[:, 1]) < 0.0).all()
    # one radius cannot meet both: the friction fixes the heights, and these the stiffness
    assert found.misfits.max(axis=1).min() > 0.05
    ax = found.plot()
    assert ax.get_xlabel() == "misfit of the friction [%]"
    assert ax.get_ylabel() == "misfit of the stiffness [%]"
