"""Two branches: the segmented regression and the rule of the paper."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasuredLaw, branches, fit_segments
from metafem.calibration.measured_law.bent_line import REGULAR_GROWTH, growths

LOAD = np.linspace(0.01, 0.19, 19)


def law_of(x=LOAD, noise=0.0, crossover=0.1, sx=3e-3, sy=8e-3, seed=0):
    rng = np.random.default_rng(seed)
    y = np.where(x < crossover, 7.0 * x, 7.0 * crossover + 12.5 * (x - crossover))
    return MeasuredLaw(
        x + noise * sx * rng.standard_normal(len(x)),
        area=y + noise * sy * rng.standard_normal(len(x)),
        load_sd=np.full(len(x), sx),
        area_sd=np.full(len(x), sy),
        material=mf.Material(1.0),
    )


def test_two_lines_are_found_with_their_crossover():
    found = fit_segments(law_of())
    np.testing.assert_allclose(found.slopes, (7.0, 12.5), rtol=1e-3)
    assert found.crossover_load == pytest.approx(0.1, rel=1e-3)
    assert found.crossover_friction == pytest.approx(0.7, rel=1e-3)
    assert found.crossover_interval[0] < 0.1 < found.crossover_interval[1]
    for slope, (low, high) in zip(found.slopes, found.slope_intervals, strict=True):
        assert low < slope < high
    noisy = fit_segments(law_of(noise=1.0))
    assert noisy.verdict.fits
    assert noisy == fit_segments(law_of(noise=1.0))
    assert "crossover 0.1 (" in repr(found)


def test_a_slope_has_the_error_of_a_straight_line_where_the_crossover_is_certain():
    """With errors a hundred times smaller, each branch is a line of its own with the usual standard error."""
    found = fit_segments(law_of(sx=3e-5, sy=8e-5))
    x = LOAD[LOAD <= 0.1]
    sd = np.hypot(8e-5, 7.0 * 3e-5) / np.sqrt(((x - x.mean()) ** 2).sum())
    low, high = found.slope_intervals[0]
    assert 0.5 * (high - low) == pytest.approx(sd, rel=0.15)
    np.testing.assert_allclose(found.growth, REGULAR_GROWTH, rtol=0.1)


def test_the_growth_of_chi_square_is_regular_for_small_errors_and_larger_for_competing_splits():
    p = np.array([0.1, 0.7, 7.0, 12.5])
    many = [
        np.stack([LOAD, LOAD, np.full(19, s * 3e-3), np.full(19, s * 8e-3)])[:, None] for s in (0.05, 0.7)
    ]
    small, large = (growths(points, p[None], 4000, np.random.default_rng(0))[:, 0] for points in many)
    # the standard error of this quantile of 4,000 draws is about 0.03
    np.testing.assert_allclose(small, REGULAR_GROWTH, atol=0.1)
    assert large[2] > 1.2


def test_a_law_with_one_branch_has_no_bounded_crossover():
    x = LOAD
    one = MeasuredLaw(
        x, area=7.0 * x, load_sd=np.full(19, 3e-3), area_sd=np.full(19, 8e-3), material=mf.Material(1.0)
    )
    found = fit_segments(one)
    assert any("do not bound the crossover" in note.text for note in found.notes)
    with pytest.raises(mf.InvalidInput, match="the law has one branch"):
        branches(one)


def test_the_rule_of_the_paper_is_that_of_its_points():
    found = branches(law_of(sx=1e-3, sy=1e-3))
    np.testing.assert_allclose(found.first.slope, 7.0, rtol=1e-9)
    assert found.crossover_interval == pytest.approx((0.1, 0.11))
    assert found.crossover_load == pytest.approx(0.105)  # late by half a step
    fixed = branches(law_of(sx=1e-3, sy=1e-3), first=6, second=5)
    assert (fixed.first.points, fixed.second.points) == (6, 5)
    assert fixed.crossover_interval == found.crossover_interval


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: fit_segments(law_of(LOAD[:6])), "law has 6 points; two lines that meet need at least 7"),
        (lambda: fit_segments(law_of(), draws=5), "draws = 5 must be a whole number of at least 100"),
        (lambda: fit_segments(LOAD), "must be a metafem.calibration.MeasuredLaw"),
        (lambda: fit_segments(law_of(np.repeat([0.1, 0.2], 4))), "law has 2 different loads; two lines that"),
        (lambda: branches(law_of(LOAD[:5])), "law has 5 points; two branches need at least 6"),
        (lambda: branches(law_of(), first=19), "first = 19 leaves none of the 19 points"),
        (lambda: branches(law_of(), second=2), "second = 2 must be a whole number of at least 3"),
        (lambda: branches(law_of(np.repeat([0.1, 0.2], 4))), "points 1 to 3 have one load"),
    ],
)
def test_what_has_no_two_branches_is_refused(call, words):
    with pytest.raises(mf.InvalidInput, match=words):
        call()
