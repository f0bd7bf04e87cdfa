"""The nearest points of a refusal."""

import numpy as np
import pytest

import metafem as mf

LOADS, FRICTION = [0.144, 0.336, 0.649], [0.84, 1.68, 4.12]
LIMITS = mf.Limits(0.27)


@pytest.mark.parametrize(("load", "share"), [(0.25, 0.9), (0.25, 1.1), (0.4, 1.2)])
def test_the_nearest_points_can_be_designed(template, load, share):
    row = int(np.searchsorted(LOADS, load))
    friction = share * float(np.interp(load, LOADS, FRICTION))
    target = mf.OperatingPoints(np.insert(LOADS, row, load), np.insert(FRICTION, row, friction))
    with pytest.raises(mf.Infeasible) as caught:
        mf.design(target, template, limits=LIMITS)
    near = caught.value.nearest
    assert np.array_equal(near.rescaled_load, target.rescaled_load)
    found = mf.design(near, template, limits=LIMITS)
    assert found.misfit < 0.01


def test_empty_sites_have_a_reason_that_holds(template):
    """A further asperity adds friction at the loads of the points where it touches, and else none."""
    target, limits = mf.OperatingPoints([0.05, 0.1], [0.5, 0.9]), mf.Limits(0.12)
    design = mf.design(target, template, limits=limits)
    assert design.surface.count < template.count
    assert "sites; one more asperity in contact would exceed the target\n" in repr(design)
    surface, model = design.surface, design.law.model
    area = model.curve(surface, target.rescaled_load).area
    for depth in np.linspace(0.0, np.ptp(surface.height) + 0.02, 12):
        height = [*surface.height, surface.height.max() - depth]
        position, radius = template.position[: len(height)], template.radius[: len(height)]
        more = template.replaced(position=position, height=height, radius=radius)
        assert (model.curve(more, target.rescaled_load).area >= area * (1.0 - 1e-12)).all()
