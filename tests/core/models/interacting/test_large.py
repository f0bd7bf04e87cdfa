"""Large scenes: fast sums and Newton-Krylov against the dense kernel."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.models.interacting import elastic as interacting
from metafem.models.interacting import newton_krylov
from metafem.models.interacting.scattered import ScatteredSums
from metafem.models.interacting.sums import Sums, coarse_grid, coarse_model, find_lattice
from tests.models.scenes import PEDESTAL, lattice, scene

SUBSTRATES = [mf.HalfSpace(), mf.BondedLayer(7.2, 0.5)]


def rough(count, seed=0):
    return 0.12 - np.minimum(np.random.default_rng(seed).exponential(0.035, count), 0.12)


@pytest.fixture
def large(monkeypatch):
    """Small scenes take the way of large ones."""
    for limit in ("LATTICE_LIMIT", "DENSE_LIMIT"):  # of order 3 on a lattice, and of all others
        monkeypatch.setattr(interacting, limit, 1)


def products(surface, substrate, sums):
    """Differences of every product from the dense matrices, over the largest value."""
    rng = np.random.default_rng(3)
    load, size = rng.random((2, surface.count))
    influence = substrate.influence_matrix(surface)
    np.fill_diagonal(influence, 0.0)
    gx, gy, laplacian = substrate.influence_derivatives(surface)
    pairs = [
        (sums.displacement(load), influence @ load),
        (sums.field(load)[0], laplacian @ load),
        (np.hypot(*sums.field(load)[1:]), np.hypot(gx @ load, gy @ load)),
        # sources with moments along their own slope: free of the choice of axes
        (
            sums.displacement(load, size, *(load * s for s in sums.field(load)[1:])),
            influence @ load + laplacian.T @ size + gx.T @ (load * (gx @ load)) + gy.T @ (load * (gy @ load)),
        ),
    ]
    return [float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs]


def test_lattice_products_are_exact():
    for substrate in SUBSTRATES:
        surface = lattice(rough(49))
        keep = np.random.default_rng(1).permutation(49)[:40]  # missing sites, any order
        surface = scene(surface.position[keep], surface.height[keep], 0.526)
        assert max(products(surface, substrate, Sums(find_lattice(surface.position), substrate))) < 1e-13


def loose(count, seed=0, **arguments):
    """Places anywhere, no nearer than half a millimetre."""
    shift = np.random.default_rng(seed).uniform(-0.5, 0.5, (count, 2))
    columns = round(np.sqrt(count))
    grid = 1.5 * np.column_stack([np.arange(count) % columns, np.arange(count) // columns])
    return scene(grid + shift, rough(count), 0.526, **arguments)


def test_scattered_products_are_nearly_exact():
    for substrate in (*SUBSTRATES, mf.BondedLayer(0.3, 0.5)):
        surface = loose(400)
        if substrate != SUBSTRATES[0]:
            block = mf.Block(20, 20, substrate.thickness)
            surface = surface.replaced(material=mf.Material(1, substrate.poisson_ratio), block=block)
        sums = ScatteredSums(surface.position, substrate)
        errors = products(surface, substrate, sums)
        assert errors[0] < 1e-10
        assert max(errors) < 1e-9  # derivatives lose the shortest wave on the grid, 5 per mean distance
        load = np.linspace(0.0, 1.0, 400)
        assert sums.error(load) < 1e-10 * np.abs(sums.displacement(load)).max()


def test_sums_over_two_clusters_and_along_a_line():
    rng = np.random.default_rng(0)
    clusters = np.vstack([loose(100).position, loose(100).position + 400.0])
    line = np.column_stack([np.arange(200.0) + rng.uniform(-0.3, 0.3, 200), np.zeros(200)])
    for position in (clusters, line):
        surface = scene(position, rough(200), 0.526)
        assert max(products(surface, mf.HalfSpace(), ScatteredSums(position, mf.HalfSpace()))) < 1e-9


def test_a_layer_without_near_pairs_couples_no_sites():
    sums = ScatteredSums(loose(400).position, mf.BondedLayer(0.01, 0.5))
    assert np.abs(sums.displacement(np.ones(400))).max() < 1e-14


def test_a_site_far_away_does_not_make_all_pairs_near():
    position = np.vstack([loose(2500).position, [[3000.0, 0.0]]])
    sums = ScatteredSums(position, mf.HalfSpace(), 1)
    assert sums.pairs[0].nnz < 0.2 * 0.5 * len(position) ** 2
    load = np.random.default_rng(0).random(len(position))
    assert sums.error(load) < 1e-10 * np.abs(sums.displacement(load)).max()


def test_lattices_are_found_far_from_the_origin():
    for shape in ((1, 9), (7, 1), (5, 8)):
        surface = mf.Surface.square_lattice(0.1, shape, 0.7, radius=0.1, material=mf.Material(1))
        for position in (surface.position, surface.position + 1e5):
            _, found, pitch = find_lattice(position)
            assert sorted(found) == sorted(shape)
            assert pitch == pytest.approx(0.7, rel=1e-9)


def test_scattered_places_are_no_lattice():
    rng = np.random.default_rng(0)
    assert find_lattice(rng.random((50, 2))) is None
    position = lattice(rough(49)).position
    assert find_lattice(position + 1e-6 * rng.random((49, 2))) is None
    apart = np.vstack([position[:4], position[:4] + 150.0])
    assert find_lattice(apart) is None


def test_a_lattice_with_few_of_its_sites_is_found():
    rng = np.random.default_rng(0)
    position = lattice(rough(2500)).position[rng.permutation(2500)[:300]]
    assert find_lattice(position)[2] == pytest.approx(1.5, rel=1e-9)


QUARTIC = mf.Interacting(3, contact=mf.Elastic(mf.Power(4)))


@pytest.mark.parametrize("model", [mf.Interacting(1), PEDESTAL, QUARTIC], ids=repr)
def test_newton_krylov_agrees_with_the_dense_kernel(model, request):
    load, radius = np.array([0.0, 0.05, 0.5, 2.0]), np.random.default_rng(0).uniform(0.4, 0.7, 144)
    surfaces = [part.replaced(radius=radius) for part in (lattice(rough(144)), loose(144))]
    matrices = [model.sensitivity(surface, load) for surface in surfaces]
    request.getfixturevalue("large")
    for surface, dense in zip(surfaces, matrices, strict=True):
        fast = model.sensitivity(surface, load)
        assert fast.curve.residual.max() < 1e-9
        slope = 1e-5 if model == QUARTIC else 1e-6  # of the load, by an inner iteration
        for name, rtol in (("area", 1e-8), ("approach", 1e-8), ("stiffness", slope)):
            assert_allclose(getattr(fast.curve, name), getattr(dense.curve, name), rtol=rtol)
        error = (1e-5 if model == QUARTIC else 1e-7) * np.abs(dense.gradient).max()
        assert_allclose(fast.gradient, dense.gradient, rtol=0.0, atol=error)
        assert_allclose(fast.indentation, dense.indentation, rtol=0.0, atol=1e-9)


@pytest.mark.usefixtures("large")
def test_load_and_approach_are_inverse_for_large_scenes():
    layer = mf.Interacting(pedestal=True, substrate=mf.BondedLayer())
    cases = (
        (lattice(rough(100)), mf.Interacting(), "FFT"),
        (lattice(rough(100)), layer, "FFT"),
        (loose(100), mf.Interacting(order=1), "scattered"),
    )
    for surface, model, way in cases:
        state = mf.equilibrium(surface, model, load=0.5)
        assert way in state.notes[0].text
        again = mf.equilibrium(surface, model, approach=state.approach)
        assert again.load == pytest.approx(0.5, rel=1e-8)
        step = 1e-4 * state.approach
        low, high = (mf.equilibrium(surface, model, approach=state.approach + s).load for s in (-step, step))
        assert (high - low) / (2 * step) == pytest.approx(state.stiffness, rel=1e-4)
        assert mf.equilibrium(surface, model, approach=-1.0).load == 0.0


@pytest.mark.usefixtures("large")
def test_an_ill_posed_large_scene_raises():
    """At order 1 the layer's self term wins over Hertz's compliance above a = 0.89 t."""
    surface = lattice(0.5 * np.ones(4), radius=1.0, thickness=0.3)
    with pytest.raises(mf.MetafemError):
        mf.equilibrium(surface, mf.Interacting(order=1, substrate=mf.BondedLayer()), approach=0.3)


@pytest.mark.parametrize("substrate", [mf.HalfSpace(), mf.BondedLayer(3.0, 0.5)], ids=repr)
def test_coarse_preconditioner_is_symmetric_and_positive_definite(substrate):
    """A grid wider than the layer sees negative waves: they once gave an indefinite matrix."""
    surface = lattice(rough(2500))
    rng = np.random.default_rng(0)
    inverse = np.where(rng.random(2500) < 0.7, rng.uniform(0.1, 50.0, 2500), 0.0)
    hats, influence = coarse_grid(surface.position, substrate)
    assert np.linalg.eigvalsh(influence).min() > -1e-15
    precondition, some = coarse_model(surface.position, substrate)(inverse), rng.standard_normal((100, 2500))
    images = np.array([precondition(one) for one in some])
    assert_allclose(images @ some.T, some @ images.T, rtol=0.0, atol=1e-9)
    # also for the smooth vectors whose loads the nodes carry
    smooth = np.array([np.where(inverse > 0.0, hat, 0.0) for hat in hats.toarray().T])
    for vector in (*some, *smooth[smooth.any(axis=1)]):
        assert vector @ precondition(vector) > 0.0
    assert not images[:, inverse == 0.0].any()


@pytest.mark.usefixtures("large")
def test_results_of_too_few_steps_are_not_converged(monkeypatch):
    surface = lattice(rough(100))
    curve = mf.Interacting().sensitivity(surface, np.array([0.5]))
    monkeypatch.setattr(newton_krylov, "MAX_INNER", 2)
    with pytest.raises(mf.NotConverged):
        mf.equilibrium(surface, mf.Interacting(), load=0.5)
    with pytest.raises(mf.NotConverged):
        np.asarray(curve.gradient)
