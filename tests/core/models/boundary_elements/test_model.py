"""Resolved contacts against Hertz, the reference, and other grids."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.models import _resources
from metafem.models.boundary_elements import cells, solve
from metafem.models.boundary_elements.model import within
from tests.models.scenes import said, single_contact

MATERIAL = mf.Material(1.36)
RADIUS = 0.526
PAIR = mf.Surface([[0.0, 0.0], [1.0, 0.3]], [0.1, 0.11], RADIUS, MATERIAL)
COARSE = mf.BoundaryElements(0.008)


def hertz_errors(per_radius, *offset):
    """Relative errors in load and in area at one approach."""
    state, exact = single_contact(mf.Hertz(), per_radius, offset)
    return abs(state.load / exact.load - 1.0), abs(state.area / exact.area - 1.0)


@settings(deadline=None, max_examples=8)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_hertz_is_met_at_any_offset_from_the_grid(x, y):
    load, area = hertz_errors(50, x, y)
    assert load <= 5e-5
    assert area <= 1.5e-4


def test_area_of_few_cells_grows_with_the_load():
    """Four cells per radius, and 1 % between the loads."""
    one = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL)
    radius = 0.1205 * 1.01 ** (np.arange(24) / 3.0)
    load = 1.36 * 4.0 / 3.0 * radius**3 / RADIUS
    area = mf.friction_law(one, mf.BoundaryElements(0.03), load=load).area
    np.testing.assert_allclose(area, np.pi * radius**2, rtol=0.01)
    assert (np.diff(area) > 0.0).all()


def test_an_initial_guess_without_solution_raises(monkeypatch):
    """Neither order 1 nor independent asperities have a solution: their state is no guess of the contacts."""
    curve = mf.Independent().curve(PAIR, [0.05])
    failed = replace(curve, residual=np.ones(1))
    for model in (mf.Interacting, mf.Independent):
        monkeypatch.setattr(model, "curve", lambda *_, **__: failed)
    with pytest.raises(mf.NotConverged):
        COARSE.curve(PAIR, [0.05])


def on_layer(surface, thickness, cell=0.008, **given):
    bonded = surface.replaced(block=mf.Block(20.0, 20.0, thickness))
    return mf.equilibrium(bonded, mf.BoundaryElements(cell, mf.BondedLayer()), **given)


def test_a_layer_bends_the_contact_by_its_self_curvature():
    lone = mf.Surface([[0.0, 0.0]], [0.3], RADIUS, MATERIAL)
    state = on_layer(lone, 1.5, cell=0.004, load=0.05)
    load, cube = 0.05 / MATERIAL.composite_modulus, (state.area / math.pi) ** 1.5
    bend = load * mf.BondedLayer(1.5, 0.5).self_curvature
    # Hertz with the bent summit, P = 4/3 a^3 (1/R + bend); the next term is (a/t)^2 of the bend
    assert load / (4.0 / 3.0 * cube) == pytest.approx(1.0 / RADIUS + bend, rel=3e-4)
    assert bend * RADIUS > 2e-3


def test_what_is_less_sure_is_said():
    deep, close = PAIR.replaced(height=[0.3, 0.31]), PAIR.replaced(position=[[0.0, 0.0], [0.1, 0.0]])
    thin = on_layer(deep, 0.1, load=0.05)
    plain, merged, small = (
        mf.equilibrium(surface, COARSE, load=0.05)
        for surface in (deep, close, PAIR.replaced(height=[0.1, 0.2018]))
    )
    assert "order 1 has no solution" in said(thin)
    assert "not that of a Hertzian ellipse" in said(thin)
    # an incompressible layer squeezed thin: stiffer than any half-space
    assert thin.stiffness > 2.0 * plain.stiffness
    assert "order 1 has no solution" not in said(plain)
    assert 0.0 < plain.residual <= COARSE.curve(deep, load=[0.05]).tolerance == 1e-9
    assert "merged" in said(merged)
    assert "fewer than 4 cells" in said(small)


def test_neighbourhoods_grow_until_they_hold_the_contacts(monkeypatch):
    full = mf.equilibrium(PAIR, COARSE, load=0.05)
    monkeypatch.setattr(solve, "MARGIN_CELLS", 1.0)
    monkeypatch.setattr(solve, "MARGIN_SHARE", -0.5)
    grown = mf.equilibrium(PAIR, COARSE, load=0.05)
    assert grown.area == pytest.approx(full.area, rel=1e-7)


def test_memory_is_that_of_the_machine_or_a_guess(monkeypatch):
    def unknown(name):
        raise ValueError(name)

    assert _resources.memory() > 2**28
    monkeypatch.setattr(_resources.os, "sysconf", unknown)
    assert _resources.memory() == 2**33


def test_stopping_early_raises_with_the_state(monkeypatch):
    monkeypatch.setattr(solve, "Program", partial(solve.Program, max_iterations=1))
    monkeypatch.setattr(solve, "MAX_GROWTHS", 1)
    with pytest.raises(mf.NotConverged) as caught:
        mf.equilibrium(PAIR, COARSE, load=0.05)
    assert caught.value.state.residual > 1e-9


def test_patches_give_what_one_grid_gives(monkeypatch):
    surface = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.1], (2, 2), 0.9, radius=RADIUS, material=MATERIAL)
    apart = mf.equilibrium(surface, COARSE, load=0.1)
    assert len(apart.field.shape) == 4
    monkeypatch.setattr(cells, "SLOWEST_RATE", math.inf)
    whole = mf.equilibrium(surface, COARSE, load=0.1)
    assert len(whole.field.shape) == 1
    np.testing.assert_allclose(apart.asperity_load, whole.asperity_load, rtol=1e-8)
    np.testing.assert_allclose(apart.asperity_area, whole.asperity_area, rtol=1e-8)


def test_a_summit_in_the_contact_of_another_gets_cells_up_to_the_end_of_its_own():
    """The lower summit seems out of contact at first, and its part of the contact ends at the cells' edge."""
    pair = mf.Surface([[0.0, 0.0], [0.1, 0.0]], [0.10, 0.12], 0.526, mf.Material(1.36))
    state = mf.equilibrium(pair, mf.BoundaryElements(0.004), load=0.2)
    assert state.status is mf.Status.CONVERGED
    coarse = mf.equilibrium(pair, mf.BoundaryElements(0.01), load=0.2)
    assert state.area == pytest.approx(coarse.area, rel=5e-3)


def test_the_stated_error_bounds_that_of_contacts_whose_shape_is_nearly_elliptic():
    """The reference is extrapolated to vanishing cells, see `validation.stability.stability_map`; +- 8e-5."""
    nine = mf.Surface.square_lattice(20.0, (3, 3), 1.0, radius=10.0, material=mf.Material(1.0))
    for cells_per_pitch in (20, 32, 40, 64):
        model = mf.BoundaryElements(1.0 / cells_per_pitch)
        state = mf.equilibrium(nine, model, load=0.1022208)
        assert abs(state.area / 5.2215 - 1.0) <= state.model_error


def test_cells_for_a_tolerance_are_chosen_once():
    four = mf.Surface.square_lattice(0.2, (2, 2), 0.3, radius=RADIUS, material=MATERIAL)
    for surface, tolerance in ((PAIR, 1e-4), (four, 5e-3)):
        for control in ({"load": np.array([0.05])}, {"approach": np.array([0.04])}):
            _, curve = within(tolerance, surface, substrate=mf.HalfSpace(), **control)
            assert curve.error <= tolerance
