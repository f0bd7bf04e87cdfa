"""Measured laws, their two branches, and their agreement with designs."""

import numpy as np
import pytest
from scipy.optimize import minimize

import metafem as mf
from metafem.calibration import MeasuredLaw, MeasurementErrors, compare, crossover, measured_law
from metafem.calibration.crossovers import bent
from tests.calibration.measured_law.scenes import (
    FRICTION,
    LOAD,
    MATERIAL,
    contacts,
    law_of,
    linear_design,
    measured_on,
    template,
    two_branches,
)

ERRORS = MeasurementErrors()


def test_the_points_are_rescaled_with_the_errors_of_the_paper():
    law = law_of()
    np.testing.assert_array_equal(law.load, [0.1, 0.2, 0.3])  # in order of load
    np.testing.assert_array_equal(law.friction_force, [0.05, 0.09, 0.13])
    np.testing.assert_allclose(law.rescaled_load, law.load / 1.36)
    np.testing.assert_allclose(law.rescaled_load_sd, 5e-3 / 1.36)
    np.testing.assert_allclose(law.rescaled_friction, law.friction_force / (0.404 * 0.85))
    np.testing.assert_allclose(law.rescaled_friction_sd, (1e-3 + 0.01 * law.friction_force) / (0.404 * 0.85))
    np.testing.assert_allclose(law.friction_coefficient, law.friction_force / law.load)


def test_areas_take_the_place_of_forces():
    areas = np.array([[0.1, 0.0], [0.2, 0.05]])
    law = MeasuredLaw([0.1, 0.2], asperity_area=areas, site=[7, 3], material=MATERIAL)
    np.testing.assert_allclose(law.rescaled_friction, [0.1, 0.25])
    # independent boundaries: the squares of the contacts' errors add up to that of their total area
    np.testing.assert_allclose(law.area_sd, ERRORS.of_area(law.area), rtol=1e-12)
    beside = MeasuredLaw([0.1, 0.2], area=law.area, material=MATERIAL, friction=FRICTION)
    np.testing.assert_allclose(beside.friction_coefficient, 0.404 * 0.85 * law.area / law.load)
    with pytest.raises(mf.InvalidInput, match="was not measured"):
        _ = law.friction_coefficient


def test_a_measured_and_a_predicted_law_have_the_same_fit_and_tables():
    predicted = mf.friction_law(template(), load=np.linspace(0.1, 0.5, 9))
    pair = {"material": predicted.material, "friction": predicted.friction}
    measured = MeasuredLaw(predicted.load, friction_force=predicted.friction_force, **pair)
    one_fit, other = predicted.fit(load=(0.1, 0.5)), measured.fit(load=(0.1, 0.5))
    assert one_fit.slope == pytest.approx(other.slope, rel=1e-12)
    shared = set(predicted.to_dataframe()) & set(measured.to_dataframe())
    assert {"load_N", "rescaled_load_mm2", "friction_force_N", "friction_coefficient"} <= shared
    for name in shared:
        np.testing.assert_allclose(measured.to_dataframe()[name], predicted.to_dataframe()[name], rtol=1e-12)
    assert measured.to_xarray()["load_sd"].attrs["units"] == "N"


def test_the_contacts_of_images_become_a_law_without_images_that_lack_a_quantity():
    law = measured_law(contacts(), MATERIAL)
    np.testing.assert_allclose(law.area, [0.05, 0.3, 0.7])
    np.testing.assert_allclose(law.area_sd, [5e-4, np.hypot(1e-3, 2e-3), np.hypot(3e-3, 4e-3)])
    assert law.site.tolist() == [5, 2]
    forces = np.array([0.1, 0.05, np.nan])
    law = measured_law(contacts(friction_force=forces), MATERIAL, FRICTION)
    np.testing.assert_allclose(law.friction_force, [0.05, 0.1])
    assert [str(note).endswith("left out: c") for note in law.notes] == [True]
    merged = np.array([[0.1, np.nan], [0.05, 0.0], [0.3, 0.4]])
    for matched in (True, False):
        some = contacts(area=merged, area_error=0.01 * merged, matched=matched)
        assert "left out: a" in str(measured_law(some, MATERIAL).notes[0])
    forces = contacts(area=merged, area_error=0.01 * merged, friction_force=np.array([0.1, 0.05, 0.2]))
    law = measured_law(forces, MATERIAL, FRICTION)
    assert (np.isnan(law.asperity_area).sum(), law.area) == (1, None)
    faint = contacts(area_error=np.array([[0.01, 0.01], [0.01, 0.006], [0.01, 0.01]]))
    law = measured_law(faint, MATERIAL)
    assert law.asperity_area_sd[0].tolist() == [0.01, 0.006]


def test_the_least_chi_square_is_that_of_a_minimiser_over_lines_and_true_loads():
    rng = np.random.default_rng(3)
    x = np.linspace(0.01, 0.16, 16)
    y = 0.5 + np.where(x < 0.08, 7.0, 12.0) * (x - 0.08)
    x, y = np.sort(x + rng.normal(0, 3e-3, 16)), y + rng.normal(0, 8e-3, 16)
    kink = 0.5 * (x[7] + x[8])
    points = np.array([x, y, np.full(16, 3e-3), np.full(16, 8e-3)])
    line, variance, least = bent(points, np.array([kink]))

    def square(p):
        true = x + np.linspace(-6.0, 6.0, 4001)[:, None] * 3e-3
        value = p[0] + np.where(true < kink, p[1], p[2]) * (true - kink)
        return (((x - true) / 3e-3) ** 2 + ((y - value) / 8e-3) ** 2).min(axis=0).sum()

    best = minimize(square, [0.5, 7.0, 12.0], method="Nelder-Mead", options={"fatol": 1e-10, "xatol": 1e-8})
    assert least[0] == pytest.approx(best.fun, rel=1e-4)
    assert line[0] == pytest.approx(best.x, abs=2e-2 * np.sqrt(variance[0]).max())


def test_two_lines_are_found_with_their_crossover():
    found = crossover(two_branches())
    np.testing.assert_allclose(found.slopes, (7.0, 12.5), rtol=1e-3)
    assert found.crossover_load == pytest.approx(0.1, rel=1e-3)
    assert found.crossover_friction == pytest.approx(0.7, rel=1e-3)
    assert found.crossover_interval[0] < 0.1 < found.crossover_interval[1]
    for slope, (low, high) in zip(found.slopes, found.slope_intervals, strict=True):
        assert low < slope < high
    noisy = crossover(two_branches(noise=1.0))
    assert noisy.verdict.fits
    assert noisy == crossover(two_branches(noise=1.0))


def test_a_common_factor_is_every_deviation():
    for factor in (1.0, 1.04):
        found = compare(measured_on(linear_design(), np.linspace(0.02, 0.6, 12), factor), linear_design())
        np.testing.assert_allclose(found.percent, 100.0 * (factor - 1.0), atol=1e-9)


def test_deviations_have_the_stated_covariance():
    """Simulated parts with drawn forces, E*, sigma and B."""
    rng, load, linear = np.random.default_rng(1), np.linspace(0.05, 0.55, 8), linear_design()
    pair = {"parameters": ["composite_modulus", "shear_strength", "area_ratio"]}
    pair["covariance"] = np.diag([0.04**2, 0.006**2, 0.01**2])
    drawn = []
    for _ in range(200):
        e, s, b = rng.standard_normal(3)
        # what the laboratory believes differs from what the part has
        material = mf.Material(1.36 + 0.04 * e)
        friction = mf.Friction(0.358 + 0.006 * s, 0.85 + 0.01 * b)
        law = measured_on(linear, load, rng=rng, material=material, friction=friction)
        found = compare(law, linear, **pair)
        drawn.append(found.deviation[np.argsort(law.load)])
    expected = compare(measured_on(linear, load), linear, **pair)
    ratio = np.std(drawn, axis=0, ddof=1) / expected.deviation_sd
    # four standard errors of a standard deviation of 200 draws
    np.testing.assert_allclose(ratio, 1.0, atol=4.0 / np.sqrt(400))
    correlation = np.corrcoef(np.array(drawn).T)[-1, -2]
    stated = expected.covariance[-1, -2] / np.prod(expected.deviation_sd[-2:])
    assert correlation == pytest.approx(stated, abs=4.0 * (1.0 - stated**2) / np.sqrt(200))


def test_loads_beyond_the_design_are_left_out_and_named():
    linear = linear_design()
    end = float(linear.law.load[-1])
    law = measured_on(linear, np.linspace(0.1, 0.8, 8))
    load, force = np.append(law.load, [1.5 * end, 2.0 * end]), np.append(law.friction_force, [2.0, 2.5])
    found = compare(measured_on(linear, load, friction_force=force), linear)
    assert len(found.deviation) == (law.load <= end).sum()
    assert "left out" in found.notes[0].text


def test_the_part_that_is_the_design_is_accepted_as_often_as_stated():
    linear = linear_design()
    rng, load = np.random.default_rng(2), np.linspace(0.05, 0.6, 10)
    verdicts = [compare(measured_on(linear, load, rng=rng), linear).verdict for _ in range(200)]
    share = np.mean([verdict.probability < 0.2 for verdict in verdicts])
    assert abs(share - 0.2) < 4.0 * np.sqrt(0.2 * 0.8 / 200)
    assert np.mean([verdict.fits for verdict in verdicts]) > 0.93


def test_a_matrix_of_a_calibration_is_taken_as_it_is():
    linear = linear_design()
    law = measured_on(linear, np.linspace(0.1, 0.6, 6))
    sd = {"shear_strength": 0.006, "area_ratio": 0.01}
    apart = compare(law, linear, parameters=list(sd), covariance=np.diag([0.006**2, 0.01**2]))
    assert apart.parameters == pytest.approx(sd)
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


def test_a_law_with_one_branch_has_no_bounded_crossover():
    x = LOAD
    one = MeasuredLaw(
        x, area=7.0 * x, load_sd=np.full(19, 3e-3), area_sd=np.full(19, 8e-3), material=mf.Material(1.0)
    )
    assert crossover(one).ambiguous
    assert not crossover(two_branches()).ambiguous


def test_exchanged_columns_are_suspected():
    law = measured_on(linear_design(), np.linspace(0.1, 0.6, 8))
    right = {"material": law.material, "friction": law.friction}
    wrong = MeasuredLaw(law.friction_force, friction_force=law.load, **right)
    assert "exchanged" in compare(wrong, linear_design()).notes[0].text
    assert not any("exchanged" in note.text for note in compare(law, linear_design()).notes)
