"""The choice of the cheapest sufficient model on random scenes, and the sinking of the base."""

import numpy as np

import metafem as mf
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


def test_the_stiffness_is_the_slope_of_the_load_where_a_contact_is_shallow():
    surface = mf.Surface.square_lattice(
        [0.2, 0.2, 0.1 + 2e-5, 0.15], (2, 2), 10.0, radius=0.5, material=mf.Material(1.36), cap=mf.Power(4.0)
    )
    end = mf.Independent(mf.Elastic()).curve(surface, approach=np.array([0.1])).load[0]
    model = mf.Automatic(0.1, contact=mf.Elastic())
    curve = model.curve(surface, end * np.array([1.0 - 1e-6, 1.0, 1.0 + 1e-6]))
    assert "independent" in curve.notes[0].text
    slope = (curve.load[2] - curve.load[0]) / (curve.approach[2] - curve.approach[0])
    assert abs(curve.stiffness[1] / slope - 1.0) < 1e-5
