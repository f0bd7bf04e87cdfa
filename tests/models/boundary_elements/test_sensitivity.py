"""Sensitivities of resolved contacts: every parameter, coated asperities, and a periodic cell."""

import pytest

import metafem as mf
from metafem.models.boundary_elements import solve
from tests.core.models.boundary_elements.test_sensitivity import MIXED, OWN, assert_exact, scene

# Substrate, cap and parameter.
CASES = [
    *((mf.HalfSpace(), MIXED, by) for by in ("height", "radius", "exponent", "coefficient")),
    (mf.BondedLayer(), MIXED, "height"),
    (mf.BondedLayer(), mf.Power(3.0), "radius"),
    (mf.BondedLayer(), mf.Sphere(), "radius"),
]


@pytest.mark.parametrize(("substrate", "cap", "by"), CASES)
def test_derivatives_are_exact_while_the_same_cells_are_in_contact(substrate, cap, by, monkeypatch):
    monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
    assert_exact(scene(cap), mf.BoundaryElements(0.017, substrate, OWN), by, range(4))


def test_coated_asperities(monkeypatch):
    monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
    surface = scene(MIXED).replaced(friction=mf.Friction([0.2, 0.4, 0.3, 0.1], 1.0))
    assert_exact(surface, mf.BoundaryElements(0.017, contact=OWN), "radius", range(4))


def test_a_periodic_cell(monkeypatch):
    monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
    surface = scene(MIXED).replaced(cell=mf.PeriodicCell(2.4, 2.4))
    assert_exact(surface, mf.BoundaryElements(0.017, contact=OWN), "radius", range(4))
