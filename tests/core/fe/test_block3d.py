"""The true block against skfem's own hexahedra, the bonded layer, its symmetries, and itself refined."""

import math

import numpy as np
import pytest
import scipy.sparse as sp
import skfem
from hypothesis import given
from hypothesis import strategies as st
from skfem.helpers import ddot, div, sym_grad

import metafem as mf
from metafem import reference
from metafem.fe import Block3D
from metafem.fe import block3d as module
from metafem.fe.block3d import _solution
from metafem.fe.quarter import MOST_CELLS, Quarter, displacement, graded_line, quarter_lines, traction

BLOCK = mf.Block(20.0, 20.0, 7.2)

# Large cells: a second each, and 1e-4 /mm.
COARSE = {"cell": 0.7, "edge_cell": 0.05}

SITES = np.array([[0.75, 2.25], [-0.75, 2.25], [3.1, -0.4], [0.0, -2.0]])


def own_cache(tmp_path_factory):
    """A cache folder for the tests of a module, so that nothing is read that they did not compute."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("cache")
        patch.setattr(module, "cache_folder", lambda: folder)
        _solution.cache_clear()
        yield patch
    _solution.cache_clear()


cache = pytest.fixture(own_cache, scope="module", autouse=True)


def scene(position, block=BLOCK, poisson_ratio=0.5):
    return mf.Surface(
        position, np.full(len(position), 0.1), 0.526, mf.Material(1.36, poisson_ratio), block=block
    )


@given(
    st.tuples(*[st.floats(-3.0, 3.0)] * 2, st.floats(0.5, 3.0)),
    st.sampled_from([0.0, 0.3, 0.5]),
    st.sampled_from([0, 1, 2]),
)
def test_half_space_traction_is_that_of_its_displacement(place, poisson_ratio, normal):
    step = 1e-4
    gradient = np.empty((3, 3))
    for k in range(3):
        ahead, behind = (np.array(place) + sign * step * np.eye(3)[k] for sign in (1, -1))
        change = np.subtract(displacement(*ahead, poisson_ratio), displacement(*behind, poisson_ratio))
        gradient[:, k] = change / (2.0 * step)
    # mu = (1 - nu)/2 for E* = 1, and lambda div u = -nu z / (pi R^3) for any nu
    spherical = -poisson_ratio * place[2] / (math.pi * np.linalg.norm(place) ** 3)
    stress = 0.5 * (1.0 - poisson_ratio) * (gradient + gradient.T) + spherical * np.eye(3)
    found = np.array(traction(*map(np.array, place), normal, poisson_ratio))
    # what a central difference of this step costs
    np.testing.assert_allclose(found, stress[normal], atol=1e-6)


def test_matrix_is_that_of_scikit_fem_hexahedra():
    poisson_ratio = 0.3
    lines = np.array([[0.0, 1.0, 1.5], [0.0, 0.7, 2.0], [0.0, 0.4, 0.6]])
    quarter = Quarter(lines, poisson_ratio)
    mesh = skfem.MeshHex.init_tensor(*lines)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex2()), intorder=5)
    linear = basis.with_element(skfem.ElementHex1())
    mu = 0.5 * (1.0 - poisson_ratio)
    bulk_compliance = 1.5 * (1.0 - 2.0 * poisson_ratio) / (mu * (1.0 + poisson_ratio))

    def shear(u, v, _):
        return 2.0 * mu * (ddot(sym_grad(u), sym_grad(v)) - div(u) * div(v) / 3.0)

    stiffness = skfem.BilinearForm(shear).assemble(basis)
    pressure = skfem.BilinearForm(lambda u, q, _: -q * div(u)).assemble(basis, linear)
    mass = skfem.BilinearForm(lambda p, q, _: -bulk_compliance * p * q).assemble(linear)
    matrix = sp.block_array([[stiffness, pressure.T], [pressure, mass]], format="csr")

    dofs = basis.nodal_dofs, basis.edge_dofs, basis.facet_dofs, basis.interior_dofs
    theirs = [_by_place(np.concatenate([each[c] for each in dofs]), basis.doflocs) for c in range(3)]
    theirs.append(basis.N + _by_place(np.arange(linear.N), linear.doflocs))
    place = _tensor([axis.node for axis in quarter.axes])
    nodes = _by_place(np.arange(place.shape[1]), place)
    ours = [nodes + c * place.shape[1] for c in range(3)]
    place = _tensor(lines)
    ours.append(3 * len(nodes) + _by_place(np.arange(place.shape[1]), place))
    one, two = np.concatenate(ours), np.concatenate(theirs)
    assert abs(quarter.matrix[one][:, one] - matrix[two][:, two]).max() < 1e-13


def _tensor(lines):
    return np.stack(np.meshgrid(*lines, indexing="ij")).reshape(3, -1)


def _by_place(dofs, place):
    """Degrees of freedom sorted by x, then y, then z."""
    return dofs[np.lexsort(place[::-1, dofs].round(9))]


@given(st.floats(1.0, 60.0), st.floats(0.05, 1.0), st.floats(0.001, 0.05))
def test_lines_grow_from_the_edge(length, cell, edge_cell):
    line = graded_line(length, 5.0, cell, edge_cell)
    size = np.diff(line)[::-1]
    assert (line[0], line[-1]) == (0.0, length)
    rounding = 1.0 + 1e-9
    assert 0.0 < size[0] <= rounding * edge_cell
    assert (size[1:] <= rounding * math.e * size[:-1]).all()
    assert size[line[:0:-1] < 5.0].max(initial=0.0) <= rounding * cell


def test_thin_blocks_take_larger_cells():
    lines, stretch = quarter_lines(mf.Block(20.0, 20.0, 0.5), np.array([[8.0, 8.0]]), 0.25, 0.006)
    assert stretch > 1.0
    assert math.prod(len(each) - 1 for each in lines) <= MOST_CELLS


def solved(cache):
    return Block3D(**COARSE).solution(scene(SITES))


coarse = pytest.fixture(solved, scope="module")


def test_influence_is_reciprocal(coarse):
    assert coarse[1] < 1e-7
    np.testing.assert_array_equal(coarse[0][0], coarse[0][0].T)


def test_derivatives_are_those_of_the_influence(coarse):
    step = 0.05
    moved = SITES[1] + step * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
    found = Block3D(**COARSE).influence_matrix(scene(np.vstack([moved, SITES[2]])))[:5, 5]
    here, east, west, north, south = found
    # the truncation of these differences at a distance of 4.7, where G''' and G'''' are about 1e-2
    assert (east - west) / (2.0 * step) == pytest.approx(coarse[0][1][1, 2], abs=1e-5)
    assert (north - south) / (2.0 * step) == pytest.approx(coarse[0][2][1, 2], abs=1e-5)
    laplacian = (east + west + north + south - 4.0 * here) / step**2
    assert laplacian == pytest.approx(coarse[0][3][1, 2], abs=1e-5)


def test_block_lies_between_layer_and_half_space(coarse):
    r = math.dist(SITES[0], SITES[1])
    assert reference.layer_influence(r, 7.2, 0.5) < coarse[0][0][0, 1] < 1.0 / (math.pi * r)


def test_result_is_read_back(coarse, monkeypatch):
    substrate, surface = Block3D(**COARSE), scene(SITES)
    _solution.cache_clear()
    monkeypatch.setattr("metafem.fe.quarter.site_influence", None)
    for stored, computed in zip(substrate.solution(surface), coarse, strict=True):
        np.testing.assert_array_equal(stored, computed)


@pytest.fixture
def stored(coarse, tmp_path, monkeypatch):
    """The cache with a new folder and a stand-in for the computation."""
    calls = []
    monkeypatch.setattr(module, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr("metafem.fe.quarter.site_influence", lambda *_: calls.append(1) or coarse)

    def computed():
        _solution.cache_clear()
        Block3D(**COARSE).solution(scene(SITES))
        return len(calls)

    yield computed
    _solution.cache_clear()


def test_broken_file_is_computed_anew(stored, tmp_path):
    assert (stored(), stored()) == (1, 1)
    (path,) = tmp_path.iterdir()
    path.write_bytes(path.read_bytes()[:100])
    assert (stored(), stored()) == (2, 2)


def test_another_block_or_site_is_not_read(stored, tmp_path):
    stored()
    Block3D(**COARSE).solution(scene(SITES + 0.1))
    Block3D(**COARSE).solution(scene(SITES, poisson_ratio=0.49))
    assert len(list(tmp_path.iterdir())) == 3


def test_unwritable_folder_computes(stored, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setattr(module, "cache_folder", lambda: tmp_path / "file" / "metafem")
    assert (stored(), stored()) == (1, 2)


class _Useless:
    def solve(self, right):
        return np.zeros_like(right)


def test_failed_factorisation_raises(monkeypatch):
    monkeypatch.setattr("metafem.fe.elements.splu", lambda *_, **__: _Useless())
    with pytest.raises(mf.NotConverged, match="residual"):
        Block3D(cell=1.0, edge_cell=0.5).influence_matrix(scene(SITES[:1]))


def test_values_are_taken_from_the_surface():
    assert Block3D().for_surface(scene(SITES)) == Block3D(BLOCK, 0.5)
