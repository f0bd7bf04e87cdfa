"""What models leave out: estimated against resolved contacts, and said where it matters."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.error import truncation
from metafem.prediction.validity import base_contact_load
from tests.models.scenes import said, scene

CLOSE = [[0.0, 0.0], [0.1, 0.0]]
LAYER = mf.Interacting(substrate=mf.BondedLayer())


def rough(pitch=1.5, thickness=7.2, side=6, rng=0):
    height = 0.12 - np.minimum(np.random.default_rng(rng).exponential(0.04, side**2), 0.11)
    block = mf.Block(40.0, 40.0, thickness)
    return mf.Surface.square_lattice(
        height, (side, side), pitch, radius=0.526, material=mf.Material(1.36), block=block
    )


# Surface, load and a word of the warning.
WARNED = [
    (rough(thickness=0.2), 0.1, "elastic interaction of the asperities, which this model leaves out"),
    (rough(thickness=0.2), 0.1, "wide for their distances or their layer"),
    (rough(thickness=0.05), 0.1, "the layer of 0.05 mm is thinner"),
    (rough(pitch=0.3), 0.3, "pairs reach into each other at 0.3 N"),
    (rough(pitch=0.2), 1.0, "order 3 has no solution at"),
    (rough(), 3.0, "the base plane would touch from a load of"),
    (rough().replaced(height=np.full(36, 0.5)), 11.0, "a/R = 0.85 at 11 N"),
    (rough().replaced(height=np.full(36, 0.54)), 0.1, "36 of 36 summits stand higher than their radius"),
    (rough(pitch=9.0), 0.1, "20 of 36 summits stand outside the block of 40 by 40 mm"),
    (
        mf.Surface(CLOSE, [0.1, 0.15], 0.526, mf.Material(1.36)),
        0.001,
        "the caps of 1 pair of summits overlap",
    ),
]


def warnings(result):
    return "\n".join(note.text for note in result.notes if note.warns)


def test_what_is_left_out_is_warned_of():
    for surface, load, words in WARNED:
        assert words in warnings(mf.friction_law(surface, load=np.linspace(0.1, 1.0, 20) * load))
        assert words in warnings(mf.equilibrium(surface, load=load))


def test_a_sound_scene_is_not_warned_of():
    for model in (mf.Independent(), mf.Interacting(order=1), mf.Interacting(), LAYER):
        law = mf.friction_law(rough(), model, load=np.linspace(0.01, 0.3, 20))
        assert not warnings(law), said(law)


def test_the_cause_is_named_by_the_model():
    """The others are in `WARNED`."""
    for order in (1, 3):
        law = mf.friction_law(rough(0.45, 0.5), mf.Interacting(order=order), load=[0.1, 0.3])
        assert "thickness of the block, which a half-space leaves out" in said(law)


def test_the_error_of_order_3_on_a_thin_layer():
    """Against a contact that is resolved by 120 cells per radius, and not more than three times as large."""
    for ratio, poisson_ratio in ((0.28, 0.5), (0.5, 0.3)):
        surface = scene([[0.0, 0.0]], [0.4], 0.526, thickness=0.2, poisson_ratio=poisson_ratio)
        load = mf.equilibrium(surface, approach=(0.2 * ratio) ** 2 / 0.526).load
        third = mf.equilibrium(surface, LAYER, load=load)
        exact = mf.equilibrium(surface, mf.BoundaryElements(0.2 * ratio / 120, mf.BondedLayer()), load=load)
        error = abs(third.area / exact.area - 1.0)
        assert error < truncation(surface, third.asperity_area, mf.BondedLayer()) < 3.0 * error


def test_both_paths_agree_on_base_contact():
    """A thin block with its layer at 3.5 N."""
    surface, load = rough(thickness=1.0), 3.5
    state = mf.equilibrium(surface, LAYER, load=load)
    law = mf.friction_law(surface, LAYER, load=[load])
    assert ("base plane" in said(state)) == ("base plane" in said(law)) == (state.base_gap <= 0.0)
    onset = 1.36 * base_contact_load(surface, LAYER)
    assert (onset < load) == (state.base_gap <= 0.0)


def test_the_base_sinks_with_the_summits():
    """Beside a contact h - d is left."""
    surface, load = rough(), 0.3
    alone, full = (
        mf.equilibrium(surface, model, load=load) for model in (mf.Independent(), mf.Interacting())
    )
    assert alone.base_gap == alone.separation
    u = mf.HalfSpace().influence_matrix(surface) @ full.asperity_load / 1.36
    assert full.base_gap == pytest.approx(full.separation + u.min(), abs=1e-4)
    resolved = mf.equilibrium(rough(side=2), mf.BoundaryElements(0.008), load=0.02)
    third = mf.equilibrium(rough(side=2), mf.Interacting(), load=0.02)
    assert resolved.base_gap == pytest.approx(third.base_gap, abs=1e-4)


def test_notes_of_crowded_scenes_never_raise():
    """Two caps almost at one site, and a lattice whose base touches."""
    pair = mf.Surface(CLOSE, [0.10, 0.12], 0.526, mf.Material(1.36))
    crowd = mf.Surface.square_lattice(0.12, (8, 8), 0.6, radius=0.526, material=mf.Material(1.36))
    assert warnings(mf.equilibrium(pair, load=0.2))
    assert "base plane would touch" in said(mf.equilibrium(crowd, load=20.0))


def test_interaction_is_estimated_with_the_law_of_the_model():
    surface, load = rough(pitch=0.9, thickness=0.8, side=3), np.array([0.1])
    for law in (mf.Elastic(mf.Power(4)), mf.JKR(2e-5), mf.KogutEtsion(0.5)):
        layer = mf.Interacting(law.largest_order, mf.BondedLayer(), law)
        found = mf.friction_law(surface, mf.Independent(law), load=load)
        change = mf.friction_law(surface, layer, load=load).area / found.area - 1.0
        assert f"by up to {100.0 * change[0]:+.2g} %, at 0.1 N (order {law.largest_order}" in said(found)


def test_adhesive_contacts_are_compared_on_their_own_path(monkeypatch):
    surface, law = rough(pitch=0.9, thickness=0.8, side=3), mf.JKR(2e-5)
    models = mf.Independent(law), mf.Interacting(1, substrate=mf.BondedLayer(), contact=law)
    alone, full = (mf.friction_law(surface, model, load=[0.02, 0.1], unloading=True) for model in models)
    change = full.area / alone.area - 1.0
    assert f"by up to {100.0 * change[np.abs(change).argmax()]:+.2g} %" in said(alone)
    # large scenes are compared without adhesion
    monkeypatch.setattr("metafem.models.error.MOST_ADHESIVE", 1)
    alone, bare = (mf.friction_law(surface, mf.Independent(c), load=[0.1]) for c in (law, mf.Hertz()))
    assert next(note for note in bare.notes if "interaction" in note.text) in alone.notes
