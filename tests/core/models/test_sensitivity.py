"""Sensitivities of A0 to heights against extrapolated differences."""

from itertools import pairwise

import numpy as np

import metafem as mf
from metafem.models.interacting import elastic as interacting
from tests.models.scenes import LAWS, said, with_law

MIXED = (
    mf.Power(4.0),
    mf.Sphere(),
    mf.Power(1.5, 0.3),
    mf.Paraboloid(),
    mf.Power(2.0),
    mf.Profile(lambda rho: rho**2 / 1.1 + rho**4, 0.6),
)
LOADS = np.array([0.005, 0.02, 0.06, 0.15])
OWN = mf.Elastic()
MODELS = [
    mf.Independent(OWN),
    mf.Interacting(1, contact=OWN),
    mf.Interacting(3, mf.BondedLayer(), OWN),
]


PEDESTALS = [mf.Interacting(order, mf.BondedLayer(), pedestal=True) for order in (1, 3)]


def scene(cap, count=9, pitch=1.5, **given):
    rng = np.random.default_rng(4)
    caps = [cap[i % len(cap)] for i in range(count)] if isinstance(cap, tuple) else cap
    side = round(count**0.5)
    height, radius = rng.uniform(0.08, 0.1, count), rng.uniform(0.3, 0.8, count)
    block = mf.Block(20.0, 20.0, 3.0)
    return mf.Surface.square_lattice(
        height, (side, side), pitch, radius=radius, material=mf.Material(1.36), block=block, cap=caps, **given
    )


def areas(surface, model, load):
    """The areas at loads, each solved alone to 1e-12; along a curve it would be 1e-10."""
    return np.array([model.curve(surface, np.array([one])).area[0] for one in load])


def difference(surface, model, i, load, step=2e-7):
    """The derivative by central differences of three steps, extrapolated to order 6."""
    slopes = []
    for change in (step, step / 2.0, step / 4.0):
        moved = change * (np.arange(surface.count) == i)
        up, down = (
            areas(surface.replaced(height=surface.height + sign * moved), model, load) for sign in (1.0, -1.0)
        )
        slopes.append((up - down) / (2.0 * change))
    first, second = ((4.0 * fine - coarse) / 3.0 for coarse, fine in pairwise(slopes))
    return (16.0 * second - first) / 15.0


def assert_derivatives(surface, model, load=LOADS, some=None, tolerance=1e-7):
    found = model.sensitivity(surface, load)
    np.testing.assert_allclose(found.curve.area, areas(surface, model, load), rtol=1e-9)
    scale = np.abs(found.gradient).max(axis=1)
    assert (scale > 0.0).all()
    for i in range(surface.count) if some is None else some:
        error = np.abs(found.gradient[:, i] - difference(surface, model, i, load))
        assert (error <= tolerance * scale).all(), (i, error / scale)


def test_mixed_caps_have_the_derivatives_of_their_law():
    for model in MODELS:
        assert_derivatives(scene(MIXED), model)


def test_every_model_has_the_derivatives_of_its_law():
    for cap in (mf.Power(4.0), mf.Power(1.5, 0.3), mf.Power(2.0), mf.Sphere()):
        for model in (MODELS[0], mf.Interacting(3, contact=OWN)):
            assert_derivatives(scene(cap), model, some=(0, 4))
    for name in ("kogut-etsion", "jackson-green"):
        for model in with_law(name):  # whose slopes bend at the ends of their cubics
            assert_derivatives(scene(mf.Sphere()), model, some=(4,), tolerance=1e-6)


def test_pedestals_change_with_the_height():
    assert_derivatives(scene(mf.Sphere()), PEDESTALS[1], some=(0, 4))


def test_adhesive_contacts_have_the_derivatives_of_their_law():
    jkr = LAWS["jkr"](1.0, 1.0)
    for model in (*with_law("jkr"), mf.Interacting(1, mf.BondedLayer(), jkr, pedestal=True)):
        assert_derivatives(scene(mf.Sphere()), model, some=(4,))


def test_a_periodic_cell_has_the_derivatives_of_its_law():
    surface = scene(MIXED, cell=mf.PeriodicCell(4.5, 4.5))
    assert_derivatives(surface, mf.Interacting(3, contact=OWN), some=range(0, 9, 2))


def test_fast_sums_have_the_derivatives_of_dense_matrices(monkeypatch):
    surface, model = scene(MIXED, 49), mf.Interacting(3, mf.BondedLayer(), OWN)
    dense = model.sensitivity(surface, LOADS[1:]).gradient
    monkeypatch.setattr(interacting, "LATTICE_LIMIT", 10)
    monkeypatch.setattr(interacting, "DENSE_LIMIT", 10)
    found = model.sensitivity(surface, LOADS[1:])
    assert "fast sums" in said(found.curve.last) or "lattice" in said(found.curve.last)
    np.testing.assert_allclose(found.gradient, dense, rtol=0.0, atol=1e-7 * np.abs(dense).max())


def test_raising_all_heights_changes_nothing():
    surface = mf.Surface.square_lattice(
        np.random.default_rng(0).exponential(0.03, 36), (6, 6), radius=0.526, material=mf.Material(1.0)
    )
    for model in (mf.Independent(), mf.Interacting(order=1), mf.Interacting(order=3)):
        gradient = model.sensitivity(surface, np.array([0.01, 0.1])).gradient
        np.testing.assert_allclose(gradient.sum(axis=1), 0.0, atol=1e-12 * np.abs(gradient).max())


def test_heights_can_stand_in_place_of_those_of_the_surface():
    for model in (mf.Independent(), mf.Interacting(), *PEDESTALS):
        load, surface = np.array([0.02, 0.08]), scene(mf.Sphere())
        given = model.sensitivity(surface.replaced(height=np.full(9, 0.1)), load, surface.height)
        own = model.sensitivity(surface, load)
        np.testing.assert_array_equal(given.curve.area, own.curve.area)
        np.testing.assert_array_equal(given.gradient, own.gradient)
        np.testing.assert_array_equal(given.indentation, own.indentation)
