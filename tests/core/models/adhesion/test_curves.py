"""Curves with adhesive contacts: loading, unloading, jumps, limits and sensitivities."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from tests.models.scenes import lattice

ENERGY, MODULUS, RADIUS, PITCH = 9e-6, 1.36, 0.526, 1.5
JKR = mf.JKR(ENERGY)
MODELS = [
    mf.Independent(JKR),
    mf.Interacting(order=1, contact=JKR),
    mf.Interacting(order=1, substrate=mf.BondedLayer(), contact=JKR, pedestal=True),
]
HEIGHT = 0.15 - np.random.default_rng(4).uniform(0.0, 0.03, 9)


def test_two_equal_asperities():
    """Order 1 on the half-space has approach = d(a) + P/(pi L) with the load P/E* of each."""
    for unloading in (False, True):
        surface = mf.Surface([[0, 0], [PITCH, 0]], [0.1, 0.1], RADIUS, mf.Material(MODULUS))
        law = JKR.for_material(surface.material)
        pull_off = 2.0 * law.load(law.pull_off_radius(RADIUS), RADIUS)
        load = np.linspace(0.9999 * pull_off if unloading else 0.0, 0.05, 30)
        curve = MODELS[1].curve(surface, load, unloading=unloading)
        assert curve.converged
        a = np.sqrt(0.5 * curve.area / np.pi)
        assert_allclose(2.0 * law.load(a, RADIUS), load, atol=1e-10 * load[-1])
        expected = law.indentation(a, RADIUS) + 0.5 * load / (np.pi * PITCH)
        assert_allclose(curve.approach, expected, atol=1e-10 * expected[-1])
        assert (curve.stiffness > 0.0).all()


@pytest.mark.parametrize("model", MODELS, ids=repr)
def test_unloading_keeps_contacts_down_to_pull_off(model):
    surface = lattice(0.15 - 0.05 * (0.15 - HEIGHT))
    with pytest.raises(mf.InvalidInput, match=r"load = -1 N is beyond pull-off: .* break at -") as refused:
        mf.friction_law(surface, model, load=[-1.0, 0.05], unloading=True)
    pull_off = float(str(refused.value).split("break at ")[1].split(" N")[0])
    load = np.append(pull_off * (1 - 1e-5), np.linspace(0.0, 0.05, 6))
    back = mf.friction_law(surface, model, load=load, unloading=True)
    law = mf.friction_law(surface, model, load=load[1:])
    assert back.load[0] < 0.0 < back.area[0]
    assert (back.area[1:] >= law.area * (1 - 1e-12)).all()
    assert back.area[1] > law.area[0] > 0.0
    assert back.area[-1] == pytest.approx(law.area[-1], rel=1e-12)
    for one in (back, law):
        assert (np.diff(one.area) > 0.0).all()
        assert (one.stiffness > 0.0).all()
        assert (one.residual <= 1e-12).all()
    # an asperity that has just jumped in pulls
    assert mf.equilibrium(surface, model, approach=1e-9).load < 0.0


def test_elastic_contacts_unload_as_they_load():
    surface, load = lattice(HEIGHT), [0.01, 0.02]
    for model in (mf.Independent(), mf.Interacting(), mf.Independent(mf.JKR(0.0))):
        back, law = (mf.friction_law(surface, model, load=load, unloading=way) for way in (True, False))
        assert_allclose(back.area, law.area, rtol=0)
    assert law.area[0] == pytest.approx(mf.equilibrium(surface, load=0.01).area, rel=1e-12)


def test_default_loads_of_strong_adhesion_increase():
    soft = mf.Surface([[0.0, 0.0]], [0.1], 0.526, mf.Material(0.01))
    law = mf.friction_law(soft, mf.Independent(mf.JKR(27e-6)))
    assert (np.diff(law.load) > 0.0).all()
