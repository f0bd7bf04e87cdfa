"""Interacting asperities against the printed 3 x 3 table and closed forms."""

import math
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.contact import pedestal_compliance
from metafem.models import Curve
from tests.models.scenes import MODELS, PLACE, lattice, scene


@dataclass(frozen=True)
class Raised:
    """The half-space as matrices, with terms that are added to them [1/mm]."""

    terms: object

    def for_surface(self, surface):
        return self

    def influence_matrix(self, surface):
        return mf.HalfSpace().influence_matrix(surface) + self.terms

    def influence_derivatives(self, surface):
        return mf.HalfSpace().influence_derivatives(surface)


def test_a_constant_in_every_entry_moves_the_separation_alone():
    plain, raised = (
        mf.equilibrium(scene(), mf.Interacting(order=1, substrate=s), load=0.1)
        for s in (mf.HalfSpace(), Raised(0.3))
    )
    assert_allclose(raised.asperity_load, plain.asperity_load, rtol=1e-11)
    assert plain.separation - raised.separation == pytest.approx(0.3 * 0.1 / 1.36, rel=1e-10)


def test_pedestals_are_self_terms_of_the_matrix():
    surface, load = scene(), np.array([0.01, 0.05, 0.1])
    own = np.diag(pedestal_compliance(surface.height, surface.radius) / np.pi)
    for order in (1, 3):
        first = mf.friction_law(surface, mf.Interacting(order, Raised(0.0), pedestal=True), load=load)
        second = mf.friction_law(surface, mf.Interacting(order, Raised(own)), load=load)
        assert_allclose(first.area, second.area, rtol=1e-12)
        assert_allclose(first.separation, second.separation, atol=1e-12)


def test_batch_agrees_with_single_laws():
    surface = lattice(0.1 * np.ones(16))
    heights = 0.1 - 0.08 * np.random.default_rng(0).random((5, 16))
    loads = np.array([0.01, 0.1, 0.3])
    for model in MODELS[2:]:
        area = model.areas(surface, loads, heights)
        law = mf.friction_law(surface.replaced(height=heights[3]), model, load=loads * 1.36)
        assert_allclose(area[3], law.area, rtol=1e-9)
        # to the last bit, however the lists are shared among threads
        assert (model.areas(surface, loads, heights[3:4])[0] == area[3]).all()


def test_an_ill_posed_scene_raises_with_its_state():
    """At order 1 the layer's self term wins over Hertz's compliance above a = 0.89 t."""
    surface = scene(PLACE[:1], [0.5], 1.0, thickness=0.3)
    with pytest.raises(mf.NotConverged) as caught:
        mf.equilibrium(surface, mf.Interacting(order=1, substrate=mf.BondedLayer()), load=0.035)
    assert caught.value.state.residual > 1e-12


def test_of_two_asperities_in_one_contact_the_taller_carries_all():
    """Point loads 0.05 mm apart: the sinking beside the taller one opens the other."""
    alone, point = scene([[0, 0]], [0.1], 0.5), mf.Interacting(order=1)
    for low, load in product((0.099, 0.08), (0.01, 0.1, 1.0)):
        surface = scene([[0, 0], [0.05, 0]], [0.1, low], 0.5)
        state = mf.equilibrium(surface, point, load=load)
        assert state.area == pytest.approx(mf.equilibrium(alone, load=load).area, rel=1e-12)
        law = mf.friction_law(surface, point, load=load * np.arange(1, 65) / 64)
        assert law.area[-1] == pytest.approx(state.area, rel=1e-12)


def test_open_asperities_have_their_gap_along_a_whole_curve():
    """Two open ones beside one contact: they touch where they are moved to by the slope of its field."""
    for order in (1, 3):
        R, r, load = 0.5, np.array([0.5, 3.0]), 0.005 * np.arange(1, 65) / 64
        surface, model = scene([[0, 0], [0.5, 0], [3.0, 0]], [0.1, 0.06, 0.0], R), mf.Interacting(order=order)
        found = model.sensitivity(surface, load)
        for k in (10, 63):
            p, state = load[k], mf.equilibrium(surface, model, load=load[k] * 1.36)
            u = p / (math.pi * r)
            if order == 3:
                square = (0.75 * p * R) ** (2 / 3)  # a^2
                u += p * square / (10 * math.pi * r**3) - R / 2 * (p / (math.pi * r**2)) ** 2
            gap = surface.height[1:] - state.separation - u
            assert_allclose(found.indentation[k][1:], gap, rtol=0, atol=1e-11)
            assert (gap < 0.0).all()


def test_an_influence_is_computed_once_for_all_heights_on_the_same_sites(monkeypatch):
    calls = []
    plain = mf.HalfSpace.influence_terms
    monkeypatch.setattr(mf.HalfSpace, "influence_terms", lambda *a: calls.append(1) or plain(*a))
    surface = mf.Surface.square_lattice(0.1, (3, 3), 1.234, radius=0.5, material=mf.Material(1.0))
    first = mf.equilibrium(surface, mf.Interacting(), load=0.1)
    again = mf.equilibrium(surface.perturbed(0.0), mf.Interacting(), load=0.1)
    assert (len(calls), again) == (1, first)
    mf.equilibrium(surface.replaced(position=1.001 * surface.position), mf.Interacting(), load=0.1)
    assert len(calls) == 2


def test_the_last_state_of_a_curve_is_held_to_the_tolerance_of_a_state():
    """1e-12 as documented, and 1e-10 for the loads before."""
    found = mf.Interacting().curve(lattice(np.full(4, 0.1)), np.array([0.01, 0.02, 0.03]))
    assert replace(found, residual=np.array([9e-11, 9e-11, 9e-13])).converged
    loose = replace(found, residual=np.array([9e-11, 0.0, 2e-12]))
    assert loose.solved.tolist() == [True, True, False]
    whole = Curve.joined([loose, loose.part(np.arange(2), loose.compute_last)])
    assert whole.solved.tolist() == [True, True, False, True, True]
