"""The base plane of a map is found between the caps, with the error that it has."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration.topography.cells import HeightMap, cells
from metafem.calibration.topography.levelled import levelled
from validation.scenes.height_maps import Roughness, height_map

SHAPE, PIXEL = (400, 400), 8e-3
DESIGN = mf.Surface.square_lattice([0.05, 0.12, 0.2, 0.27], (2, 2), radius=0.526, material=mf.Material(1.36))


def mapped(rng, **options):
    return HeightMap(height_map(DESIGN, SHAPE, PIXEL, rng=rng, **options), (PIXEL, PIXEL))


def test_tilt_and_bow_of_an_exact_map_are_found_from_below():
    exact = mapped(0, roughness=Roughness(0.0), noise=0.0, steepest=None)
    level = levelled(exact, cells(exact, 4), True)
    # cells that a foot crosses rise less than 4.5 s.d. only if the s.d. is not 0: single precision is left
    np.testing.assert_allclose(level.tilt, [2e-3, -1e-3], atol=1e-7)
    np.testing.assert_allclose(level.bow, [3e-4, 1e-4, -2e-4], atol=1e-7)
    np.testing.assert_allclose(level.base(level.centre[:1], level.centre[1:]), 0.0, atol=1e-7)
    assert 0.1 < level.excluded < 0.4


def test_a_plane_keeps_the_bow():
    exact = mapped(0, roughness=Roughness(0.0), noise=0.0, bow=(0.0, 0.0, 0.0), steepest=None)
    level = levelled(exact, cells(exact, 4), False)
    np.testing.assert_allclose(level.tilt, [2e-3, -1e-3], atol=1e-7)
    assert not level.bow.any()


def test_the_standard_error_of_the_base_plane_covers_its_error():
    """The cells with caps are known here, so that the fit is one of least squares."""
    scores = []
    for rng in range(40):
        rough = mapped(rng, roughness=Roughness(length=0.03), steepest=None)
        found = cells(rough, 4)
        x, y = np.meshgrid(found.x, found.y)
        caps = np.zeros(x.shape, dtype=bool)
        for cx, cy in DESIGN.position + 1.6:
            caps |= np.hypot(x - cx, y - cy) < 0.52
        level = levelled(rough, found, True, caps)
        at = np.array([0.8]), np.array([2.4])
        true = 2e-3 * -0.8 - 1e-3 * 0.8 + (3e-4 - 1e-4 - 2e-4) * 0.64
        scores.append(float((level.base(*at) - true)[0] / level.base_sd(*at)[0]))
    # 40 values of s.d. 1: their s.d. within three of its standard errors
    assert np.std(scores) == pytest.approx(1.0, abs=3.0 / np.sqrt(80))
    assert np.mean(scores) == pytest.approx(0.0, abs=3.0 / np.sqrt(40))


def test_bands_of_rows_give_the_same_cells(monkeypatch):
    rough = mapped(0)
    whole = cells(rough, 5)
    monkeypatch.setattr("metafem.calibration.topography.cells.AT_ONCE", 1)
    np.testing.assert_array_equal(cells(rough, 5).mean, whole.mean)


def test_windows_hold_the_pixels_around_a_point():
    flat = HeightMap(np.zeros((10, 20)), (0.5, 1.0), -1.0)
    rows, columns = flat.window(np.array([5.0, 2.0]), 1.0)
    np.testing.assert_allclose(flat.x(columns), [4.25, 4.75, 5.25, 5.75])
    np.testing.assert_allclose(flat.y(rows), [2.5, 1.5])
