"""The map without its base plane and its caps is flat."""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem.calibration.figures import made_figure, residuals
from metafem.calibration.topography.cells import HeightMap
from validation.scenes.height_maps import Roughness, height_map

DESIGN = mf.Surface.square_lattice([0.05, 0.12, 0.2], (1, 3), radius=0.526, material=mf.Material(1.36))
PIXEL = 0.01


def test_an_exact_map_leaves_nothing_above_the_feet():
    exact = height_map(DESIGN, (160, 460), PIXEL, roughness=Roughness(0.0), noise=0.0, steepest=None)
    exact[20:40, 20:40] += 5e-3
    made = mf.calibration.measured_surface(exact, PIXEL, DESIGN)
    shown = HeightMap(exact, (PIXEL, PIXEL))
    rest = residuals(shown, made)
    np.testing.assert_allclose(shown.extent, (4.6, 1.6))
    assert rest.shape == (80, 230)
    # caps and feet leave nothing: the spheres are subtracted at the pixels, not at the middles of cells
    assert np.abs(rest[25:]).max() < 1e-6
    np.testing.assert_allclose(rest[11:19, 11:19], 5e-3, atol=1e-6)
    np.testing.assert_allclose(residuals(HeightMap(-exact, (PIXEL, PIXEL), -1.0), made), rest)


def test_the_figure_has_four_pictures():
    rough = height_map(DESIGN, (160, 460), PIXEL)
    made = mf.calibration.measured_surface(rough, PIXEL, DESIGN)
    shown = HeightMap(rough, (PIXEL, PIXEL))
    law = mf.friction_law(DESIGN)
    correction = mf.calibration.corrected_heights(DESIGN, made)
    figure = made_figure(made, correction, shown, law, mf.friction_law(made.surface, load=law.load))
    titles = [ax.get_ylabel() for ax in figure.axes]
    assert titles[2:4] == ["height error [µm]", "rescaled friction  F/(σB) [mm²]"]
    assert made_figure(made, None, shown, law, law) is not None
