"""Pull-off force against closed forms and the unloading path."""

import numpy as np
import pytest

import metafem as mf

ENERGY, RADIUS = 9e-6, 0.526
SINGLE = 1.5 * np.pi * ENERGY * RADIUS


def rough(spread):
    height = 0.1 + spread * np.random.default_rng(0).random(9)
    return mf.Surface.square_lattice(height, (3, 3), 1.5, radius=RADIUS, material=mf.Material(1.36))


def test_one_contact():
    for model in [mf.Independent(mf.JKR(ENERGY)), mf.Interacting(1, contact=mf.JKR(ENERGY))]:
        surface = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, mf.Material(1.36))
        assert mf.pull_off(surface, model, load=0.01) == pytest.approx(SINGLE, rel=1e-12)


def test_equal_independent_contacts_break_together():
    model = mf.Independent(mf.JKR(ENERGY))
    assert mf.pull_off(rough(0.0), model, load=0.05) == pytest.approx(9 * SINGLE, rel=1e-12)


@pytest.mark.parametrize(
    "model",
    [mf.Independent(mf.JKR(ENERGY)), mf.Interacting(1, contact=mf.JKR(ENERGY))],
)
def test_path_ends_at_the_pull_off_force(model):
    surface = rough(0.003)
    found = mf.pull_off(surface, model, load=0.05)
    assert 0.0 < found < 9 * SINGLE
    loads = [-found * (1.0 - 1e-6), 0.05]
    assert mf.friction_law(surface, model, load=loads, unloading=True).load[0] == loads[0]
    with pytest.raises(mf.InvalidInput, match="beyond pull-off"):
        mf.friction_law(surface, model, load=[-found * (1.0 + 1e-6), 0.05], unloading=True)


def test_asperities_that_were_not_in_contact_do_not_adhere():
    model, surface = mf.Independent(mf.JKR(ENERGY)), rough(0.003)
    assert mf.pull_off(surface, model, load=1e-6) < mf.pull_off(surface, model, load=0.1)
