"""Laws of random real surfaces are met under the model that they come from."""

import pytest

from validation.scenes.real_targets import outcome, real_target

# Height errors change a law by more than this.
MISFIT = 2e-3


@pytest.mark.parametrize("first", range(0, 60, 12))
def test_targets_of_real_surfaces_are_neither_refused_nor_missed(first):
    found = [outcome(real_target(seed)) for seed in range(first, first + 12)]
    assert [each for each in found if each.misfit > MISFIT] == []


def test_the_surface_of_a_target_meets_it_within_the_limits():
    for seed in range(40):
        scene = real_target(seed)
        law = scene.target.curve()
        curve = scene.model.curve(scene.surface, law.load)
        assert law.misfit(curve.area) < 1e-9
        assert scene.surface.height.min() >= scene.limits.foot - 1e-12 * scene.limits.top
        assert scene.surface.height.max() <= scene.limits.top * (1.0 + 1e-12)
        assert curve.approach[-1] <= scene.limits.top
