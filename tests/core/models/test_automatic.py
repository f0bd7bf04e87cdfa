"""The choice between order 3 and resolved contacts."""

import numpy as np
import pytest

import metafem as mf
from metafem.models import automatic as automatic_module
from metafem.models import error as error_module
from metafem.models.error import truncation
from metafem.models.interacting import influence
from tests.models.scenes import lattice, said

HEIGHTS = 0.12 - np.minimum(np.random.default_rng(0).exponential(0.035, 36), 0.12)

# Errors of A0 at fixed load of order 3 against resolved contacts on a 3 x 3 lattice, and the approaches at
# which they were found [mm].
RESOLVED = [(0.1, 0.00001), (0.2, 0.0001), (0.3, 0.00027), (0.45, 0.00066)]


def test_estimates_bound_the_errors_against_resolved_contacts():
    surface = lattice(0.5 * np.ones(9))
    for approach, error in RESOLVED:
        last = mf.Interacting().curve(surface, approach=np.array([approach])).last
        assert error < truncation(surface, last.area, mf.HalfSpace()) < 2e-3


# The same for other caps, at a largest contact radius of 0.2 and 0.27 of the pitch; see the benchmark "caps".
# The last column is the largest ratio of the estimate to the error.
OTHER_CAPS = [
    (mf.Elastic(mf.Power(4)), 0.526, 0.2, 0.000117, 1.5),
    (mf.Elastic(mf.Power(4)), 0.526, 0.35, 0.001947, 1.5),
    (mf.Elastic(mf.Sphere()), 0.81, 0.27, 0.000458, 1.8),
]


def test_estimates_of_other_caps_bound_their_errors():
    for law, radius, ratio, error, most in OTHER_CAPS:
        surface, a = lattice(0.5 * np.ones(9), radius), 1.5 * ratio
        depth = float(law.indentation(a, radius))
        approach = 1.5 * depth  # about that of the approach with this radius
        for _ in range(20):
            last = mf.Interacting(contact=law).curve(surface, approach=np.array([approach])).last
            approach *= depth / float(law.indentation(np.sqrt(last.area.max() / np.pi), radius))
        assert np.sqrt(last.area.max() / np.pi) == pytest.approx(a, rel=1e-3)
        assert error < truncation(surface, last.area, mf.HalfSpace(), law) < most * error


def of_all_sites(monkeypatch):
    """Let sums over neighbours include all sites."""
    monkeypatch.setattr(influence, "cached", lambda function, *given: function(*given[:3]))
    monkeypatch.setattr(influence, "NEIGHBOURS", 10_000)


def test_pairs_of_many_contacts_are_those_of_their_nearest_neighbours(monkeypatch):
    height = 0.12 - np.minimum(np.random.default_rng(0).exponential(0.035, 324), 0.12)
    surface = lattice(height)
    area = mf.Interacting().curve(surface, np.array([2.0])).last.area
    near = np.full(324, np.pi * 0.76**2)  # at a pitch of 1.5 mm
    nearest = truncation(surface, area, mf.HalfSpace())
    of_all_sites(monkeypatch)
    assert truncation(surface, area, mf.HalfSpace()) == pytest.approx(nearest, rel=0.02)
    assert truncation(surface, near, mf.HalfSpace()) == np.inf


def test_errors_of_many_loads_are_those_of_each():
    surface, load = lattice(HEIGHTS), np.linspace(0.1, 2.0, 7)
    for law in (mf.Hertz(), mf.Elastic(mf.Power(4))):
        model = mf.Interacting(contact=law)
        _, errors = error_module.coupled(surface, model, load)
        for newtons, error in zip(load, errors, strict=True):
            area = model.curve(surface, np.array([newtons])).last.area
            assert truncation(surface, area, mf.HalfSpace(), law) == pytest.approx(error, rel=0.3)


def test_order_3_is_chosen_within_the_tolerance():
    for substrate in (mf.HalfSpace(), mf.BondedLayer()):
        surface, automatic = lattice(0.1 * np.ones(9)), mf.Automatic(2e-4, substrate)
        state = mf.equilibrium(surface, automatic, load=0.15)
        assert state.model == mf.Interacting(substrate=substrate)
        assert state.area == mf.equilibrium(surface, state.model, load=0.15).area
        assert state.notes[0].text.startswith("chosen: order 3; its estimated error of A0(P) is ")
        law = mf.friction_law(surface, automatic, load=[0.15])
        assert law.notes[0] == state.notes[0]


def test_what_order_3_does_not_hold_is_resolved():
    surface, automatic = lattice(0.5 * np.ones(4)), mf.Automatic(3e-3)
    state = mf.equilibrium(surface, automatic, load=4.0)
    assert isinstance(state.model, mf.BoundaryElements)
    assert "the estimated error of A0(P) by order 3 is" in state.notes[0].text
    law = mf.friction_law(surface, automatic, load=[0.01, 4.0])
    assert law.area[0] == pytest.approx(mf.equilibrium(surface, automatic, load=0.01).area, rel=1e-10)
    assert law.area[1] == pytest.approx(state.area, rel=1e-6)
    assert [note.text.split(":")[0] for note in law.notes if "chosen" in note.text] == [
        "chosen at 1 of 2 loads, 0.01 N",
        "chosen at 1 of 2 loads, 4 N",
    ]
    apart = mf.friction_law(surface, automatic, separation=law.separation)
    np.testing.assert_allclose(apart.area, law.area, rtol=automatic.tolerance)


def test_other_caps_are_resolved_where_order_3_does_not_hold():
    law = mf.Elastic(mf.Power(4))
    chosen_at = ((0.05, 2e-3, mf.Independent), (0.3, 2e-3, mf.Interacting), (2.0, 1e-3, mf.BoundaryElements))
    for load, tolerance, chosen in chosen_at:
        state = mf.equilibrium(lattice(0.5 * np.ones(4)), mf.Automatic(tolerance, contact=law), load=load)
        assert isinstance(state.model, chosen)
        assert state.model.contact == law
        assert state.notes[0].text.startswith("chosen: ")


def test_laws_that_cannot_be_resolved_stay_with_asperities_and_say_so():
    surface, jkr, plastic = lattice(0.1 * np.ones(9)), mf.JKR(9e-6), mf.KogutEtsion(1.0)
    for law in (jkr, plastic):
        state = mf.equilibrium(surface, mf.Automatic(contact=law), load=0.1)
        assert state.model == mf.Interacting(1, contact=law)
        assert "cannot be resolved: the tolerance is not checked" in state.notes[0].text
        assert state.notes[0].warns
    cell = surface.replaced(cell=mf.PeriodicCell(4.5, 4.5))
    state = mf.equilibrium(cell, mf.Automatic(1e-9), load=0.1)
    assert state.model == mf.Interacting()
    assert "a periodic cell is not resolved" in state.notes[0].text


# Two contacts that merge, and three of which order 3 has no solution; areas extrapolated from three cells.
MERGED = [
    ([[0, 0], [0.1, 0]], 0.0169981, 0.12596),
    ([[0, 0], [0.05, 0], [0, 0.05]], 0.02, 0.13837),
]


@pytest.mark.parametrize(("place", "load", "area"), MERGED)
def test_merged_contacts_are_within_the_tolerance(place, load, area):
    surface = mf.Surface(place, np.full(len(place), 0.1), 0.526, mf.Material(1.0))
    state = mf.equilibrium(surface, mf.Automatic(3e-3), load=load)
    assert "order 3 has no solution" in state.notes[0].text
    assert state.model_error <= 3e-3
    assert state.area == pytest.approx(area, rel=1e-3)


def test_the_reasons_are_said(monkeypatch):
    surface = mf.Surface([[0, 0], [0.3, 0]], [0.1, 0.1], 0.526, mf.Material(1.0))
    assert "contacts overlap" in said(mf.equilibrium(surface, mf.Automatic(1e-2), load=0.06))
    monkeypatch.setattr(automatic_module, "DENSE_LIMIT", 1)
    state = mf.equilibrium(lattice(0.5 * np.ones(9)), mf.Automatic(1e-6), load=1.0)
    assert "resolved contacts are needed" in state.notes[0].text


def test_a_state_that_is_no_minimum_of_the_energy_is_not_converged():
    for load in (0.01, 0.05):
        surface = mf.Surface([[0, 0], [0.05, 0]], [0.1, 0.1], 0.526, mf.Material(1.0))
        assert not mf.Interacting().curve(surface, np.array([load])).converged
        assert not mf.Interacting().curve(surface, approach=np.array([load])).converged


def test_the_estimate_covers_a_small_contact_beside_a_large_one():
    for ratio in (0.3, 0.5, 0.7, 0.9):
        # Hertz's displacement outside of a contact, and the terms of it that order 3 includes
        r, R = 1.0, 1.0
        a = ratio * r
        exact = ((2 * a**2 - r**2) * np.arcsin(a / r) + a * np.sqrt(r**2 - a**2)) / (np.pi * R)
        known = r**2 * (4 / 3 * ratio**3 + 2 / 15 * ratio**5) / (np.pi * R)
        area = np.pi * np.array([a**2, (0.01 * a) ** 2])
        surface = mf.Surface([[0, 0], [r, 0]], [0.2, 0.1], R, mf.Material(1.0))
        changed = np.pi * R * (exact - known) / area.sum()
        assert changed < truncation(surface, area, mf.HalfSpace()) < 10 * changed


def test_merged_contacts_smaller_than_assumed_are_resolved_by_finer_cells():
    """Order 1, which sets the first cells, overestimates areas that merge."""
    height = 0.1 + 0.02 * np.random.default_rng(3).random(4)
    surface = mf.Surface.square_lattice(height, (2, 2), 0.2, radius=0.526, material=mf.Material(1.36))
    for load in (0.1, 0.2):
        state = mf.equilibrium(surface, mf.Automatic(0.1), load=load)
        assert state.model.title == "resolved"
        assert state.model_error <= 0.1


def test_the_choice_is_made_at_each_load_of_a_curve():
    """Four crowded summits carry the first loads; later their share of the area is small."""
    few = 0.225 * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    many = 10.0 + 3.0 * np.stack(np.meshgrid(np.arange(14), np.arange(14)), axis=-1).reshape(-1, 2)
    height = np.concatenate([np.full(4, 0.2), np.full(196, 0.15)])
    surface = mf.Surface(np.concatenate([few, many]), height, 0.526, mf.Material(1.0))
    load = [0.004, 0.0253, 1.07]
    third = mf.friction_law(surface, mf.Interacting(), load=load)
    assert third.model_error > 1.2e-3
    automatic = mf.Automatic(1e-3)
    law = mf.friction_law(surface, automatic, load=load)
    states = [mf.equilibrium(surface, automatic, load=each) for each in load]
    assert [state.model.title if hasattr(state.model, "title") else "" for state in states] == [
        "", "resolved", "",
    ]  # fmt: skip
    np.testing.assert_allclose(law.area, [state.area for state in states], rtol=1e-9)
    assert law.model_error == max(state.model_error for state in states) <= 1e-3
    assert "at 1 of 3 loads, 0.0253 N: resolved contacts" in said(law)
    assert "at 2 of 3 loads, 0.004 to 1.07 N: order 3" in said(law)
