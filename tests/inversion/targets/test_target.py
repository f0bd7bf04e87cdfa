"""What every target states of itself."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.targets.wording import Wording

PAIR = mf.Material(2.0), mf.Friction(0.5)
TARGETS = {
    "Friction law through 2 operating points": mf.OperatingPoints([0.1, 0.2], [0.8, 1.5]),
    "Friction law given by 2 samples": mf.SampledLaw([0.1, 0.2], [0.8, 1.5]),
    "Power law of exponent 1.2 from 0.1 to 0.2 mm²": mf.PowerLaw(1.2, (0.1, 0.2)),
    "Friction proportional to load: slope 7 from 0.1 to 0.2 mm²": mf.LinearLaw(7.0, (0.1, 0.2)),
    "Bilinear friction law of slopes 6 and 9 through the origin from 0.1 to 0.2 mm²": mf.BilinearLaw(
        (6.0, 9.0), 0.15, (0.1, 0.2)
    ),
    "Friction law of slopes 7 and 9": mf.MultilinearLaw([7.0, 9.0], [0.15], (0.1, 0.2)),
}


@pytest.mark.parametrize("title", TARGETS)
def test_a_target_states_its_law_up_to_its_last_load(title):
    target = TARGETS[title]
    assert target.title == title
    assert target.last_load == 0.2
    law = target.curve()
    assert law.load[[0, -1]].tolist() == [0.1, 0.2]
    assert law.misfit(law.law(np.linspace(0.8, 1.5, len(law.load)))) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("target", [mf.LinearLaw(7.0), mf.BilinearLaw((6.0, 9.0), 0.15)])
def test_slopes_alone_are_no_curve(target):
    assert (target.last_load, target.branches) == (None, ())
    with pytest.raises(mf.InvalidInput, match="the target has no load_range: its law is that of the height"):
        target.curve()


def test_branches_share_an_intercept_where_they_meet():
    joined, apart = (mf.MultilinearLaw([7.0, 9.0], [c], (0.1, 0.2)).curve() for c in (0.15, (0.14, 0.16)))
    assert (joined.free.shape[1], apart.free.shape[1]) == (1, 2)


def test_forces_need_as_many_points_as_the_law_has_parameters():
    for kind, words in (
        (mf.LinearLaw, "a slope needs at least 2 points"),
        (mf.PowerLaw, "an exponent needs at least 2 points"),
        (mf.MultilinearLaw, "a branch needs at least 2 points"),
    ):
        with pytest.raises(mf.InvalidInput, match=f"load holds 1 value; {words}"):
            kind.from_forces([1.0], [1.0], *PAIR)


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: mf.OperatingPoints([1, 2], [1]), "rescaled_friction has 1 number; it must have 2"),
        (lambda: mf.OperatingPoints([1, 1], [1, 2]), r"rescaled_load\[1\] = 1 does not exceed"),
        (lambda: mf.OperatingPoints([1, 2], [2, 1]), r"rescaled_friction\[1\] = 1 does not exceed"),
        (lambda: mf.OperatingPoints([0, 1], [1, 2]), r"rescaled_load\[0\] = 0 must be greater than 0"),
        (lambda: mf.LinearLaw(math.nan), "slope = nan must be finite"),
        (lambda: mf.BilinearLaw((1, 2, 3), 0.1), "slopes has 3 numbers"),
        (lambda: mf.BilinearLaw((1, -2), 0.1), r"slopes\[1\] = -2 must be greater"),
        (lambda: mf.SampledLaw([0.2, 0.1], [1, 2]), r"rescaled_load\[1\] = 0.1 does not exceed"),
        (lambda: mf.SampledLaw([0.1, 0.2], [2, 0]), r"rescaled_friction\[1\] = 0 .*must be greater"),
        (
            lambda: mf.SampledLaw([0.1, 0.2], [1, 2], None, [0.1, 3]),
            r"relative_error\[1\] = 3 must be below 1",
        ),
        (lambda: mf.SampledLaw([0.1, np.nan], [1, 2]), "rescaled_load holds nan"),
        (lambda: mf.SampledLaw([0.1, 0.2], [1, 2], [1, 0]), r"weight\[1\] = 0 must be greater"),
        (lambda: mf.PowerLaw(-1.0, (0.1, 0.4)), "exponent = -1 must be greater"),
        (lambda: mf.PowerLaw(1.0, (0.4, 0.1)), r"load_range\[1\] = 0.1 does not exceed"),
        (lambda: mf.MultilinearLaw([1, 2], [], (0.1, 0.4)), "must hold 1 loads or pairs"),
        (lambda: mf.MultilinearLaw([1, -2], [0.2], (0.1, 0.4)), "slopes holds -2"),
        (lambda: mf.MultilinearLaw([1, 2], [0.5], (0.1, 0.4)), "branch 2 would run from 0.5 to 0.4"),
        (lambda: mf.LinearLaw(7.0, (0.2, 0.1)), r"load_range\[1\] = 0.1 does not exceed"),
        (lambda: mf.LinearLaw(7.0, True), "load_range"),
        (lambda: mf.BilinearLaw((6.0, 9.0), 0.3, (0.1, 0.2)), r"crossover_load = 0.3 mm\^2 must lie inside"),
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
def test_bad_targets_are_named(build, words):
    with pytest.raises(mf.InvalidInput, match=words):
        build()
