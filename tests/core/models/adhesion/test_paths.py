"""Paths of adhesive contacts: each state is stable, and all ways to a state agree."""

import contextlib

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.models.adhesion.contacts import Scene, States
from metafem.models.adhesion.path import loaded, unloaded
from metafem.models.interacting.influence import coupling_between
from tests.models.scenes import lattice, scene

ENERGY = 9e-6
CAPS = [mf.Hertz(), mf.Elastic(mf.Power(1.5))]


def scene_of(surface, substrate=mf.HalfSpace(), law=mf.JKR(ENERGY)):  # noqa: B008
    (source, _), regular = coupling_between(surface, substrate.for_surface(surface), 1)
    influence = source.T + np.diag(regular)
    summits = np.broadcast_to(surface.radius, surface.gap.shape)
    return Scene(law.for_material(surface.material), summits, surface.gap, influence)


def states_of(asperities, load, back):
    """States at increasing loads, on loading or unloading."""
    return unloaded(asperities, load)[0] if back else loaded(asperities, load)


def uneven(seed=1):
    return lattice(0.15 - np.random.default_rng(seed).uniform(0.0, 0.03, 9))


@pytest.mark.parametrize("cap", CAPS, ids=repr)
def test_derivatives_are_those_of_the_equations(cap):
    surface, step = scene(), 1e-5
    closed = np.array([[True, False, True, True, False, True]])
    some = scene_of(surface, mf.BondedLayer(), mf.JKR(9e-5, cap))
    a = np.array([0.12, 0.0, 0.2, 0.15, 0.0, 0.18])

    def state(radii):
        return States(some, closed, radii[None], np.array([0.02]), some.at_load(np.array([0.01])))

    rows = np.flatnonzero(closed[0])
    at = state(a)
    # J^-1 of the change of F by each radius is the unit vector of this radius
    ends = [[state(a + sign * step * e) for sign in (-1.0, 1.0)] for e in np.eye(6)[rows]]
    changes = np.array([(high.errors[0] - low.errors[0])[0] for low, high in ends]).T / (2.0 * step)
    found = some.solved(at.fields, closed, changes[None], False)[0][rows]
    assert_allclose(found, np.eye(4), atol=1e-7)
    loads = [(high.load - low.load)[0] / (2.0 * step) for low, high in ends]
    assert_allclose(at.fields.rise[0, rows], loads, atol=1e-7 * np.abs(loads).max())


@pytest.mark.parametrize("cap", CAPS, ids=repr)
def test_the_area_is_the_derivative_of_the_energy(cap):
    """With dU = P dx - A dw, a change of w changes P at fixed x by -dA/dx."""
    surface, w, x, step = scene(height=0.1 + np.array([0, 1, 0, 2, 1, 0]) * 1e-3), 9e-5, 0.06, 1e-3

    def state(energy, approach):
        model = mf.Interacting(1, contact=mf.JKR(energy, cap))
        return model.curve(surface, approach=np.array([approach]))

    area = [state(w, x * (1.0 + sign * 0.1 * step)).area[0] for sign in (-1.0, 1.0)]
    load = [state(w * (1.0 + sign * step), x).load[0] for sign in (-1.0, 1.0)]
    modulus = surface.material.composite_modulus
    by_approach, by_energy = (
        np.diff(area)[0] / (0.2 * step * x),
        modulus * np.diff(load)[0] / (2.0 * step * w),
    )
    assert by_energy == pytest.approx(-by_approach, rel=1e-8)


def test_contacts_among_many_stiff_ones_jump_one_by_one():
    """Beside stiff contacts the load is lowest just before one breaks; no such jump is missed."""
    height = np.append(np.full(20, 0.2), 0.15 - np.array([0.0, 0.001, 0.003, 0.004, 0.007]))
    surface = scene(1e6 * np.stack(np.divmod(np.arange(25), 5), axis=1), height, 0.526)
    load = np.linspace(0.0, 1.3, 400)
    for back in (False, True):
        law = mf.Independent(mf.JKR(ENERGY)).curve(surface, load, unloading=back)
        states = states_of(scene_of(surface), load, back)
        assert_allclose(law.area, states.area, rtol=1e-6)  # those of sites 1e6 mm apart
        assert np.unique(states.closed.sum(axis=1)).tolist() == [20, 21, 22, 23, 24, 25]


def test_two_contacts_that_break_together_are_followed():
    """Asperities 10 and 36 reach the ends of their branches together; near the ends, their order changes."""
    height = 0.1 + 0.003 * np.random.default_rng(12).random(64)
    found = []
    for lower in (0.0, 1e-5, -1e-5):
        height_of = height - np.where(np.arange(64) == 36, lower, 0.0)
        surface = mf.Surface.square_lattice(height_of, radius=0.526, material=mf.Material(1.36))
        found.append(states_of(scene_of(surface), np.array([2.2e-3, 0.07]), True)[np.array([0])])
    # heights that differ by 10 nm separate the two breaks; afterwards all states are the same
    for state in found:
        assert set(np.flatnonzero(~state.closed[0]).tolist()) == {10, 36}
        assert state.holds.all()
        assert state.stiffness > 0.0
        assert state.area == pytest.approx(found[0].area, rel=1e-11)


def test_states_are_stable():
    """The second variation of the potential by contact radii and approach is positive."""
    asperities = scene_of(uneven())
    for back in (False, True):
        states = states_of(asperities, np.linspace(0.0, 0.05, 9), back)
        assert (states.residual <= 1e-12).all()
        for row, closed in enumerate(states.closed):
            a, law = states.a[row, closed], asperities.law
            s = law.deficit(a)
            own = law.profile_slope(a, asperities.radius[closed]) - 0.5 * s / a
            # with the indentation d and the edge: P = 2 a (d - d_cap) + P_cap, dP = 2 a dd - 2 s da
            field = asperities.influence[np.ix_(closed, closed)]
            held = np.linalg.inv(np.eye(len(a)) + 2.0 * field * a)  # dd by a displacement, at given radii
            stiff = 2.0 * a[:, None] * held  # dP/dx of the contacts
            by_radii = held @ (2.0 * field * s)  # dd/da at a given approach
            push = -2.0 * np.diag(s) + 2.0 * a[:, None] * by_radii  # dP/da at a given approach
            whole = np.zeros((len(a) + 1, len(a) + 1))
            whole[:-1, :-1] = 2.0 * s[:, None] * (np.diag(own) - by_radii)
            whole[-1, :-1] = whole[:-1, -1] = push.sum(axis=0)
            whole[-1, -1] = stiff.sum()
            assert np.abs(whole - whole.T).max() <= 1e-12 * np.abs(whole).max()
            assert np.linalg.eigvalsh(whole).min() > 0.0


@pytest.mark.parametrize("first", [0, 10, 20])
def test_a_curve_and_its_sensitivity_agree(first):
    """Scenes in which some asperities are about to touch, for weak and strong adhesion."""
    for seed in range(first, first + 10):
        rng = np.random.default_rng(seed)
        energy, height = 9e-6 * 10.0 ** rng.random(), 0.1 + 0.03 * rng.random(16)
        surface = mf.Surface.square_lattice(height, (4, 4), radius=0.526, material=mf.Material(1.36))
        model, load = mf.Interacting(1, contact=mf.JKR(energy)), np.linspace(1e-3, 0.1, 4)
        assert_allclose(
            model.sensitivity(surface, load).curve.area, model.curve(surface, load).area, rtol=1e-11
        )
    # the state at a load does not depend on the loads before it
    assert_allclose(model.curve(surface, load[3:4]).area, model.curve(surface, load).area[3], rtol=1e-11)


def test_an_approach_is_kept_while_the_contacts_pull():
    """Just after the first contact, in tension, the plane is held where it was asked to be."""
    surface, approach = uneven(), np.array([1e-9, 1e-4, 3e-4])
    for back in (False, True):
        curve = mf.Interacting(1, contact=mf.JKR(ENERGY)).curve(surface, approach=approach, unloading=back)
        assert_allclose(curve.approach, approach, rtol=0.0, atol=0.0)
        assert curve.load[0] < 0.0 or back


@pytest.mark.parametrize("couples", [False, True])
def test_loads_far_below_adhesion(couples):
    """What is returned carries the load within the residual, at loads from nothing to the largest."""
    law = mf.JKR(5e-5)
    model = mf.Interacting(1, contact=law) if couples else mf.Independent(law)
    surface, bound = uneven(), law.for_material(mf.Material(1.36))
    for load in (0.0, 1e-60, 1e-12, 1e-8, 1e-3):
        state = mf.equilibrium(surface, model, load=load)
        law = mf.friction_law(surface, model, load=[load, 0.05])
        assert state.area == pytest.approx(law.area[0], rel=1e-9)
        a = np.sqrt(state.asperity_area / np.pi)
        lowered = 1.36 * (2.0 * a * bound.deficit(a)).sum()
        error = abs(state.asperity_load.sum() - load)
        assert error <= 1.001 * state.residual * (load + lowered) + 1e-15 * lowered
        assert state.residual <= 1e-12


@pytest.mark.parametrize("energy", [0.01, *np.linspace(0.02, 0.2, 10)])
def test_no_message_of_a_library_reaches_the_user(energy):
    surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
    law = mf.JKR(float(energy))
    for model in (mf.Independent(law), mf.Interacting(1, contact=law)):
        for back in (False, True):
            with contextlib.suppress(mf.MetafemError):
                found = mf.friction_law(surface, model, load=[0.01, 0.02], unloading=back)
                assert np.isfinite(found.area).all()
                assert np.isfinite(mf.equilibrium(surface, model, load=0.01).area)
