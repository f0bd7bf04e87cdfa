"""The nearest points of a refusal."""

import numpy as np
import pytest

import metafem as mf
from metafem.errors import Infeasible

LOADS, FRICTION = [0.144, 0.336, 0.649], [0.84, 1.68, 4.12]
LIMITS = mf.Limits(0.27)


def nearest(load, friction, template):
    """Return the refused points and the nearest ones."""
    target = mf.OperatingPoints(load, friction)
    with pytest.raises(Infeasible) as caught:
        mf.design(target, template, limits=LIMITS)
    return target, caught.value.nearest


def test_later_points_move_as_well_where_the_moved_one_needs_all_asperities(template):
    target, near = nearest(LOADS, [4.0, 4.1, 4.2], template)
    assert np.array_equal(near.rescaled_load, target.rescaled_load)
    assert mf.design(near, template, limits=LIMITS).misfit < 1e-9


COUPLED = [
    mf.Interacting(1),
    mf.Interacting(3),
    mf.Interacting(3, mf.BondedLayer()),
    mf.Interacting(contact=mf.SphericalCap()),
]


@pytest.mark.parametrize("model", COUPLED, ids=["order 1", "order 3", "layer", "spheres"])
@pytest.mark.parametrize("spread", [0.0, 0.03])
def test_points_of_a_surface_are_not_refused_under_its_own_model(model, spread):
    """Equal heights have the largest friction of independent asperities; coupled ones have more."""
    rng = np.random.default_rng(0)
    surface = mf.Surface.square_lattice(
        0.2 - rng.uniform(0.0, spread, 9), (3, 3), 1.5, radius=0.526, material=mf.Material(1.36, 0.5),
        block=mf.Block(20.0, 20.0, 7.2),
    )  # fmt: skip
    for load in ([0.01, 0.05], [0.004, 0.02, 0.045]):
        points = mf.OperatingPoints(load, model.curve(surface, np.array(load)).area)
        found = mf.design(points, surface, model, mf.Limits(0.12, offset=0.08))
        assert found.misfit < 1e-3
