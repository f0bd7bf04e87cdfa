"""B and sigma from shear tests: lines with errors on all quantities, full contact, and records."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

import metafem as mf
from metafem.calibration import MeasurementErrors, at_peak, shear, shear_strength
from metafem.calibration.sheared import proportional
from tests.calibration.sheared.scenes import SURFACE, X, area, force, measured
from validation.scenes.sheared_contacts import ERRORS, RATIO, STRENGTH, sheared

TESTS = np.repeat(["a", "b", "c"], 20)


@pytest.fixture(scope="module")
def points():
    return sheared(np.random.default_rng(7))[0]


def test_the_fit_minimises_the_sum_over_factors_and_values():
    errors = (ERRORS.of_area, ERRORS.of_area, ERRORS.of_friction_force)
    points, _ = sheared(np.random.default_rng(3), tests=1, loads=4)
    points[2, 1] = points[0, 2] = np.nan
    fit = proportional(points, errors)
    ratio, value = fit.parameter, fit.abscissa
    fitted = np.vstack([value, ratio.cumprod()[:, None] * value])
    deviation = np.stack([of(each) for of, each in zip(errors, fitted, strict=True)])

    def residuals(unknown):
        q, x = np.append(1.0, np.cumprod(unknown[:2])), unknown[2:]
        return np.nan_to_num((points - q[:, None] * x) / deviation).ravel()

    found = least_squares(residuals, np.append(ratio, value) * 1.01, jac="3-point", xtol=1e-14, gtol=1e-14)
    assert ratio == pytest.approx(found.x[:2], abs=1e-6)
    assert fit.covariance == pytest.approx(np.linalg.inv(found.jac.T @ found.jac)[:2, :2], rel=1e-5)


def test_exact_points_give_the_friction():
    _, exact = sheared(np.random.default_rng(0))
    found = shear(*exact)
    assert found.estimates["area_ratio"].value == pytest.approx(RATIO, rel=1e-12)
    assert found.estimates["shear_strength"].value == pytest.approx(STRENGTH, rel=1e-12)
    assert found.friction.stress == pytest.approx(STRENGTH * RATIO)


def test_tests_are_compared(points):
    found = shear(*points, test=TESTS)
    own = sum(shear(*points[:, first : first + 20]).verdict.chi_square for first in (0, 20, 40))
    assert found.heterogeneity.chi_square == pytest.approx(found.verdict.chi_square - own)
    assert found.heterogeneity.freedom == 4
    assert found.heterogeneity.fits
    other = points.copy()
    other[2, 40:] *= 1.1
    different = shear(*other, test=TESTS)
    assert not different.heterogeneity.fits
    assert "Birge ratio" in str(different.notes[-1])


def test_quantities_that_were_not_measured_are_left_out(points):
    some = points.copy()
    some[2, :20] = np.nan  # the first test has no forces, the last no area before shear
    some[0, 40:] = np.nan
    some[1, 0] = np.nan
    found = shear(*some, test=TESTS)
    assert found.heterogeneity is None
    # 19, 20 and 20 points with two, three and two quantities, and two parameters
    assert found.verdict.freedom == 19 + 40 + 20 - 2
    assert "1 of 60 points" in str(found.notes[0])
    assert "not compared, as one has no fit of its own: sigma needs" in str(found.notes[1])


@settings(max_examples=10)
@given(st.floats(1e-4, 1e4), st.floats(1e-4, 1e4), st.permutations(range(60)))
def test_units_and_the_order_of_the_points_do_not_matter(points, area_unit, force_unit, order):
    errors = MeasurementErrors(
        boundary=ERRORS.boundary * area_unit**0.5, friction_force=ERRORS.friction_force * force_unit
    )
    scaled = points * np.array([[area_unit], [area_unit], [force_unit]])
    found, scale = shear(*points), np.array([1.0, force_unit / area_unit])
    for each in (scaled, scaled[:, order]):
        other = shear(*each, errors=errors)
        for (value, *_), (own, *_), factor in zip(
            other.estimates.values(), found.estimates.values(), scale, strict=True
        ):
            assert value == pytest.approx(own * factor, rel=1e-9)
        np.testing.assert_allclose(other.covariance, found.covariance * np.outer(scale, scale), rtol=1e-6)
        assert other.verdict.chi_square == pytest.approx(found.verdict.chi_square, rel=1e-6)


def test_intervals_are_those_of_the_covariance_and_begin_at_zero_or_above(points):
    found = shear(*points)
    low, high = found.estimates["shear_strength"].interval
    assert 0.5 * (high - low) == pytest.approx(0.9945 * found.covariance[1, 1] ** 0.5, rel=1e-4)
    assert found.verdict.fits
    assert found.verdict.freedom == 118
    found = shear([1e-5, 2e-5], [1e-5, 1.5e-5], [3e-4, 1e-3])
    for value, _, (low, high) in found.estimates.values():
        assert 0.0 <= low < value < high


def test_a_line_that_does_not_fit_is_noted(points):
    found = shear(*points[:2], points[2] + 0.02)
    assert not found.verdict.fits
    assert str(found.notes[0]).startswith("area_ratio and shear_strength: the law does not fit:")
    area = np.linspace(0.05, 0.5, 10)
    slightly = shear(area, 1.001 * area, 0.3 * area)
    assert not slightly.notes
    assert slightly.friction.area_ratio == 1.0


@pytest.mark.parametrize("model", [mf.Interacting(substrate=mf.BondedLayer()), mf.Independent(mf.Elastic())])
def test_full_contact_gives_the_strength_of_the_model(model):
    cap = [mf.Power(3), mf.Sphere(), mf.Power(1.5, 0.3)] * 3 if model.contact == mf.Elastic() else SURFACE.cap
    surface = SURFACE.replaced(cap=cap)
    exact = mf.friction_law(surface, model, load=[0.05, 0.2, 0.4, 0.3])
    found = shear_strength(measured(exact), surface, 0.1, model=model)
    assert found.value == pytest.approx(0.37, rel=1e-9)
    with pytest.raises(mf.InvalidInput, match=r"load_min = 0\.001 "):
        shear_strength(measured(exact), surface, 0.001, model=model)


AREAS = (ERRORS.of_area, ERRORS.of_area, ERRORS.of_friction_force)


def test_constant_errors_of_two_quantities_give_demings_line():
    rng = np.random.default_rng(2)
    x = np.linspace(1.0, 2.0, 9)
    points = np.stack([x, 0.7 * x]) + 0.05 * rng.standard_normal((2, 9))
    constant = [lambda value: np.full_like(value, 0.05)] * 2
    factor = proportional(points, constant).parameter
    # the direction of the largest moment of the points about the origin
    moments = points @ points.T
    axis = np.linalg.eigh(moments)[1][:, -1]
    assert factor[0] == pytest.approx(axis[1] / axis[0], rel=1e-10)


def test_the_peak_of_an_exact_record_and_its_area_between_the_frames():
    assert (at_peak(X, force(X)), at_peak(X, force(X), area(X))) == pytest.approx((0.2, 0.425))
    sparse = np.full_like(X, np.nan)
    sparse[::4] = area(X)[::4]  # no frame at the peak, entry 15
    assert at_peak(X, force(X), sparse) == pytest.approx(0.25 * area(X)[12] + 0.75 * area(X)[16])
