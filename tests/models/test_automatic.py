"""The choice of a model by estimates of the errors."""

import numpy as np
import pytest

import metafem as mf
from metafem.models import automatic as automatic_module
from tests.models.scenes import PLACE, lattice, scene

# Errors of A0 at fixed load of order 1 and of order 3 against resolved contacts on a 3 x 3 lattice, and
# the indentation of the independent model at which they were found [mm].
RESOLVED = [(0.1, 0.0012, 0.00001), (0.2, 0.0030, 0.0001), (0.3, 0.0051, 0.00027), (0.45, 0.0086, 0.00066)]


@pytest.mark.parametrize(("approach", "order_1", "order_3"), RESOLVED)
def test_estimates_bound_the_errors_against_resolved_contacts(approach, order_1, order_3):
    surface = lattice(0.5 * np.ones(9))
    load = mf.equilibrium(surface, mf.Interacting(), approach=approach).load / 1.36
    _, first, third = (error for _, _, error in mf.Automatic(order_1 / 2)._errors(surface, np.array([load])))
    assert order_1 < first < 1.07 * order_1
    assert order_3 < third < 2e-3


@pytest.mark.parametrize("substrate", [mf.HalfSpace(), mf.BondedLayer()])
def test_independence_is_no_worse_than_estimated(substrate):
    surface = lattice(0.1 + 0.004 * np.random.default_rng(2).random(64))
    for load in (0.01, 0.1, 1.0):
        alone = mf.equilibrium(surface, load=load)
        full = mf.equilibrium(surface, mf.Interacting(substrate=substrate), load=load)
        (_, _, error), *_ = mf.Automatic(1.0, substrate)._errors(surface, np.array([load / 1.36]))
        assert abs(alone.area / full.area - 1) < error < 1.1 * abs(alone.area / full.area - 1) + 1e-3


@pytest.mark.parametrize(
    ("tolerance", "model"),
    [(0.9, mf.Independent()), (8e-4, mf.Interacting(order=1)), (5e-4, mf.Interacting(order=3))],
)
def test_the_cheapest_model_within_the_tolerance_is_chosen(tolerance, model):
    state = mf.equilibrium(lattice(0.1 * np.ones(9)), mf.Automatic(tolerance), load=0.15)
    assert state.model == model
    names = {mf.Independent(): "independent", mf.Interacting(order=1): "order 1"}
    assert state.notes[0].text.startswith(f"chosen: {names.get(model, 'order 3')}; estimated errors")
    assert (
        mf.friction_law(lattice(0.1 * np.ones(9)), mf.Automatic(tolerance), load=[0.15]).notes == state.notes
    )


def test_what_no_asperity_model_holds_is_resolved():
    surface, automatic = lattice(0.5 * np.ones(4)), mf.Automatic(3e-3)
    state = mf.equilibrium(surface, automatic, load=4.0)
    assert isinstance(state.model, mf.BoundaryElements)
    assert "resolved by 11 cells" in state.notes[0].text
    law = mf.friction_law(surface, automatic, load=[0.01, 4.0])
    assert law.area[0] == pytest.approx(mf.equilibrium(surface, automatic, load=0.01).area, rel=1e-10)
    assert law.area[1] == pytest.approx(state.area, rel=1e-6)
    assert [note.text.split(";")[0] for note in law.notes if "chosen" in note.text] == [
        "up to 0.01 N: chosen: independent",
        "up to 4 N: chosen: resolved contacts",
    ]


def test_a_block_that_is_left_aside_is_said():
    surface = lattice(0.1 * np.ones(9)).replaced(block=mf.Block(20.0, 20.0, 7.2))
    for model, said in ((mf.Automatic(), True), (mf.Automatic(substrate=mf.BondedLayer()), False)):
        notes = mf.friction_law(surface, model, load=[0.1, 0.15]).notes
        assert any("block is not used" in note.text for note in notes) == said


def test_what_cannot_be_resolved_is_said(monkeypatch):
    monkeypatch.setattr(automatic_module, "DENSE_LIMIT", 1)
    state = mf.equilibrium(lattice(0.5 * np.ones(9)), mf.Automatic(1e-6), load=1.0)
    assert "resolved contacts are needed" in state.notes[0].text


def test_laws_and_approaches_follow_the_chosen_model():
    surface, automatic = lattice(0.1 * np.ones(9)), mf.Automatic(5e-4)
    law = mf.friction_law(surface, automatic, load=[0.0, 0.1, 0.15])
    assert law.area[2] == pytest.approx(mf.equilibrium(surface, mf.Interacting(), load=0.15).area, rel=1e-12)
    state = mf.equilibrium(surface, mf.Automatic(0.9), approach=0.05)
    assert state.load == mf.equilibrium(surface, mf.Interacting(order=1), approach=0.05).load
    assert mf.equilibrium(scene(PLACE[:1], [0.1], 0.5), automatic, load=0.1).model == mf.Independent()
    apart = mf.friction_law(surface, mf.Automatic(0.9), separation=[0.08, 0.05])
    assert apart.load[1] == pytest.approx(state.load, rel=1e-10)


@pytest.mark.parametrize("arguments", [{"tolerance": 0.0}, {"tolerance": "low"}, {"substrate": 3}])
def test_refuses_what_it_cannot_use(arguments):
    with pytest.raises(mf.InvalidInput):
        mf.Automatic(**arguments)
