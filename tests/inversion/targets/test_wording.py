"""Targets are told in the units in which they were asked for."""

import numpy as np
import pytest

import metafem as mf
from metafem.files.result.records import from_record, to_record
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


@pytest.mark.parametrize(
    ("law", "title"),
    [
        (
            mf.LinearLaw.from_friction_coefficient(1.4, *PAIR, load_range=(0.05, 0.2)),
            "Friction proportional to load: friction coefficient 1.4 from 0.068 to 0.272 N",
        ),
        (
            mf.BilinearLaw.from_friction_coefficients((1.2, 1.9), 0.08, *PAIR, load_range=(0.05, 0.2)),
            "Bilinear friction law of friction coefficients 1.2 and 1.9 through the origin from 0.068 to "
            "0.272 N",
        ),
        (
            mf.MultilinearLaw.from_friction_coefficients((1.2, 1.9), [0.08], (0.05, 0.2), *PAIR),
            "Friction law of friction coefficients 1.2 and 1.9",
        ),
        (mf.MultilinearLaw((9.5, 8, 7), [0.07, 0.1], (0.03, 0.2)), "Friction law of slopes 9.5, 8 and 7"),
        (
            mf.PowerLaw.from_forces([0.136, 0.272], [0.1, 0.2], *PAIR),
            "Power law of exponent 1 from 0.136 to 0.272 N",
        ),
    ],
)
def test_titles_speak_as_the_target_was_asked(law, title):
    assert law.title == title
    assert from_record(to_record(law)).title == title


def test_two_targets_of_one_law_are_equal_however_asked():
    law = mf.LinearLaw.from_friction_coefficient(1.4, *PAIR, load_range=(0.05, 0.2))
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
            mf.LinearLaw.from_friction_coefficient(1.4, *PAIR, load_range=(0.01, 0.1)),
            "friction coefficient 1.4 through the origin cannot begin at 0.0136 N: .* up to 0.0268 N",
        ),
        (
            mf.BilinearLaw.from_friction_coefficients((1.6, 30.0), 0.038, *PAIR),
            r"friction_coefficients\[1\] = 30 .* of friction coefficient 1.6 up to 0.05168 N .* second "
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


def test_samples_and_points_in_newtons_are_answered_in_newtons(template):
    points = mf.OperatingPoints.from_forces([0.2], [50.0], *PAIR)
    with pytest.raises(mf.Infeasible, match=r"\(load 0.2 N, friction 50 N\) .* N$"):
        mf.design(points, template, limits=LIMITS)
    samples = mf.SampledLaw.from_forces([0.2, 0.3], [50.0, 60.0], *PAIR)
    with pytest.raises(mf.Infeasible, match=r"sample 1 \(load 0.2 N, friction 50 N\) is above .* N, for any"):
        mf.design(samples, template, limits=LIMITS)


def test_bounds_are_rounded_to_the_side_that_can_be_had():
    rng = np.random.default_rng(0)
    for value in 10.0 ** rng.uniform(-6, 6, 200):
        assert float(Wording().slope_bound(value, up=True)) >= value * (1.0 - 1e-5)
        assert value <= float(Wording().load_bound(value, up=True).split()[0]) <= 1.002 * value
        assert 0.998 * value <= float(Wording().load_bound(value, up=False).split()[0]) <= value


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: mf.LinearLaw.from_friction_coefficient(-1.0, *PAIR), "friction_coefficient = -1 must be"),
        (
            lambda: mf.BilinearLaw.from_friction_coefficients((1.0, -1.0), 0.1, *PAIR),
            r"friction_coefficients\[1\] = -1 must be",
        ),
        (lambda: mf.LinearLaw.from_friction_coefficient(1.0, 1.36, PAIR[1]), "material = 1.36 must be"),
        (lambda: mf.LinearLaw(1.0, wording="N"), "wording = 'N' must be"),
        (lambda: Wording(-1.0), "composite_modulus = -1 must be"),
    ],
)
def test_bad_requests_are_named(build, words):
    with pytest.raises(mf.InvalidInput, match=words):
        build()
