"""What targets state of themselves, in the units in which they were asked for."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.result import misfit_text

PAIR = mf.Material(1.36), mf.Friction(0.358, 0.85)
PER_SLOPE = 0.358 * 0.85 / 1.36
TARGETS = {
    "Friction law through 2 operating points": mf.OperatingPoints([0.1, 0.2], [0.8, 1.5]),
    "Friction law given by 2 samples": mf.SampledLaw([0.1, 0.2], [0.8, 1.5]),
    "Power law of exponent 1.2 from 0.1 to 0.2 mm²": mf.PowerLaw(1.2, (0.1, 0.2)),
    "Friction proportional to load: slope 7 from 0.1 to 0.2 mm²": mf.LinearLaw(7.0, (0.1, 0.2)),
    "Friction law of slopes 7 and 9": mf.MultilinearLaw([7.0, 9.0], [0.15], (0.1, 0.2)),
}


def test_a_target_states_its_law_up_to_its_last_load():
    for title, target in TARGETS.items():
        assert (target.title, target.last_load) == (title, 0.2)
        law = target.curve()
        assert law.load[[0, -1]].tolist() == [0.1, 0.2]
        assert law.misfit(law.law(np.linspace(0.8, 1.5, len(law.load)))) == pytest.approx(0.0, abs=1e-12)
    assert (mf.LinearLaw(7.0).last_load, mf.LinearLaw(7.0).branches) == (None, ())


def test_branches_share_an_intercept_where_they_meet():
    joined, apart = (mf.MultilinearLaw([7.0, 9.0], [c], (0.1, 0.2)).curve() for c in (0.15, (0.14, 0.16)))
    assert (joined.free.shape[1], apart.free.shape[1]) == (1, 2)


def test_a_friction_coefficient_is_a_slope():
    law = mf.LinearLaw.from_friction_coefficient(1.4, *PAIR, load_range_N=(0.068, 0.272))
    assert law.slope == pytest.approx(1.4 / PER_SLOPE, rel=1e-15)
    assert law.title == "Friction proportional to load: friction coefficient 1.4 from 0.068 to 0.272 N"
    assert law == mf.LinearLaw(law.slope, (0.05, 0.2))
    assert hash(law) == hash(mf.LinearLaw(law.slope, (0.05, 0.2)))


def test_targets_from_forces():
    points = mf.OperatingPoints.from_forces([0.2, 0.4], [0.3, 0.5], *PAIR)
    np.testing.assert_allclose(points.rescaled_load, np.array([0.2, 0.4]) / 1.36, rtol=1e-12)
    np.testing.assert_allclose(points.rescaled_friction, np.array([0.3, 0.5]) / 0.3043, rtol=1e-12)
    line = mf.LinearLaw.from_forces([0.1, 0.2, 0.3], [0.3, 0.5, 0.7], *PAIR)
    assert line.slope == pytest.approx(2.0 / PER_SLOPE, rel=1e-12)
    two = mf.BilinearLaw.from_forces([0.1, 0.2, 0.3], [0.1, 0.2, 0.4], *PAIR)
    assert two.slopes[1] == pytest.approx(2.0 * two.slopes[0], rel=1e-12)
    assert two.crossover_load == pytest.approx(0.2 / 1.36, rel=1e-12)
    pair = mf.Material(2.0), mf.Friction(0.5)
    power = mf.PowerLaw.from_forces([1.0, 2.0, 4.0], [1.0, 2.0**0.9, 4.0**0.9], *pair)
    assert power.exponent == pytest.approx(0.9, rel=1e-12)
    assert power.load_range == (0.5, 2.0)
    many = mf.MultilinearLaw.from_forces([1.0, 2.0, 3.0], [1.0, 2.0, 4.0], *pair)
    assert many.slopes == pytest.approx((4.0, 8.0), rel=1e-12)
    assert many.crossover_loads == ((1.0, 1.0),)
    sampled = mf.SampledLaw.from_forces([1.0, 2.0], [1.0, 2.0], *pair)
    np.testing.assert_allclose(sampled.rescaled_friction, [2.0, 4.0], rtol=1e-12)
    band = mf.Band.from_forces([0.1, 0.2], [0.1, 0.2], [0.2, 0.3], mf.Material(2.0), mf.Friction(0.4, 0.5))
    np.testing.assert_allclose(band.rescaled_load, [0.05, 0.1], rtol=1e-12)
    np.testing.assert_allclose([band.lowest, band.highest], [[0.5, 1.0], [1.0, 1.5]], rtol=1e-12)


def test_a_misfit_above_a_limit_is_not_printed_as_the_limit():
    texts = {
        0.0: "below 1e-9", 0.0049: "0.49 %", 0.01: "1 %", 0.01003: "1.003 %", 0.1004: "10.04 %", 3.3: "330 %",
    }  # fmt: skip
    assert [misfit_text(misfit) for misfit in texts] == list(texts.values())
