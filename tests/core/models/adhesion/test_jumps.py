"""Jumps of interacting adhesive asperities: each is located, and each state between them is stable."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.adhesion.scene import Scene
from metafem.models.interacting.adhesive import follow
from metafem.models.interacting.influence import coupling_between
from tests.models.scenes import lattice, said, scene

ENERGY = 9e-6
# Part of the largest load to which jumps are located.
LOCATED = 1e-6


def scene_of(height, substrate):
    surface = lattice(height)
    bound = substrate.for_surface(surface)
    coupling, regular = coupling_between(surface, bound, 1)
    law = mf.JKR(ENERGY).for_material(surface.material)
    return surface, Scene(law, surface.radius, surface.gap, coupling.influence, regular)


def check_jumps(scene, largest, unloading, rows):
    """Each jump's areas are those of the curve at loads just below and above it."""
    jumps = follow(scene, np.array([0.0, largest]), True, unloading, 1.0).jumps
    loads = np.array([jump.load for jump in jumps])
    assert len(jumps) > 5
    assert (np.diff(loads) * (-1.0 if unloading else 1.0) > 0.0).all()
    chosen = [jumps[row] for row in sorted(rows, key=lambda row: loads[row])]
    # along one path: what a path costs does not depend on the number of its loads
    near = np.array([jump.load + LOCATED * largest * np.array([-1.0, 1.0]) for jump in chosen])
    states = follow(scene, np.append(near, largest), True, unloading, 1.0).states
    for jump, low, high in zip(chosen, states[:-1:2], states[1::2], strict=True):
        before, after = (high, low) if unloading else (low, high)
        # away from the jump the area changes as the root of the load
        step = abs(jump.after - jump.before)
        assert before.area == pytest.approx(jump.before, abs=0.2 * step)
        assert after.area == pytest.approx(jump.after, abs=0.2 * step)


@pytest.mark.parametrize(("substrate", "unloading"), [(mf.HalfSpace(), False), (mf.BondedLayer(), True)])
def test_jumps_are_located(substrate, unloading):
    height = 0.15 - np.random.default_rng(1).uniform(0.0, 0.03, 9)
    check_jumps(scene_of(height, substrate)[1], 0.05, unloading, [1, 4])


def test_one_among_many_stiff_contacts_jumps():
    """Beside stiff contacts the load is lowest just before one breaks; no such jump is missed."""
    for unloading in (False, True):
        height = np.append(np.full(20, 0.2), 0.15 - np.array([0.0, 0.001, 0.003, 0.004, 0.007]))
        place = 1e6 * np.stack(np.divmod(np.arange(25), 5), axis=1)
        surface = scene(place, height, 0.526)
        model = mf.Independent(mf.JKR(ENERGY)).curve(surface, np.array([0.0, 1.3]), unloading=unloading)
        coupling, regular = coupling_between(surface, mf.HalfSpace(), 1)
        law = mf.JKR(ENERGY).for_material(surface.material)
        apart = Scene(law, surface.radius, surface.gap, coupling.influence, regular)
        jumps = follow(apart, np.array([0.0, 1.3]), True, unloading, 1.0).jumps
        assert said(model).startswith(f"{len(jumps)} jumps of A0")
        assert len(jumps) == 5 + (not unloading)


def test_two_contacts_that_break_together_are_followed():
    """Asperities 10 and 36 reach the ends of their branches together; near the ends, their order changes."""
    height = 0.1 + 0.003 * np.random.default_rng(12).random(64)
    found = []
    for lower in (0.0, 1e-5, -1e-5):
        height_of = height - np.where(np.arange(64) == 36, lower, 0.0)
        surface = mf.Surface.square_lattice(height_of, radius=0.526, material=mf.Material(1.36))
        coupling, regular = coupling_between(surface, mf.HalfSpace(), 1)
        law = mf.JKR(ENERGY).for_material(surface.material)
        asperities = Scene(law, surface.radius, surface.gap, coupling.influence, regular)
        found.append(follow(asperities, np.array([2.2e-3, 0.07]), True, True, 1.0))
    # heights that differ by 10 nm separate the two breaks; afterwards all states are the same
    assert [len(path.jumps) for path in found] == [1, 2, 2]
    for path in found:
        state = path.states[0]
        assert set(range(64)) - set(state.closed.tolist()) == {10, 36}
        assert state.stable
        assert state.area == pytest.approx(found[0].states[0].area, rel=1e-11)


def test_states_are_stable():
    """The second variation of the potential by contact radii and approach is positive."""
    for unloading in (False, True):
        height = 0.15 - np.random.default_rng(1).uniform(0.0, 0.03, 9)
        _, scene = scene_of(height, mf.HalfSpace())
        for state in follow(scene, np.linspace(0.0, 0.05, 9), True, unloading, 1.0).states:
            a, law = state.a, scene.law
            s = law.deficit(a)
            own = law.profile_slope(a, scene.radius[state.closed]) - 0.5 * s / a
            # with the indentation d and the edge: P = 2 a (d - d_cap) + P_cap, dP = 2 a dd - 2 s da
            field = state.contacts.influence
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
