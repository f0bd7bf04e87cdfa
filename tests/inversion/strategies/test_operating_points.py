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


@pytest.mark.parametrize(("load", "share"), [(0.25, 0.9), (0.25, 1.06), (0.4, 1.1)])
def test_the_nearest_points_keep_all_points_and_move_one(template, load, share):
    row = int(np.searchsorted(LOADS, load))
    friction = share * float(np.interp(load, LOADS, FRICTION))
    target, near = nearest(np.insert(LOADS, row, load), np.insert(FRICTION, row, friction), template)
    assert np.array_equal(near.rescaled_load, target.rescaled_load)
    assert np.count_nonzero(near.rescaled_friction != target.rescaled_friction) == 1
    found = mf.design(near, template, limits=LIMITS)
    assert found.misfit < 1e-9


def test_later_points_move_as_well_where_the_moved_one_needs_all_asperities(template):
    target, near = nearest(LOADS, [4.0, 4.1, 4.2], template)
    assert np.array_equal(near.rescaled_load, target.rescaled_load)
    assert mf.design(near, template, limits=LIMITS).misfit < 1e-9
