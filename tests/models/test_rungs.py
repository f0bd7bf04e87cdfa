"""The choice of the cheapest sufficient model: its estimates, on random scenes."""

from functools import cache

import numpy as np
import pytest

import metafem as mf
from metafem.models.rungs import FEWEST, PROBED, probed
from metafem.models.truncation import truncation

LAWS = (mf.Hertz(), mf.SphericalCap(), mf.PowerCap(3.0), mf.PowerCap(4.0))
SCENES = 150
TITLES = ("independent asperities", "order 1", "order 3")


def random_scene(rng):
    """Return a surface of 2 to 40 asperities, 0.2 to 100 mm apart, a law, a substrate, and 20 loads."""
    count, pitch = int(rng.integers(2, 40)), 10 ** rng.uniform(-0.1, 2.0)
    row, column = np.divmod(rng.permutation(7 * 7)[:count], 7)
    position = pitch * (np.column_stack([row, column]) + 0.3 * rng.uniform(-1.0, 1.0, (count, 2)))
    radius = 0.5 * (10 ** rng.uniform(-0.5, 0.5, count) if rng.random() < 0.5 else np.ones(count))
    spread = 10 ** rng.uniform(-3.0, -0.7)
    block = mf.Block(1000.0, 1000.0, 10 ** rng.uniform(0.3, 1.5))
    height = 0.3 + rng.uniform(0.0, spread, count)
    surface = mf.Surface(position, height, radius, mf.Material(1.36, 0.5), block=block)
    law = LAWS[int(rng.integers(len(LAWS)))]
    substrate = (mf.HalfSpace(), mf.BondedLayer())[int(rng.integers(2))]
    approach = 10 ** rng.uniform(-3.0, -1.5) * radius.min() + spread * rng.uniform(0.0, 1.0)
    end = mf.Independent(law).curve(surface, approach=np.array([approach])).load[0]
    return surface, law, substrate, np.linspace(end / 20, end, 20)


@cache
def choices():
    """Return tolerance, rung, sufficient rung, estimated and true error of each choice."""
    rng, found = np.random.default_rng(0), []
    for _ in range(SCENES):
        surface, law, substrate, load = random_scene(rng)
        models = (
            mf.Independent(law),
            mf.Interacting(1, substrate, law),
            mf.Interacting(3, substrate, law),
        )
        try:
            curves = [model.curve(surface, load).checked() for model in models]
        except mf.MetafemError:
            continue
        errors = [float(np.abs(curve.area / curves[2].area - 1.0).max()) for curve in curves]
        last = truncation(surface, curves[2].last.area, substrate, law)
        for tolerance in (1e-4, 1e-3, 1e-2):
            if last > 0.3 * tolerance:  # order 3 is no reference, and resolving contacts takes seconds
                continue
            curve = mf.Automatic(tolerance, substrate, law).curve(surface, load)
            words = curve.notes[0].text.removeprefix("chosen: ")
            rung = next(i for i, title in enumerate(TITLES) if words.startswith(title))
            best = next(i for i, error in enumerate(errors) if error <= tolerance)
            true = float(np.abs(curve.area / curves[2].area - 1.0).max())
            found.append((tolerance, rung, best, float(words.split()[-1]), true))
    return np.array(found).T


def test_the_chosen_model_is_within_the_tolerance():
    tolerance, _, _, _, true = choices()
    assert len(true) > SCENES
    assert (true <= tolerance).all()


def test_the_chosen_model_is_the_cheapest_or_the_next():
    _, rung, best, _, _ = choices()
    assert (rung - best <= 1).mean() >= 0.9
    assert (rung == best).mean() >= 0.9
    assert {*rung.tolist()} == {0, 1, 2}


def test_estimates_are_within_a_factor_of_three():
    _, rung, _, estimate, true = choices()
    large = (true > 1e-4) & (rung < 2)
    ratio = estimate[large] / true[large]
    assert large.sum() > SCENES / 4
    assert ((ratio > 1 / 3) & (ratio < 3)).mean() >= 0.98
    assert ratio.min() > 0.9


def test_the_sinking_of_the_base_is_in_the_approach():
    surface = mf.Surface.square_lattice(
        np.random.default_rng(1).uniform(0.1, 0.2, 64), (8, 8), pitch=50.0, radius=0.526,
        material=mf.Material(1.36),
    )  # fmt: skip
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
    assert "order 1" in curve.notes[0].text
    assert curve.load == pytest.approx(mf.Interacting().curve(surface, approach=np.array([0.02])).load)


def test_many_loads_of_many_contacts_are_thinned_out():
    load = np.linspace(0.0, 1.0, 101)
    assert probed(load, 64).tolist() == list(range(1, 101))
    rows = probed(load, PROBED)
    assert len(rows) == FEWEST
    assert rows[[0, -1]].tolist() == [1, 100]
