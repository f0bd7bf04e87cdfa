"""Quadrature of height densities, against closed forms and limits."""

import numpy as np
import pytest
from scipy.special import gamma, gammainc

from metafem.reference import height_densities as reference
from validation.methods import densities

RADIUS, TOP, COUNT = 0.526, 0.120, 64


@pytest.mark.parametrize("power", [0.0, 1.0, 1.5])
def test_moment_is_an_incomplete_gamma_function(power):
    scale, low = 0.04, 0.03
    expected = scale ** (power + 1.0) * np.exp(-low / scale) * gamma(power + 1.0)
    expected *= gammainc(power + 1.0, (TOP - low) / scale)
    assert densities.moment(scale, power, low, TOP) == pytest.approx(expected, rel=1e-12)


def test_load_of_a_uniform_density():
    """The mean of h^1.5 on [0, h_m] is 2/5 h_m^1.5."""
    expected = 4.0 / 3.0 * COUNT * np.sqrt(RADIUS) * 0.4 * TOP**1.5
    assert densities.load_at_foot(1e9, TOP, COUNT, RADIUS) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("scale", [0.02, 0.04, 0.5])
def test_scale_is_that_of_the_printed_slope(scale):
    slope = reference.slope(scale, RADIUS, TOP)
    assert densities.scale_of_slope(slope, TOP, RADIUS) == pytest.approx(scale, rel=1e-9)


def test_two_branches_solve_the_printed_equations():
    slopes, load = (7.15, 12.52), 0.0737
    scale, weight, height = densities.two_branches(slopes, load, TOP, COUNT, RADIUS)
    printed = scale, RADIUS, TOP, height, weight
    assert reference.slope(scale, RADIUS, TOP) == pytest.approx(slopes[0], rel=1e-10)
    assert reference.second_slope(*printed) == pytest.approx(slopes[1], rel=1e-9)
    assert reference.crossover_load(*printed, COUNT) == pytest.approx(load, rel=1e-9)


def test_share_above_of_one_branch_is_that_of_the_exponential():
    expected = (np.exp(-1.0) - np.exp(-3.0)) / (1.0 - np.exp(-3.0))
    assert densities.share_above(0.04, 1.0, 0.04, TOP) == pytest.approx(expected, rel=1e-12)


def test_mean_power_of_one_branch_is_that_of_two_of_equal_weight():
    one = densities.mean_power(0.04, 1.5, 0.01, TOP)
    assert densities.mean_power(0.04, 1.5, 0.01, TOP, crossover=0.05) == pytest.approx(one, rel=1e-12)
    expected = densities.moment(0.04, 1.5, 0.01, TOP) / densities.moment(0.04, 0.0, 0.0, TOP)
    assert one == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("weight", [0.15, 3.0])
def test_two_branches_have_mass_one(weight):
    assert densities.mean_power(0.04, 0.0, 0.0, TOP, 0.02, weight) == pytest.approx(1.0, rel=1e-12)


def test_intervals_of_a_wide_density_are_equal():
    middles = densities.interval_middles(1e6, 0.02, 0.12, np.full(5, 0.2))
    assert middles == pytest.approx([0.03, 0.05, 0.07, 0.09, 0.11], rel=1e-6)


def test_expected_counts_add_up_and_decrease():
    counts = densities.expected_counts(0.02, 0.074, 0.006, COUNT)
    assert len(counts) == 13
    assert counts.sum() == pytest.approx(COUNT, rel=1e-12)
    assert np.all(np.diff(counts) < 0.0)
