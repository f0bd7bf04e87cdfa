"""Bounds that no surface of independent asperities leaves, with one radius and with several."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion.feasibility import (
    friction_bounds,
    largest_exponent,
    least_exponent,
    relative_depth,
)
from metafem.inversion.radii import Radii

RADIUS = 0.526


@given(st.integers(0, 10**6), st.sampled_from([1.0, 1.5, 4.0, 30.0]))
def test_no_surface_leaves_the_bounds(seed, ratio):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 40))
    height = rng.exponential(rng.uniform(0.001, 0.1), count)
    radii = Radii.of(RADIUS) if ratio == 1.0 else Radii.given(mf.RadiusRange(RADIUS, ratio * RADIUS))
    radius = RADIUS * ratio ** rng.uniform(0.0, 1.0, count).round(int(rng.integers(0, 3)))
    load = np.sort(rng.uniform(1e-4, 1.0, 12))
    _, carried, area, _ = mf.Independent().curves(height, radius, load)
    low, high = friction_bounds(load, radii, count)
    assert (area[0] >= low * (1.0 - 1e-12)).all()
    assert (area[0] <= high * (1.0 + 1e-12)).all()
    exponents = np.diff(np.log(area[0])) / np.diff(np.log(carried[0]))
    assert exponents.min() >= least_exponent(radii) - 1e-9
    assert math.log(area[0, -1] / area[0, 0]) / math.log(load[-1] / load[0]) <= largest_exponent(
        (load[0], load[-1]), radii, count
    ) * (1.0 + 1e-12)
    step = 1e-7
    near = mf.Independent().curves(height, radius, load[5] * np.array([1.0, 1.0 + step]))[2][0]
    # the steepest slope: N equal contacts of the largest radius with this sum of R d carry the load
    steepest = 0.5 * math.pi * count * radii.high**2 * 0.75 * load[5] / (area[0, 5] / math.pi) ** 2
    flattest = least_exponent(radii) * area[0, 5] / load[5]
    slope = float(np.diff(near)[0]) / (load[5] * step)
    assert flattest * (1.0 - 1e-5) <= slope <= steepest * (1.0 + 1e-5)  # a difference of first order


@pytest.mark.parametrize("ratio", [1.5, 4.0, 100.0])
def test_the_least_exponent_is_that_of_two_kinds_of_contact(ratio):
    """With numbers as real weights the bound is attained, and no other pair of depths is below it."""
    radii = Radii.given(mf.RadiusRange(1.0, ratio))
    k, s = math.sqrt(1.0 / ratio), relative_depth(radii)

    def exponent(small, relative):
        R, number = np.array([ratio, 1.0]), np.array([1.0, small])
        a = R * np.array([1.0, relative])
        grown = 2.0 / 3.0 * (number @ R) * (number @ (a**3 / R))
        return grown / ((number @ a**2) * (number @ a))

    best = exponent(1.0 / (k * s) ** 3, s * s)
    assert best == pytest.approx(least_exponent(radii), rel=1e-12)
    shares = np.geomspace(0.01, 100.0, 81)
    assert best <= min(exponent(a / (k * s) ** 3, b * s * s) for a in shares for b in shares) * (1.0 + 1e-12)


def test_one_radius_has_the_exponent_of_equal_contacts():
    assert least_exponent(Radii.of(RADIUS)) == 2.0 / 3.0


def test_a_choice_of_radii_widens_the_region(template):
    load, limits = [0.1, 0.4], mf.Limits(0.12)
    low, high = mf.feasible_region(template, load, limits, [0.2, 0.8])
    least, _ = mf.feasible_region(template.replaced(radius=0.2), load, limits)
    _, most = mf.feasible_region(template.replaced(radius=0.8), load, limits)
    np.testing.assert_array_equal([low, high], [least, most])


def test_a_jump_beyond_all_asperities_at_once_is_refused(template):
    """N contacts that open at p0 reach A with A^3 = A0^3 + 9/16 pi^3 N R^2 (p^2 - p0^2) at the most."""
    limits = mf.Limits(0.3)
    with pytest.raises(mf.Infeasible, match=r"sample 2 .* after a smaller load, 0\.412481 mm\^2"):
        mf.design(mf.SampledLaw([0.1, 0.1001], [0.4, 1.2]), template, limits=limits)


@pytest.mark.parametrize("substrate", [mf.HalfSpace(), mf.BondedLayer()], ids=["half-space", "layer"])
def test_the_margin_lets_interacting_laws_of_deep_equal_contacts_pass(template, substrate):
    model, load = mf.Interacting(substrate=substrate), np.linspace(0.1, 2.0, 20)
    height = 0.3 - np.random.default_rng(0).uniform(0.0, 0.005, 64)
    target = mf.SampledLaw(load, model.curve(template.replaced(height=height), load).area)
    assert mf.design(target, template, model, mf.Limits(0.3)).misfit < 0.01
