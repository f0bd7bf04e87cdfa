"""Illumination that is removed, and the guesses that serve large gradients and large contacts."""

import numpy as np
import pytest

from metafem.calibration.images.illumination import without_illumination
from validation.scenes.pictures import illumination, lattice, picture

SHAPE = (240, 300)


def ground(centre, radius, **changes):
    image = picture(SHAPE, centre, radius, **{"noise": 0.02, **changes})
    return without_illumination(image.astype(np.float32), False)


@pytest.mark.parametrize("gradient", [(0.4, -0.3), (-0.8, 0.5)])
def test_gradient_and_vignetting_are_removed(gradient):
    _, centre = lattice(4, 14.0, np.random.default_rng(0))
    found = ground(centre, np.full(16, 14.0), gradient=gradient, vignetting=0.2, noise=0.0)
    level = 0.7 * illumination(SHAPE, gradient, 0.2)
    bare = picture(SHAPE, centre, np.full(16, 14.0)) / 0.7
    assert found.corrected == pytest.approx(bare, abs=2e-3)
    assert found.level == pytest.approx(level.mean(), rel=0.01)
    assert found.divided


@pytest.mark.parametrize("radius", [80.0, 110.0])
def test_a_contact_may_cover_half_of_the_frame(radius):
    found = ground([(150.0, 120.0)], [radius], gradient=(0.3, 0.2))
    assert np.median(found.corrected[:5]) == pytest.approx(1.0, abs=0.01)
    assert np.median(found.corrected[110:130, 140:160]) == pytest.approx(2.0 / 7.0, abs=0.01)


def test_structure_is_what_the_polynomial_leaves():
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    _, centre = lattice(3, 14.0, np.random.default_rng(0))
    image = picture(SHAPE, centre, np.full(9, 14.0), noise=0.02)
    assert without_illumination(image.astype(np.float32), False).structure < 1e-3
    waves = image * (1.0 + 0.02 * np.sin(x / 12.0) * np.sin(y / 12.0))
    # the standard deviation of a product of sines is half of its amplitude
    assert without_illumination(waves.astype(np.float32), False).structure == pytest.approx(0.01, rel=0.15)


def test_a_dark_field_is_subtracted():
    _, centre = lattice(3, 14.0, np.random.default_rng(0))
    image = picture(SHAPE, centre, np.full(9, 14.0), levels=(0.8, 0.01), noise=0.01)
    found = without_illumination(image.astype(np.float32), True)
    assert not found.divided
    # the lattice lies in the lower left corner
    assert np.median(found.corrected[:40]) == pytest.approx(1.0, abs=1e-3)
