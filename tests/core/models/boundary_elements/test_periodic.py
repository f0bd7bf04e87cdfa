"""Resolved contacts of a periodic cell."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.boundary_elements.periodic import fitting_side, spectrum
from metafem.models.boundary_elements.solve import Scene

MATERIAL, BLOCK = mf.Material(1.36), mf.Block(20.0, 20.0, 7.2)
CELL = mf.PeriodicCell(3.0, 2.0)
SITES = np.array([[0.3, 0.4], [2.1, 0.6], [1.2, 1.6]])
SURFACE = mf.Surface(SITES, [0.1, 0.11, 0.12], 0.526, MATERIAL, block=BLOCK, cell=CELL)
SUBSTRATES = (mf.HalfSpace(), mf.BondedLayer())


def test_agrees_with_order_3():
    for substrate in SUBSTRATES:
        models = mf.BoundaryElements(0.01, substrate=substrate), mf.Interacting(substrate=substrate)
        found, expected = (mf.equilibrium(SURFACE, model, load=0.08) for model in models)
        # .37/n^2 of the area with n = 15 cells per radius, and .1 um of the separation
        assert found.area == pytest.approx(expected.area, rel=1.6e-3)
        assert found.asperity_load == pytest.approx(expected.asperity_load, rel=2e-3)
        assert found.separation == pytest.approx(expected.separation, abs=1e-5)
        assert found.residual < 1e-9


def test_load_and_approach_are_the_same_state():
    model = mf.BoundaryElements(0.02)
    by_load = mf.equilibrium(SURFACE, model, load=0.08)
    by_approach = mf.equilibrium(SURFACE, model, approach=by_load.approach)
    assert by_approach.load == pytest.approx(0.08, rel=1e-7)
    assert any("mean plane" in str(note.text) for note in by_load.notes)


def test_wrapped_sites_and_copies_are_the_same_surface():
    model = mf.BoundaryElements(0.02)
    first = mf.equilibrium(SURFACE, model, load=0.08)
    wrapped = SURFACE.replaced(position=SITES - np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 2.0]]))
    assert mf.equilibrium(wrapped, model, load=0.08).area == pytest.approx(first.area, rel=1e-7)
    copies = SURFACE.replaced(
        position=np.concatenate([SITES, SITES + np.array([0.0, 2.0])]),
        height=np.tile(SURFACE.height, 2),
        radius=np.tile(SURFACE.radius, 2),
        cell=mf.PeriodicCell(3.0, 4.0),
    )
    found = mf.equilibrium(copies, model, load=0.16)
    assert found.area == pytest.approx(2.0 * first.area, rel=1e-7)
    assert found.separation == pytest.approx(first.separation, abs=1e-10)


def test_the_influence_of_long_waves_is_that_of_the_substrate():
    for substrate in SUBSTRATES:
        # a wave of many cells: 2/q and the regular part; the mean of a cell adds (q h)^2/24
        scene = Scene(SURFACE, 0.01, substrate, mf.Hertz())
        found = spectrum(scene.substrate, CELL, 0.01, (300, 200))
        q = 2.0 * np.pi / CELL.width
        exact = (2.0 / q + scene.substrate.transform(np.array([q]))[0]) / 0.01
        assert found[1, 0] == pytest.approx(exact, rel=1e-4)
        assert found.ravel()[1:].min() > 0.0


def test_cells_divide_the_period():
    assert fitting_side(0.01, CELL) == (pytest.approx(0.01), (300, 200))
    assert fitting_side(0.011, mf.PeriodicCell(1.5, 1.5)) == (1.5 / 137, (137, 137))


def test_automatic_resolves_periodic_contacts():
    state = mf.equilibrium(SURFACE, mf.Automatic(1e-3), load=0.4)
    assert "chosen" in str(state.notes[0].text)
    assert state.area == pytest.approx(mf.equilibrium(SURFACE, mf.Interacting(), load=0.4).area, rel=2e-3)
