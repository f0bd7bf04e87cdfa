"""B and sigma: what they cover, their tests, points drawn again, and what is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from metafem import Friction
from metafem.calibration import Bootstrap, MeasurementErrors, shear
from metafem.errors import InvalidInput
from validation.scenes.sheared_contacts import ERRORS, RATIO, STRENGTH, sheared

TESTS = np.repeat(["a", "b", "c"], 20)


@pytest.fixture(scope="module")
def points():
    return sheared(np.random.default_rng(7))[0]


def test_exact_points_give_the_friction():
    _, exact = sheared(np.random.default_rng(0))
    found = shear(*exact)
    assert found.area_ratio == pytest.approx(RATIO, rel=1e-12)
    assert found.shear_strength == pytest.approx(STRENGTH, rel=1e-12)
    assert found.friction == Friction(found.shear_strength, found.area_ratio)


def test_tests_are_fitted_one_by_one_and_compared(points):
    found = shear(*points, test=TESTS)
    assert [each.name for each in found.tests] == ["a", "b", "c"]
    own = shear(*points[:, 20:40])
    assert found.tests[1].value[0] == own.area_ratio
    assert found.tests[1].sd[1] == pytest.approx(own.covariance[1, 1] ** 0.5)
    assert found.heterogeneity.freedom == 4
    assert found.heterogeneity.agree
    other = points.copy()
    other[2, 40:] *= 1.1
    different = shear(*other, test=TESTS)
    assert not different.heterogeneity.agree
    assert "Birge ratio" in str(different.notes[-1])


def test_quantities_that_were_not_measured_are_left_out(points):
    some = points.copy()
    some[2, :20] = np.nan  # the first test has no forces, the last no area before shear
    some[0, 40:] = np.nan
    some[1, 0] = np.nan
    found = shear(*some, test=TESTS)
    assert np.isnan(found.tests[0].value[1])
    assert np.isnan(found.tests[2].value[0])
    assert found.heterogeneity.freedom == 2
    assert found.area_verdict.freedom == 38
    assert np.isnan(found.area_fitted).sum() == 1
    assert "1 of 60 points" in str(found.notes[0])
    shear(*some, test=TESTS, bootstrap=Bootstrap(10))


def test_points_drawn_again_scatter_as_stated_and_repeat(points):
    found = shear(*points, test=TESTS, bootstrap=Bootstrap(2000))
    assert found.bootstrap.shape == (2000, 2)
    # of 60 points the scatter is known within about 10 %
    ratio = found.bootstrap.std(0) / np.sqrt(np.diagonal(found.covariance))
    assert (np.abs(ratio - 1.0) < 0.35).all()
    assert found == shear(*points, test=TESTS, bootstrap=Bootstrap(2000))
    assert found != shear(*points, test=TESTS, bootstrap=Bootstrap(2000, 1))


def test_areas_of_several_contacts_are_added(points):
    shares = np.array([0.2, 0.3, 0.5])
    together = shear(points[0][:, None] * shares, points[1][:, None] * shares, points[2])
    assert together.area_ratio == pytest.approx(shear(*points).area_ratio, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda b, s, f: (b, s, -f), "friction_force is not positive on the whole"),
        (lambda b, s, f: (b, s, f[::-1]), "friction_force decreases with area_sheared"),
        (lambda b, s, f: (b, s[::-1], f[::-1]), "area_sheared decreases with area_before"),
        (lambda b, s, f: (b, s[:5], f), "area_sheared has 5"),
        (lambda b, s, f: (b, -s, f), r"area_sheared\[0\] = .* must be greater than 0; leave out"),
        (lambda b, s, f: (b, s, f * np.inf), "friction_force holds inf at entry 0"),
        (lambda b, s, f: (b, s, f * np.nan), "sigma needs at least 2 points"),
        (lambda b, s, f: (b[:1], s[:1], f[:1]), "B needs at least 2 points with area_before and"),
        (lambda b, s, f: ("x", s, f), "area_before is not an array of numbers"),
        (lambda b, s, f: (b, s, f[:, None]), r"friction_force has shape \(20, 1\)"),
    ],
)
def test_bad_input_is_named(change, message):
    points, _ = sheared(np.random.default_rng(1), tests=1)
    with pytest.raises(InvalidInput, match=message):
        shear(*change(*points))


def test_labels_and_lines_that_do_not_exist_are_named(points):
    with pytest.raises(InvalidInput, match="must hold a label for each of the 60 points"):
        shear(*points, test=["a", "b"])
    with pytest.raises(InvalidInput, match=r'line = .* must be "area" or "friction"'):
        shear(*points).plot(line="load")


@settings(max_examples=20)
@given(st.floats(1e-4, 1e4), st.floats(1e-4, 1e4), st.permutations(range(60)))
def test_units_and_the_order_of_the_points_do_not_matter(points, area_unit, force_unit, order):
    errors = MeasurementErrors(
        boundary=ERRORS.boundary * area_unit**0.5, friction_force=ERRORS.friction_force * force_unit
    )
    scaled = points * np.array([[area_unit], [area_unit], [force_unit]])
    found, strength = shear(*points), force_unit / area_unit
    scale = np.array([1.0, strength])
    for in_order, each in ((True, scaled), (False, scaled[:, order])):
        other = shear(*each, errors=errors)
        assert other.area_ratio == pytest.approx(found.area_ratio, rel=1e-9)
        assert other.shear_strength == pytest.approx(found.shear_strength * strength, rel=1e-9)
        # an order in which the residuals are correlated by chance enlarges the covariance, as a drift does
        verdicts = (other.area_verdict, other.friction_verdict)
        if in_order or not any(verdict["correlation"].noticed for verdict in verdicts):
            np.testing.assert_allclose(other.covariance, found.covariance * np.outer(scale, scale), rtol=1e-6)
        assert other.area_verdict["chi_square"].statistic == pytest.approx(
            found.area_verdict["chi_square"].statistic, rel=1e-6
        )


@pytest.mark.parametrize(("line", "slope"), [("area", 0.85), ("friction", 0.37)])
def test_the_lines_are_drawn_with_their_points(points, line, slope):
    ax = shear(*points).plot(line=line)
    fitted = ax.lines[-1].get_xydata()
    assert fitted[0].tolist() == [0.0, 0.0]
    assert fitted[1, 1] / fitted[1, 0] == pytest.approx(slope, rel=0.02)
    assert len(ax.containers[0].lines[0].get_xdata()) == 60


def test_intervals_are_those_of_the_covariance_and_begin_at_zero_or_above(points):
    found = shear(*points)
    low, high = found.shear_strength_interval
    assert 0.5 * (high - low) == pytest.approx(0.9945 * found.covariance[1, 1] ** 0.5, rel=1e-4)
    assert found.area_verdict.fits
    assert found.friction_verdict.freedom == 59
    found = shear([1e-5, 2e-5], [1e-5, 1.5e-5], [3e-4, 1e-3])
    for value, (low, high) in (
        (found.area_ratio, found.area_ratio_interval),
        (found.shear_strength, found.shear_strength_interval),
    ):
        assert 0.0 <= low < value < high


def test_a_line_that_does_not_fit_and_areas_that_grow_are_noted(points):
    found = shear(*points[:2], points[2] + 0.02)
    assert not found.friction_verdict.fits
    assert str(found.notes[0]).startswith("F = sigma Af: the law does not fit")
    area = np.linspace(0.05, 0.5, 10)
    (note,) = shear(area, area / 0.85, 0.3 * area).notes
    assert "check that they are not exchanged" in str(note)
    assert not shear(area, 1.001 * area, 0.3 * area).notes
