"""Smallest changes of heights that bring a law into a band."""

import numpy as np

import metafem as mf
from validation.scenes.bands import scene


def equal(height, count=2):
    return mf.Surface.square_lattice(height, (1, count), radius=0.5, material=mf.Material(1.36))


def within(area, band):
    return bool(np.all((area >= band.lowest) & (area <= band.highest)))


def test_a_perturbed_surface_is_brought_into_the_band_of_the_known_one():
    for seed in range(2):
        known, made, band = scene(seed)
        found = mf.brought_into(made, band)
        assert within(mf.Independent().curve(found.surface, band.rescaled_load).area, band)
        np.testing.assert_allclose(found.surface.height, made.height + found.change, rtol=1e-12)
        # the known heights are a solution, so the smallest change is no larger
        assert np.linalg.norm(found.change) <= np.linalg.norm(known.height - made.height)


MODELS = (
    mf.Interacting(substrate=mf.BondedLayer()),
    mf.Independent(mf.JKR(9e-6)),
    mf.Independent(mf.Elastic()),
)


def test_bands_of_every_model_are_met():
    for model in MODELS:
        block = mf.Block(20.0, 20.0, 7.2)
        known, made, band = scene(1)
        known, made = known.replaced(block=block), made.replaced(block=block)
        area = model.curve(known, band.rescaled_load).area
        band = mf.Band(band.rescaled_load, 0.999 * area, 1.001 * area)
        assert not within(model.curve(made, band.rescaled_load).area, band)
        found = mf.brought_into(made, band, model)
        assert within(model.curve(found.surface, band.rescaled_load).area, band)


def test_a_law_inside_needs_no_change():
    known, _, band = scene(0)
    assert mf.brought_into(known, band).largest_change == 0.0


def test_the_change_of_two_asperities_is_that_of_the_closed_form():
    """A0 = pi R (d1 + d2) with P = 4/3 sqrt(R) (d1^1.5 + d2^1.5): the heights change by +-(d1 - d2)/2."""
    from scipy.optimize import brentq

    surface, load = equal([0.1, 0.09]), 0.02
    first = mf.Independent().curve(surface, np.array([load])).area[0]
    want = 0.99 * first  # larger differences of height have smaller areas
    band = mf.Band([load], [0.5 * want], [want])

    def depths(gap):
        def excess(d):
            return 4.0 / 3.0 * np.sqrt(0.5) * (d**1.5 + max(d - gap, 0.0) ** 1.5) - load

        d = brentq(excess, 1e-9, 1.0, xtol=1e-15)
        return d, max(d - gap, 0.0)

    gap = brentq(lambda g: np.pi * 0.5 * sum(depths(g)) - want, 0.01, 0.06)
    found = mf.brought_into(surface, band)
    # the aim is inside the band by 1e-4 of its width, here 5e-3 of the removed excess
    np.testing.assert_allclose(found.change, [0.5 * (gap - 0.01), -0.5 * (gap - 0.01)], rtol=1e-2)


def test_equal_heights_are_moved_apart():
    for only_lower in [False, True]:
        part = mf.Surface.square_lattice(0.1, (1, 2), radius=0.5, material=mf.Material(1.36))
        load, unequal = np.array([0.02]), part.replaced(height=[0.1, 0.08])
        wanted = mf.Independent().curve(unequal, load).area
        found = mf.brought_into(part, mf.Band(load, 0.99 * wanted, 1.01 * wanted), only_lower=only_lower)
        assert abs(found.area / wanted - 1.0).max() <= 0.01
        assert 0.0 < np.ptp(found.surface.height) <= 0.0201
