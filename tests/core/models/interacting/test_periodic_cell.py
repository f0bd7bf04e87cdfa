"""Interacting asperities of a periodic cell."""

from itertools import product

import numpy as np
import pytest

import metafem as mf
from metafem.models.interacting import elastic
from metafem.models.interacting.sums import Sums, find_grid
from validation.scenes.periodic import BLOCK, MATERIAL, PITCH, RADIUS, SITES, THREE, repeated

ONE = mf.Surface([[0.2, -0.1]], [0.1], RADIUS, MATERIAL, block=BLOCK, cell=mf.PeriodicCell(PITCH, PITCH))
SUBSTRATES = (mf.HalfSpace(), mf.BondedLayer())
# Changes of P(a) [%] by the neighbours on a square lattice, in the unit cell of the finite elements
# (`mf.fe.press(..., cell_radius=...)`), printed to .01 %; order 3 is off by at most .01 % more
CHANGES = [(0.12, 0.10), (0.16, 0.23), (0.20, 0.46), (0.24, 0.80)]


def test_equal_asperities_agree_with_the_unit_cell():
    for radius, change in CHANGES:
        load = 4.0 / 3.0 * radius**3 / RADIUS * (1.0 + 0.01 * change) * MATERIAL.composite_modulus
        state = mf.equilibrium(ONE, mf.Interacting(substrate=mf.BondedLayer()), load=load)
        # P grows as a^3
        assert 1.5 * (state.area / (np.pi * radius**2) - 1.0) == pytest.approx(0.0, abs=1.5e-4)


def test_a_cell_of_several_periods_is_the_same_surface():
    for order, substrate in product((1, 3), SUBSTRATES):
        model = mf.Interacting(order=order, substrate=substrate)
        for surface, times in ((ONE, 2), (THREE, 2)):
            single = mf.equilibrium(surface, model, load=0.02 * surface.count)
            several = mf.equilibrium(repeated(surface, times), model, load=times**2 * 0.02 * surface.count)
            # ten times the tolerance of the solver
            assert several.area == pytest.approx(times**2 * single.area, rel=1e-11)
            assert several.separation == pytest.approx(single.separation, rel=1e-11)
            # the tangent has a residual of 1e-4, of which the stiffness has the square
            assert several.stiffness == pytest.approx(times**2 * single.stiffness, rel=1e-8)


def test_shifted_and_wrapped_sites_are_the_same_surface():
    for order in (1, 3):
        model = mf.Interacting(order=order)
        shifted = THREE.replaced(
            position=SITES + np.array([[0.0, 0.0], [-3.0, 0.0], [0.0, -3.0]]) + [7.0, -2.0]
        )
        first, second = (mf.equilibrium(surface, model, load=0.05) for surface in (THREE, shifted))
        assert second.asperity_area == pytest.approx(first.asperity_area, rel=1e-11)
        assert second.separation == pytest.approx(first.separation, rel=1e-11)


def test_adhesive_contacts_have_images():
    model = mf.Interacting(1, contact=mf.JKR(9e-6))
    single, several = (
        mf.equilibrium(surface, model, load=0.02 * surface.count) for surface in (ONE, repeated(ONE, 2))
    )
    assert several.area == pytest.approx(4.0 * single.area, rel=1e-9)


def test_notes_state_the_convention():
    state = mf.equilibrium(THREE, mf.Interacting(), load=0.05)
    assert any("mean plane" in str(note.text) for note in state.notes)
    layer = mf.equilibrium(THREE, mf.Interacting(substrate=mf.BondedLayer()), load=0.05)
    assert not any("mean plane" in str(note.text) for note in layer.notes)


def test_the_surface_says_its_cell():
    assert "3 x 3 mm" in repr(THREE)
    assert THREE.perturbed(0.001).cell == THREE.shuffled().cell == THREE.cell
    assert THREE.replaced(cell=None) != THREE


def grid(rows, columns):
    """A rectangular grid of random heights that fills its cell, with a tenth of the sites empty."""
    rng = np.random.default_rng(4)
    x, y = np.meshgrid(1.5 * np.arange(columns) - 3.1, 1.2 * np.arange(rows) + 0.7)
    some = np.sort(rng.permutation(rows * columns)[: int(0.9 * rows * columns)])
    return mf.Surface(
        np.column_stack([x.ravel(), y.ravel()])[some],
        0.1 + 0.03 * rng.random(some.size),
        RADIUS,
        MATERIAL,
        block=mf.Block(1.5 * columns, 1.2 * rows, 7.2),
        cell=mf.PeriodicCell(1.5 * columns, 1.2 * rows),
    )


def test_sums_by_fft_equal_the_matrices():
    for substrate in (mf.HalfSpace(), mf.BondedLayer(7.2, 0.5)):
        surface = grid(5, 7)
        sums = Sums(find_grid(surface.position, surface.cell), substrate, cell=surface.cell)
        assert sums.shape == (5, 7)
        value, x, y, laplacian = substrate.influence_terms(surface)
        rng = np.random.default_rng(5)
        load, size, along_x, along_y = rng.random((4, surface.count))
        expected = (value @ load - sums.self_influence * load, laplacian @ load, x @ load, y @ load)
        found = (sums.displacement(load), *sums.field(load))
        for part, same in zip(found, expected, strict=True):
            assert part == pytest.approx(same, rel=1e-12, abs=1e-12)
        # derivatives at the source are the transposes
        source = sums.displacement(load, size, along_x, along_y)
        expected = expected[0] + laplacian @ size + x.T @ along_x + y.T @ along_y
        assert source == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(("order", "substrate"), [(3, mf.HalfSpace()), (1, mf.BondedLayer())])
def test_large_grids_are_solved_by_fft(order, substrate, monkeypatch):
    surface, model = grid(22, 23), mf.Interacting(order=order, substrate=substrate)
    fast = mf.equilibrium(surface, model, load=5.0)
    assert any("22 x 23 grid" in note.text for note in fast.notes)
    monkeypatch.setattr(elastic, "LATTICE_LIMIT", surface.count)
    dense = mf.equilibrium(surface, model, load=5.0)
    # the tolerance of fast sums is 1e-9
    assert fast.area == pytest.approx(dense.area, rel=1e-9)
    assert fast.separation == pytest.approx(dense.separation, rel=1e-9)
    assert fast.stiffness == pytest.approx(dense.stiffness, rel=1e-7)


def test_a_cell_far_wider_than_the_layer_is_refused_before_it_fills_the_memory(monkeypatch):
    monkeypatch.setattr("metafem.models._resources.memory", lambda: 2**31)
    cell = mf.PeriodicCell(100.0, 100.0)
    block = mf.Block(100.0, 100.0, 0.05)
    surface = mf.Surface([[0, 0], [1.5, 0]], [0.1, 0.1], 0.5, MATERIAL, block=block, cell=cell)
    with pytest.raises(mf.InvalidInput, match="memory"):
        mf.equilibrium(surface, mf.Interacting(1, mf.BondedLayer()), load=1e-6)
