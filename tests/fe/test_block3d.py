"""The true block against skfem's own hexahedra, the bonded layer, its symmetries, and itself refined."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem import reference
from metafem._caches import cache_folder
from metafem.fe import Block3D
from metafem.fe import block3d as module
from metafem.fe.quarter import Quarter, graded_line
from tests.core.fe.test_block3d import BLOCK, COARSE, SITES, own_cache, scene, solved

COARSE_ERROR = 1e-4


cache = pytest.fixture(own_cache, scope="module", autouse=True)
coarse = pytest.fixture(solved, scope="module")


def test_values_of_the_elements_converge_to_those_by_betti():
    source = np.array([[0.75, 2.25], [3.0, 0.5]])
    difference = []
    for cell in (0.6, 0.3):
        lines = [graded_line(length, length, 7.2 * cell, 0.1) for length in (10.0, 10.0, 7.2)]
        quarter = Quarter(lines, 0.5)
        field = quarter.solve((1, -1), source)
        x, y = (axis.basis.probes(source[:, k][None]).toarray() for k, axis in enumerate(quarter.axes[:2]))
        normal = field[2].reshape(3, *(axis.node.size for axis in quarter.axes), -1)
        top = int(np.argmin(quarter.axes[2].node))
        inside = np.einsum("nx,ny,xym->nm", x, y, normal[2, :, :, top])
        difference.append(np.abs(inside - quarter.influence(field, source)).max())
    # quadratic elements: third order at a point, 2**3 = 8 in theory, 4 where the meshes do not nest
    assert difference[1] < difference[0] / 4.0
    assert difference[1] < 2e-4


def test_block_of_unequal_sides_turns_with_its_sites():
    long, wide = mf.Block(14.0, 9.0, 4.0), mf.Block(9.0, 14.0, 4.0)
    found = Block3D(**COARSE).solution(scene(SITES, long, 0.3))
    turned = Block3D(**COARSE).solution(scene(SITES[:, ::-1], wide, 0.3))
    np.testing.assert_allclose(turned[0][0], found[0][0], atol=1e-11)
    np.testing.assert_allclose(turned[0][2], found[0][1], atol=1e-11)
    np.testing.assert_allclose(turned[0][3], found[0][3], atol=1e-9)


def test_lengths_scale(coarse):
    twice = Block3D(**COARSE).solution(scene(2.0 * SITES, mf.Block(40.0, 40.0, 14.4)))
    np.testing.assert_allclose(2.0 * twice[0][0], coarse[0][0], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(4.0 * twice[0][1], coarse[0][1], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(8.0 * twice[0][3], coarse[0][3], rtol=1e-7, atol=1e-12)


def test_loads_beside_a_side_warn():
    with pytest.warns(mf.errors.MetafemWarning, match="smaller cells"):
        Block3D(**COARSE).influence_matrix(scene(np.array([[9.9, 0.0], [9.0, 0.0]])))


def test_wide_block_is_the_layer():
    position, poisson_ratio = np.array([[0.5, 0.0], [-1.0, 0.0]]), 0.49
    surface = scene(position, mf.Block(60.0, 60.0, 5.0), poisson_ratio)
    found = Block3D(cell=0.5, edge_cell=0.1).influence_matrix(surface)
    place = 5.0, poisson_ratio
    expected = [reference.layer_regular(0.0, *place), reference.layer_influence(1.5, *place)]
    np.testing.assert_allclose([found[0, 0], found[0, 1]], expected, atol=COARSE_ERROR)


def test_error_estimate_bounds_the_error(coarse):
    refined = Block3D(cell=0.45, edge_cell=0.02).influence_matrix(scene(SITES))
    error = np.abs(refined - coarse[0][0]).max()
    assert error < coarse[2] < 1000.0 * error


@pytest.fixture(scope="module")
def paper(cache):
    """The influence on the paper's block, which claims of the validation read from the same folder."""
    lattice = mf.Surface.square_lattice(0.1, radius=0.526, material=mf.Material(1.36, 0.5), block=BLOCK)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "cache_folder", cache_folder)
        return Block3D().solution(lattice)


@pytest.mark.nightly
def test_lattice_on_the_paper_s_block(paper):
    r = math.pi * 1.5
    rows = paper[0][0].reshape(8, 8, 8, 8)
    # over the half-space, by two other codes: one pitch at the centre and at the corner, four pitches
    assert rows[3, 3, 3, 4] * r == pytest.approx(0.66, abs=5e-3)
    assert rows[0, 0, 0, 1] * r == pytest.approx(0.74, abs=5e-3)
    assert [rows[i, 0, i, 4] * 4.0 * r for i in (3, 0)] == pytest.approx([0.04, 0.11], abs=5e-3)
    assert paper[1] < 1e-5
    assert paper[2] < 3e-5
