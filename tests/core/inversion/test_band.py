"""Bands: which law is chosen, which bands are refused, and what the misfit is."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus

LIMITS = mf.Limits(0.6)
LOAD = np.array([0.05, 0.1, 0.2])


def hertz(count: int, load=LOAD, radius=0.526):
    """Return A0 [mm^2] of equal asperities, ``N pi R (3p/(4 N sqrt R))^(2/3)``."""
    return count * np.pi * radius * (3.0 * load / (4.0 * count * np.sqrt(radius))) ** (2.0 / 3.0)


def template(count):
    return mf.Surface.square_lattice(
        np.full(count, 0.12), (1, count), radius=0.526, material=mf.Material(1.36)
    )


def test_equal_asperities_are_found_in_a_band_around_their_law():
    for count in [1, 4]:
        law = hertz(count)
        found = mf.design(mf.Band(LOAD, 0.99 * law, 1.01 * law), template(count), limits=LIMITS)
        assert found.misfit == 0.0
        assert found.status is DesignStatus.EXACT
        # the law is in the middle to the goal of the search, 6e-4 of the law, for a half-width of 1e-2
        assert found.parameters["band_margin"] > 0.9


def test_one_asperity_has_the_margin_of_the_closed_form():
    law = hertz(1)
    found = mf.design(mf.Band(LOAD, 0.97 * law, 1.01 * law), template(1), limits=LIMITS)
    assert found.parameters["band_margin"] == pytest.approx(0.5, abs=1e-9)
