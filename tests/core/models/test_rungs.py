"""The choice of the cheapest sufficient model on random scenes, and the sinking of the base."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.error import FEWEST, PROBED, judged
from validation.scenes.ladder import Choice, choices


def test_the_sinking_of_the_base_is_in_the_approach():
    height = np.random.default_rng(1).uniform(0.1, 0.2, 64)
    surface = mf.Surface.square_lattice(height, pitch=50.0, radius=0.526, material=mf.Material(1.36))
    load = np.linspace(0.001, 0.05, 40)
    chosen, full = mf.Automatic(1e-3).curve(surface, load), mf.Interacting().curve(surface, load)
    alone = mf.Independent().curve(surface, load)
    assert "independent" in chosen.notes[0].text
    sinking = full.approach - alone.approach
    np.testing.assert_allclose(chosen.approach - alone.approach, sinking, rtol=0.05)
    np.testing.assert_allclose(chosen.stiffness, full.stiffness, rtol=0.01)


def test_at_given_approaches_the_base_sinks_too():
    surface = mf.Surface.square_lattice(0.2, (3, 3), pitch=50.0, radius=0.526, material=mf.Material(1.36))
    curve = mf.Automatic(1e-2).curve(surface, approach=np.array([0.02]))
    assert "order 3" in curve.notes[0].text
    assert curve.load == pytest.approx(mf.Interacting().curve(surface, approach=np.array([0.02])).load)


def test_many_loads_of_many_contacts_are_thinned_out():
    load = np.linspace(0.0, 1.0, 101)
    for count, equal in ((PROBED // 100, True), (PROBED // 16, True), (PROBED // 16, False)):
        height = np.full(count, 0.2) if equal else np.linspace(0.1, 0.2, count)
        surface = mf.Surface.square_lattice(height, (1, count), radius=0.526, material=mf.Material(1.36))
        curve = mf.Independent().curve(surface, load)
        rows = judged(surface, curve)
        assert rows[[0, -1]].tolist() == [1, 100]
        if count == PROBED // 100:
            assert len(rows) == 100
        elif equal:
            assert len(rows) == FEWEST
        else:
            closed = (curve.approach[rows, None] > surface.gap).sum(axis=1)
            every = (curve.approach[1:, None] > surface.gap).sum(axis=1)
            assert (closed[1:] <= 1.2 * closed[:-1] + np.diff(every).max()).all()


def test_the_choice_on_random_scenes():
    """Within the tolerance at every load, the cheapest model, by estimates within a factor of three."""
    found = Choice(*np.array(choices(6)).T)
    assert len(found.error) > 240
    assert (found.error <= found.tolerance).all()
    assert (found.along <= found.tolerance).all()
    assert (found.chosen == found.cheapest).mean() >= 0.9
    assert {*found.chosen.tolist()} == {0, 1}
    large = (found.error > 1e-4) & (found.chosen < 1)
    ratio = found.estimate[large] / found.error[large]
    assert large.sum() > 60
    assert 0.9 < ratio.min() < ratio.max() < 3.0
