"""Materials, blocks and surfaces: what they refuse and how they change."""

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import metafem as mf

MATERIAL = mf.Material(1.36)


def pair(**changes):
    given = {"position": [[0, 0], [1, 0]], "height": [0.1, 0.2], "radius": 0.5, "material": MATERIAL}
    return mf.Surface(**(given | changes))


def test_arrays_are_copied_and_read_only():
    height = np.array([0.1, 0.2])
    surface = pair(height=height)
    height[0] = 5.0
    assert surface.height[0] == 0.1
    with pytest.raises(ValueError, match="read-only"):
        surface.height[0] = 1.0


def test_numbers_of_other_libraries_are_heights():
    for height in (
        xr.DataArray([0.1, 0.12], attrs={"units": "mm"}),
        pd.Series([0.1, 0.12], index=[7, 9]),
        np.ma.array([0.1, 0.12], mask=False),
        [Decimal("0.1"), Fraction(3, 25)],
        np.array([0.1, 0.12], dtype=object),
    ):
        np.testing.assert_allclose(pair(height=height).height, [0.1, 0.12], rtol=1e-15)


def test_lattice_is_centred_and_runs_along_x():
    lattice = mf.Surface.square_lattice([[1, 2, 3], [4, 5, 6]], (2, 3), 2.0, radius=1.0, material=MATERIAL)
    np.testing.assert_array_equal(lattice.position[:3], [[-2, -1], [0, -1], [2, -1]])
    np.testing.assert_array_equal(lattice.height, [1, 2, 3, 4, 5, 6])


def test_tilts_add_both_slopes_and_errors_are_the_draws_of_the_seed():
    tilted = pair(position=[[1.0, 2.0], [3.0, -1.0]]).tilted(0.01, -0.02)
    expected = np.array([1.0, 3.0]) * math.tan(0.01) + np.array([2.0, -1.0]) * math.tan(-0.02)
    np.testing.assert_allclose(tilted.height - [0.1, 0.2], expected, rtol=1e-12)
    found = pair().perturbed(0.003, rng=5).height
    drawn = np.random.default_rng(5).standard_normal(2)
    np.testing.assert_allclose(found, pair().height + 0.003 * drawn, rtol=1e-14)


def test_shuffling_keeps_each_height_with_its_radius():
    surface = mf.Surface.square_lattice(
        np.arange(9.0), (3, 3), radius=1.0 + np.arange(9.0), material=MATERIAL
    ).shuffled(rng=2)
    np.testing.assert_array_equal(surface.radius, surface.height + 1.0)
    assert not (surface.height == np.arange(9.0)).all()


def test_shuffling_does_not_undo_the_sites_of_a_design_of_the_same_seed():
    lattice = mf.Surface.square_lattice(0.0, (4, 4), radius=0.526, material=MATERIAL)
    target = mf.LinearLaw(9.0)
    for seed in (0, 1):
        design = mf.design(target, lattice, limits=mf.Limits(0.12, offset=0.05), rng=seed)
        height = design.surface.shuffled(seed).height
        assert (np.diff(height) > 0.0).any()
        assert (np.diff(height) < 0.0).any()


def test_a_material_of_a_youngs_modulus():
    ratio = 0.3
    material = mf.Material.from_young(1.02, ratio)
    assert material.young_modulus == pytest.approx(1.02, rel=1e-15)
    assert material.composite_modulus == pytest.approx(1.02 / (1.0 - ratio**2), rel=1e-15)
    assert material.poisson_ratio == ratio


def test_a_period_has_an_area_and_the_nearest_of_all_differences():
    cell = mf.PeriodicCell(2.0, 3.0)
    assert cell.area == 6.0
    x, y = cell.nearest(np.array([0.9, 1.1, -3.2]), np.array([1.4, 1.6, -6.5]))
    np.testing.assert_allclose([x, y], [[0.9, -0.9, 0.8], [1.4, -1.4, -0.5]], atol=1e-14)


def test_a_surface_prints_its_numbers():
    text = repr(pair(friction=mf.Friction(0.404, 0.85), block=mf.Block(20, 18, 7.2), cap=mf.Power(4)))
    for part in ("2 asperities", "0.1", "0.5 mm", "1.36 MPa", "0.404 MPa", "0.85", "18", "7.2", "Power"):
        assert part in text
