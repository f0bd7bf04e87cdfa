"""Lattice sums of a periodic cell: other splittings, and sums over images."""

from functools import partial
from itertools import product

import numpy as np
import pytest

import metafem as mf
from metafem.substrate.periodic import image_sum, lattice_sum

CELLS = (mf.PeriodicCell(1.5, 1.5), mf.PeriodicCell(6.0, 2.0))
LAYERS = (mf.BondedLayer(1.0, 0.3), mf.BondedLayer(1.0, 0.5), mf.BondedLayer(7.2, 0.5))
# Sums of some thousand terms.
ROUNDING = 1e-12


def points(cell):
    """The source itself and four points, one of them in another period."""
    x, y = np.array([0.0, 0.1, -0.45, 0.5, 1.3]), np.array([0.0, 0.02, 0.3, 0.5, -0.2])
    return cell.width * x, cell.length * y


def test_does_not_depend_on_the_splitting():
    for substrate, cell in product((mf.HalfSpace(), *LAYERS[:2]), CELLS):
        x, y = points(cell)
        given = substrate.periodic(cell, x, y)
        other = lattice_sum(cell, x, y, substrate.transform, substrate.last_wavenumber, splitting=1.6)
        for part, same in zip(given, other, strict=True):
            assert part == pytest.approx(same, rel=ROUNDING, abs=ROUNDING * np.abs(part).max())


def test_half_space_has_no_mean_and_the_limit_of_a_thick_layer():
    cell = CELLS[1]
    x, y = points(cell)
    # for nu = 1/2 the thick layer has no mean either; its deficit at the smallest wavenumber is exp(-2 k t)
    thick = mf.BondedLayer(100.0, 0.5).periodic(cell, x, y)
    for part, same in zip(mf.HalfSpace().periodic(cell, x, y), thick, strict=True):
        assert part == pytest.approx(same, rel=ROUNDING, abs=ROUNDING)


def test_derivatives_are_those_of_the_value():
    cell, step = CELLS[1], 1e-4
    x, y = (part[1:] for part in points(cell))
    for substrate in (mf.HalfSpace(), LAYERS[0]):
        _, slope_x, slope_y, laplacian = substrate.periodic(cell, x, y)
        east, west, north, south, here = (
            substrate.periodic(cell, x + step * a, y + step * b)[0]
            for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1), (0, 0))
        )
        # the differences are of second order
        assert slope_x == pytest.approx((east - west) / (2.0 * step), rel=1e-5, abs=1e-6)
        assert slope_y == pytest.approx((north - south) / (2.0 * step), rel=1e-5, abs=1e-6)
        assert laplacian == pytest.approx(
            (east + west + north + south - 4.0 * here) / step**2, rel=1e-4, abs=1e-5
        )


def test_a_uniform_pressure_compresses_the_layer():
    layer = LAYERS[0]
    mean = layer.thickness * (1.0 - 0.6) / 0.7**2
    assert layer.transform(np.zeros(1)) == pytest.approx(mean, rel=ROUNDING)
    assert layer.transform(np.array([1e-5])) + 2e5 == pytest.approx(mean, rel=1e-4)
    assert mf.PeriodicCell(2.0, 2.0).area == 4.0


def test_matrices_are_symmetric_with_regular_terms():
    rng = np.random.default_rng(3)
    cell = mf.PeriodicCell(4.0, 3.0)
    surface = mf.Surface(
        rng.uniform(0.0, 3.0, (6, 2)), np.full(6, 0.1), 0.3, mf.Material(1.36, 0.3), cell=cell
    )
    for substrate in (mf.HalfSpace(), LAYERS[0]):
        value, x, y, laplacian = substrate.influence_terms(surface)
        assert (value == value.T).all()
        assert (laplacian == laplacian.T).all()
        assert (x == -x.T).all()
        assert (y == -y.T).all()
        own = substrate.periodic(cell, np.zeros(1), np.zeros(1))
        assert np.diagonal(value) == pytest.approx(own[0][0], rel=ROUNDING)
        assert (substrate.influence_matrix(surface) == value).all()


def test_a_thin_layer_in_a_large_cell_is_its_nearest_period():
    """Its waves would take gigabytes; the next period is 2,000 thicknesses away."""
    layer, cell = mf.BondedLayer(0.05, 0.5), mf.PeriodicCell(100.0, 100.0)
    x, y = np.array([0.0, 0.03, 0.0, 99.9]), np.array([0.0, 0.0, 0.2, 0.1])
    value, slope_x, slope_y, laplacian = layer.periodic(cell, x, y)
    r = np.array([0.03, 0.2, np.hypot(0.1, 0.1)])
    g, g1, g2 = layer.influence(r, derivatives=True)
    np.testing.assert_allclose(value, [layer.self_influence, *g], rtol=1e-12)
    np.testing.assert_allclose(slope_x, [0.0, g1[0], 0.0, -g1[2] / np.sqrt(2.0)], rtol=1e-12)
    np.testing.assert_allclose(slope_y, [0.0, 0.0, g1[1], g1[2] / np.sqrt(2.0)], rtol=1e-12)
    np.testing.assert_allclose(laplacian, [2.0 * layer.self_curvature, *(g2 + g1 / r)], rtol=1e-12)


def test_periods_and_waves_of_a_layer_have_one_sum():
    x, y = np.array([0.0, 1.0, 2.4, 3.1]), np.array([0.0, 0.3, 2.5, 0.0])
    for thickness in (0.5, 1.5):
        layer, cell = mf.BondedLayer(thickness, 0.4), mf.PeriodicCell(6.0, 5.0)
        own = layer.self_influence, 2.0 * layer.self_curvature
        given = partial(layer.influence, derivatives=True)
        direct = image_sum(cell, x, y, given, 48.0 * thickness, own)
        waves = lattice_sum(cell, x, y, layer.transform, layer.last_wavenumber)
        for one, other in zip(direct, waves, strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-11)
