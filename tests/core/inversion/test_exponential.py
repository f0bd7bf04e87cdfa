"""Heights of exponential densities, those of the paper's tables among them, and slopes out of reach."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import metafem as mf

# Asperities on each level of Table S1, blue and red, from the lowest level on.
BLUE = [17, 12, 9, 7, 5, 4, 3, 2, 2, 1, 1, 1]
RED = [9, 8, 7, 6, 5, 4, 4, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1]


def middles(scale, low, high, count):
    """Middles of intervals of equal mass of exp(-h/scale), from the lowest on."""
    mass = np.linspace(np.exp(-low / scale), np.exp(-high / scale), count + 1)
    ends = -scale * np.log(mass)
    return 0.5 * (ends[1:] + ends[:-1])


@pytest.mark.parametrize(
    ("slope", "top", "offset", "counts"), [(9.43, 0.074, 0.08, BLUE), (6.87, 0.12, 0.084, RED)]
)
def test_the_levels_of_table_s1(template, slope, top, offset, counts):
    limits = mf.Limits(top, offset=offset, height_step=0.006)
    found = mf.design(mf.LinearLaw(slope), template, limits=limits)
    levels = offset + 0.006 * (np.arange(len(counts)) + 0.5)
    assert_allclose(np.sort(found.surface.height), np.repeat(levels, counts), rtol=0.0, atol=1e-12)
    assert_allclose(limits.levels[: len(levels)], levels, rtol=1e-12)
    assert_array_equal(found.parameters["counts"], counts)


def test_heights_of_a_linear_law_are_middles_of_equal_masses(template):
    found = mf.design(mf.LinearLaw(6.87), template, limits=mf.Limits(0.12, offset=0.084))
    scale, foot = found.parameters["scale"], found.parameters["foot_load"]
    assert_allclose(np.sort(found.surface.height) - 0.084, middles(scale, 0.0, 0.12, 64), rtol=1e-12)
    ((branch, _),) = found.fits
    assert branch.load_range == pytest.approx((0.25 * foot, foot), rel=1e-12)


def test_heights_of_a_bilinear_law_are_those_of_table_s2(template):
    """The red surface; its scale, weight and crossover height are solved by quadrature."""
    limits = mf.Limits(0.12, offset=0.05)
    found = mf.design(mf.BilinearLaw((7.15, 12.52), 0.0380), template, limits=limits)
    scale, middle = found.parameters["scale"], found.parameters["crossover_height"] - 0.05
    assert scale == pytest.approx(0.035680, abs=5e-7)
    assert found.parameters["weight"] == pytest.approx(0.14941, abs=5e-6)
    assert middle == pytest.approx(0.015338, abs=5e-7)
    parts = middles(scale, 0.0, middle, 58), middles(scale, middle, 0.12, 6)
    assert_allclose(np.sort(found.surface.height) - 0.05, np.concatenate(parts), rtol=1e-11)


def test_the_finest_scale_bounds_the_friction_coefficient_as_printed(template):
    """From 1.10 to 3.03 with heights of 0.9 µm precision, in the paper; all digits by quadrature."""
    found = mf.achievable_friction_coefficients(template, mf.Limits(0.12, height_sd=0.9e-3))
    assert found == pytest.approx((1.104, 3.032), abs=5e-4)
