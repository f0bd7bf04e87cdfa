"""Sums of Hertz contacts by Newton's method, against closed forms."""

import numpy as np
import pytest

from validation.methods.independent import approaches, areas, fitted_slope, sums

RADIUS = 0.526


def test_equal_heights_share_the_load():
    load, count = np.array([1e-4, 0.1, 2.0]), 7
    one = np.pi * RADIUS * (0.75 * load / count / np.sqrt(RADIUS)) ** (2.0 / 3.0)
    assert areas(np.full(count, 0.1), load, RADIUS) == pytest.approx(count * one, rel=1e-13)


def test_the_approach_carries_the_load_and_lower_summits_stay_open():
    height, load = np.array([[0.3, 0.29, 0.0], [0.1, 0.1, 0.1]]), np.array([0.01, 0.05])
    approach = approaches(height, load, RADIUS)
    depth = approach[..., None] - (height.max(axis=1, keepdims=True) - height)[:, None, :]
    assert sums(depth, RADIUS)[1] == pytest.approx(np.broadcast_to(load, (2, 2)), rel=1e-12)
    assert np.all(depth[0, :, 2] < 0.0)


def test_lists_are_evaluated_together_as_one_by_one():
    height, load = np.random.default_rng(0).random((3, 5)), np.linspace(0.1, 1.0, 4)
    one_by_one = np.array([areas(each, load, RADIUS) for each in height])
    assert areas(height, load, RADIUS) == pytest.approx(one_by_one, rel=1e-12)


def test_slope_is_that_of_polyfit():
    height, load = np.random.default_rng(1).random(9), np.linspace(0.2, 1.0, 12)
    expected = np.polyfit(load, areas(height, load, RADIUS), 1)[0]
    assert fitted_slope(height, load, RADIUS) == pytest.approx(expected, rel=1e-12)
