"""Targets are told in the units in which they were asked for."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.targets.wording import Wording

PAIR = mf.Material(1.36), mf.Friction(0.358, 0.85)
LIMITS = mf.Limits(0.12, offset=0.05, height_sd=0.0009)
PER_SLOPE = 0.358 * 0.85 / 1.36


def test_a_friction_coefficient_is_kept_and_told():
    law = mf.LinearLaw.from_friction_coefficient(1.4, *PAIR)
    assert law.friction_coefficient == 1.4
    assert law.slope == pytest.approx(1.4 / PER_SLOPE, rel=1e-15)
    assert law.title == "Linear friction law of friction coefficient 1.4"
    assert mf.LinearLaw(6.87).friction_coefficient is None


def test_loads_of_coefficients_are_newtons():
    """A crossover in N is not taken for one in mm^2, and the keyword of the latter is unknown."""
    law = mf.BilinearLaw.from_friction_coefficients((1.2, 1.7), 0.3, *PAIR, load_range_N=(0.1, 0.6))
    assert law.crossover_load == pytest.approx(0.3 / 1.36, rel=1e-15)
    assert law.load_range == pytest.approx((0.1 / 1.36, 0.6 / 1.36), rel=1e-15)
    many = mf.MultilinearLaw.from_friction_coefficients((1.2, 1.7), [(0.2, 0.3)], (0.1, 0.6), *PAIR)
    assert many.crossover_loads[0] == pytest.approx((0.2 / 1.36, 0.3 / 1.36), rel=1e-15)
    for make in (
        lambda: mf.LinearLaw.from_friction_coefficient(1.4, *PAIR, load_range=(0.05, 0.2)),
        lambda: mf.BilinearLaw.from_friction_coefficients((1.2, 1.9), *PAIR, crossover_load=0.08),
        lambda: mf.MultilinearLaw.from_friction_coefficients((1.2,), [], load_range=(0.05, 0.2)),
    ):
        with pytest.raises(TypeError, match="load"):
            make()
    with pytest.raises(mf.InvalidInput, match=r"crossover_load = 0.8 N \(0.588235 mm\^2\) must lie inside"):
        mf.BilinearLaw.from_friction_coefficients((1.2, 1.7), 0.8, *PAIR, load_range_N=(0.1, 0.6))


def test_two_targets_of_one_law_are_equal_however_asked():
    law = mf.LinearLaw.from_friction_coefficient(1.4, *PAIR, load_range_N=(0.068, 0.272))
    assert law == mf.LinearLaw(law.slope, (0.05, 0.2))
    assert hash(law) == hash(mf.LinearLaw(law.slope, (0.05, 0.2)))


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (
            mf.LinearLaw.from_friction_coefficient(0.9, *PAIR),
            r"friction coefficient 0.9 is not above the bound 3 pi/4 sqrt\(R/h_m\) sigma B/E\* = 1.10376 .*"
            "raise the friction coefficient",
        ),
        (
            mf.LinearLaw.from_friction_coefficient(1.4, *PAIR, load_range_N=(0.0136, 0.136)),
            r"friction coefficient 1.4 through the origin cannot begin at 0.0136 N \(0.01 mm\^2\): .* up to "
            r"0.0268 N \(0.0197 mm\^2\)",
        ),
        (
            mf.BilinearLaw.from_friction_coefficients((1.6, 30.0), 0.05168, *PAIR),
            r"friction_coefficients\[1\] = 30 .* coefficient 1.6 up to 0.05168 N \(0.038 mm\^2\) .* second "
            "friction coefficient can be from 0.7635 to 18.05",
        ),
    ],
)
def test_what_cannot_be_reached_is_answered_as_it_was_asked(template, law, words):
    with pytest.raises(mf.Infeasible, match=words) as caught:
        mf.design(law, template, limits=LIMITS)
    assert "slope" not in str(caught.value)
    near = caught.value.nearest
    assert near is None or "friction coefficient" in near.title
    if near is not None:
        mf.design(near, template, limits=LIMITS)


def test_bounds_are_rounded_to_the_side_that_can_be_had():
    rng = np.random.default_rng(0)
    for value in 10.0 ** rng.uniform(-6, 6, 200):
        assert float(Wording().slope_bound(value, up=True)) >= value * (1.0 - 1e-5)
        assert value <= float(Wording().load_bound(value, up=True).split()[0]) <= 1.002 * value
        assert 0.998 * value <= float(Wording().load_bound(value, up=False).split()[0]) <= value
