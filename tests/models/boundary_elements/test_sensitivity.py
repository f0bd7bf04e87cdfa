"""Sensitivities of resolved contacts against extrapolated differences with the same cells in contact."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.boundary_elements import solve
from tests.models.test_shape_sensitivity import changed

OWN = mf.Elastic()
MIXED = (mf.Power(4.0), mf.Sphere(), mf.Power(1.5, 0.3), mf.Profile(lambda rho: rho**2 / 1.1 + rho**4, 0.6))
CAPS = {"mixed": MIXED, "power": mf.Power(3.0), "sphere": mf.Sphere(), "parabolic": mf.Power(2.0)}
LOAD = np.array([0.06])


def scene(cap):
    rng = np.random.default_rng(2)
    height, radius = rng.uniform(0.095, 0.1, 4), rng.uniform(0.4, 0.6, 4)
    caps = list(cap) if isinstance(cap, tuple) else cap
    block = mf.Block(20.0, 20.0, 3.0)
    return mf.Surface.square_lattice(
        height, (2, 2), 1.2, radius=radius, material=mf.Material(1.0), block=block, cap=caps
    )


def difference(surface, model, by, i):
    """The derivative by central differences, or None if the cells in contact differ."""
    cells, slopes = [], []
    for step in (1e-2, 5e-3) if by == "height" else (4e-5, 2e-5):  # 1 and 0.5 nm
        areas = []
        for sign in (1.0, -1.0):
            other, size = changed(surface, by, i, sign * step)
            curve = model.curve(other, LOAD)
            areas.append(curve.rescaled_friction[0])
            cells.append(curve.last.field.pressure > 0.0)
        slopes.append((areas[0] - areas[1]) / (2.0 * step * size))
    if any(one.shape != cells[0].shape or (one != cells[0]).any() for one in cells):
        return None
    return (4.0 * slopes[1] - slopes[0]) / 3.0


@pytest.mark.slow
@pytest.mark.parametrize("by", ["height", "radius", "exponent", "coefficient"])
@pytest.mark.parametrize("cap", CAPS)
@pytest.mark.parametrize("substrate", [mf.HalfSpace(), mf.BondedLayer()], ids=lambda s: s.name)
def test_derivatives_are_exact_while_the_same_cells_are_in_contact(substrate, cap, by, monkeypatch):
    monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
    surface, model = scene(CAPS[cap]), mf.BoundaryElements(0.017, substrate, OWN)
    if by not in ("height", *surface.cap.parameters):
        with pytest.raises(mf.InvalidInput, match=f"by = '{by}' must be 'height' or 'radius'"):
            model.sensitivity(surface, LOAD, by=by)
        return
    assert_exact(surface, model, by, range(4))


def assert_exact(surface, model, by, some):
    found = model.sensitivity(surface, LOAD, by=by)
    np.testing.assert_allclose(found.curve.area, model.curve(surface, LOAD).area, rtol=1e-12)
    scale, compared = np.abs(found.gradient).max(), 0
    for i in some:
        expected = difference(surface, model, by, i)
        if expected is not None:
            compared += 1
            assert abs(found.gradient[0, i] - expected) <= 1e-7 * scale
    assert compared > 0


@pytest.mark.slow
@pytest.mark.parametrize("by", ["height", "radius", "exponent"])
def test_coated_asperities(by, monkeypatch):
    monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
    surface = scene(MIXED).replaced(friction=mf.Friction([0.2, 0.4, 0.3, 0.1], 1.0))
    assert_exact(surface, mf.BoundaryElements(0.017, contact=OWN), by, range(4))


@pytest.mark.parametrize("by", ["radius", "coefficient"])
def test_paraboloids_depend_on_the_curvature_of_the_summit(by, monkeypatch):
    monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
    surface = scene((mf.Power(2.0, 0.4), mf.Sphere(), mf.Paraboloid(), mf.Power(2.0)))
    assert_exact(surface, mf.BoundaryElements(0.025), by, [0])


@pytest.mark.slow
def test_a_periodic_cell(monkeypatch):
    monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
    surface = scene(MIXED).replaced(cell=mf.PeriodicCell(2.4, 2.4))
    assert_exact(surface, mf.BoundaryElements(0.017, contact=OWN), "radius", range(4))


@pytest.mark.parametrize("by", ["height", "radius", "exponent"])
def test_derivatives_by_all_asperities_are_those_of_order_3(by):
    # the sum over the asperities hardly scatters with the cells
    surface = scene(mf.Power(3.0))
    found, order_3 = (
        model.sensitivity(surface, LOAD, by=by).gradient.sum()
        for model in (mf.BoundaryElements(0.02, contact=OWN), mf.Interacting(contact=OWN))
    )
    assert found == pytest.approx(order_3, rel=0.03, abs=1e-6)


def test_no_load_has_no_derivatives():
    found = mf.BoundaryElements(0.02, contact=OWN).sensitivity(scene(MIXED), np.array([0.0]), by="radius")
    assert not found.gradient.any()


def test_what_has_no_derivatives_is_refused():
    surface = scene(mf.Sphere())
    with pytest.raises(mf.InvalidInput, match="too coarse for the largest contact"):
        mf.BoundaryElements(0.05, contact=OWN).sensitivity(surface, np.array([1e-4]))
    near = surface.replaced(position=0.3 * surface.position)
    with pytest.raises(mf.InvalidInput, match=r"have merged or do not have the shape.*Interacting"):
        mf.BoundaryElements(0.02, contact=OWN).sensitivity(near, np.array([0.1]), by="radius")
