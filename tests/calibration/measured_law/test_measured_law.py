"""Measured laws: fits of two lines, what is noted, and how often parts are accepted."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasuredLaw, compare, fit_segments
from metafem.calibration.measured_law.bent_line import REGULAR_GROWTH, growths
from tests.calibration.measured_law.scenes import LOAD, law_of, linear_design, measured_on, two_branches


def test_the_part_that_is_the_design_is_accepted_as_often_as_stated():
    linear = linear_design()
    rng, load = np.random.default_rng(2), np.linspace(0.05, 0.6, 10)
    verdicts = [compare(measured_on(linear, load, rng=rng), linear).verdict for _ in range(200)]
    share = np.mean([verdict["chi_square"].probability < 0.2 for verdict in verdicts])
    assert abs(share - 0.2) < 4.0 * np.sqrt(0.2 * 0.8 / 200)
    assert np.mean([verdict.fits for verdict in verdicts]) > 0.93


def test_a_matrix_of_a_calibration_is_taken_as_it_is():
    linear = linear_design()
    law = measured_on(linear, np.linspace(0.1, 0.6, 6))
    sd = {"shear_strength": 0.006, "area_ratio": 0.01}
    apart = compare(law, linear, parameters=sd)
    same = compare(law, linear, parameters=list(sd), covariance=np.diag([0.006**2, 0.01**2]))
    np.testing.assert_allclose(same.covariance, apart.covariance, rtol=1e-12)
    assert same.parameters == pytest.approx(sd)
    # sigma B known much better than its factors
    together = compare(law, linear, parameters=list(sd), covariance=[[3.6e-5, -8.5e-5], [-8.5e-5, 2.01e-4]])
    assert (together.deviation_sd < apart.deviation_sd).all()


def test_points_are_drawn_with_error_bars():
    law = law_of()
    for units, x, y in (
        ("N", law.load, law.friction_force),
        ("mm^2", law.rescaled_load, law.rescaled_friction),
    ):
        (bars,) = law.plot(units=units, label="part 1").containers
        assert bars.has_xerr
        assert bars.has_yerr
        np.testing.assert_allclose(bars.lines[0].get_xydata(), np.column_stack([x, y]))


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
    assert any("do not bound" in note.text for note in fit_segments(one).notes)


def test_a_slope_has_the_error_of_a_straight_line_where_the_crossover_is_certain():
    """With errors a hundred times smaller, each branch is a line of its own with the usual standard error."""
    law = two_branches(sx=3e-5, sy=8e-5)
    x = law.load[law.load <= 0.1]
    sd = np.hypot(8e-5, 7.0 * 3e-5) / np.sqrt(((x - x.mean()) ** 2).sum())
    low, high = fit_segments(law).slope_intervals[0]
    assert 0.5 * (high - low) == pytest.approx(sd, rel=0.15)
