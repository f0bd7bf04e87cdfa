"""Sensitivities of resolved contacts: every parameter, coated asperities, and a periodic cell."""

import pytest

import metafem as mf
from metafem.models.boundary_elements import solve
from tests.core.models.boundary_elements.test_sensitivity import MIXED, OWN, assert_exact, scene

# Substrate, surface and parameter.
CASES = [
    *((mf.HalfSpace(), scene(MIXED), by) for by in ("height", "radius", "exponent", "coefficient")),
    (mf.BondedLayer(), scene(MIXED), "height"),
    (mf.BondedLayer(), scene(mf.Power(3.0)), "radius"),
    (mf.BondedLayer(), scene(mf.Sphere()), "radius"),
    (mf.HalfSpace(), scene(MIXED).replaced(friction=mf.Friction([0.2, 0.4, 0.3, 0.1], 1.0)), "radius"),
    (mf.HalfSpace(), scene(MIXED).replaced(cell=mf.PeriodicCell(2.4, 2.4)), "radius"),
]


@pytest.mark.parametrize(("substrate", "surface", "by"), CASES)
def test_derivatives_are_exact_while_the_same_cells_are_in_contact(substrate, surface, by, monkeypatch):
    monkeypatch.setattr(solve, "TOLERANCE", 1e-12)
    assert_exact(surface, mf.BoundaryElements(0.017, substrate, OWN), by, range(4))
