"""Sensitivities of resolved contacts against extrapolated differences with the same cells in contact."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.boundary_elements import solve
from tests.core.models.test_shape_sensitivity import changed

OWN, LOAD = mf.Elastic(), np.array([0.06])
MIXED = (mf.Power(4.0), mf.Sphere(), mf.Power(1.5, 0.3), mf.Profile(lambda rho: rho**2 / 1.1 + rho**4, 0.6))


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
            areas.append(curve.area[0])
            cells.append(curve.last.field.pressure > 0.0)
        slopes.append((areas[0] - areas[1]) / (2.0 * step * size))
    if any(one.shape != cells[0].shape or (one != cells[0]).any() for one in cells):
        return None
    return (4.0 * slopes[1] - slopes[0]) / 3.0


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
def test_paraboloids_depend_on_the_curvature_of_the_summit(monkeypatch):
    for by in ("radius", "coefficient"):
        monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
        surface = scene((mf.Power(2.0, 0.4), mf.Sphere(), mf.Paraboloid(), mf.Power(2.0)))
        assert_exact(surface, mf.BoundaryElements(0.025), by, [0])


@pytest.mark.slow
def test_derivatives_by_all_asperities_are_those_of_order_3():
    for by in ("height", "radius", "exponent"):
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
