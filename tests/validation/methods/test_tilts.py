"""Scatter of the slope under a tilt, against limits in which it is known."""

import numpy as np
import pytest

from validation.methods.tilts import slope_scatter

RADIUS, LOAD = 0.526, np.linspace(0.1, 0.4, 12)
SITES = np.random.default_rng(3).random((9, 2)) * 4.0
HEIGHT = 0.1 + 0.05 * np.random.default_rng(4).random(9)


def test_small_angles_change_the_slope_in_proportion():
    """The slope is a smooth function of the angle while no contact opens or closes."""
    small, large = (slope_scatter(SITES, HEIGHT, 10.0 * LOAD, RADIUS, angle, 200) for angle in (1e-6, 2e-6))
    assert large == pytest.approx(2.0 * small, rel=1e-3)


def test_a_uniform_rise_changes_nothing():
    scatter = slope_scatter(np.full((9, 2), 3.0), HEIGHT, LOAD, RADIUS, 2e-3, 20)
    assert scatter == pytest.approx(0.0, abs=1e-7)


def test_lists_are_evaluated_together_as_one_by_one():
    lists = np.array([HEIGHT, HEIGHT[::-1]])
    together = slope_scatter(SITES, lists, LOAD, RADIUS, 2e-3, 30)
    alone = np.array([slope_scatter(SITES, each, LOAD, RADIUS, 2e-3, 30) for each in lists])
    assert together == pytest.approx(alone, rel=1e-9)
