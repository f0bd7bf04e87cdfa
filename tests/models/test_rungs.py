"""The choice of the cheapest sufficient model: its estimates, on random scenes."""

import numpy as np
import pytest

from validation.scenes.ladder import Choice, choices

SCENES = 150


@pytest.fixture(scope="module")
def found():
    """Choices on random scenes, as arrays."""
    return Choice(*np.array(choices(SCENES)).T)


def test_the_chosen_model_is_within_the_tolerance(found):
    assert len(found.error) > SCENES
    assert (found.error <= found.tolerance).all()


def test_the_chosen_model_is_the_cheapest_or_the_next(found):
    above = found.chosen - found.cheapest
    assert (above == 0).mean() >= 0.9
    assert above.max() <= 1
    assert {*found.chosen.tolist()} == {0, 1, 2}


def test_estimates_are_within_a_factor_of_three(found):
    large = (found.error > 1e-4) & (found.chosen < 2)
    ratio = found.estimate[large] / found.error[large]
    assert large.sum() > SCENES / 4
    assert ((ratio > 1 / 3) & (ratio < 3)).mean() >= 0.98
    assert ratio.min() > 0.9
