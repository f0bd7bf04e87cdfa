"""Calibration of contacts: round trips, pooled tests, the radius, the bootstrap, and wrong data."""

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.calibration import Bootstrap, MeasurementErrors, Sample, fit_compression
from validation.scenes.drift import with_outlier

RADIUS, MODULUS, ENERGY = 0.526, 1.36, 9e-6
A = np.linspace(0.08, 0.4, 20)
AREA = math.pi * A**2
FIVE = Sample(5)
SMALL = np.linspace(0.05, 0.25, 20)
TABLE = mf.TabulatedContact(
    *np.loadtxt("meshes/soft_cap.csv", delimiter=",", skiprows=1).T, material=mf.Material(1.0)
)
CAP = mf.AxisymmetricCap(lambda rho: rho**2 / (2 * RADIUS) + rho**4, extent=0.4)
PROFILE = mf.AxisymmetricCap(np.array([SMALL, SMALL**2 / (2 * RADIUS)]) * (SMALL > 0.05))


def load_of(a, cap=None, energy=ENERGY, modulus=MODULUS):
    rescaled = (cap or mf.Hertz()).load(a, RADIUS)
    return modulus * rescaled - np.sqrt(8.0 * math.pi * energy * modulus * a**3)


@pytest.mark.parametrize(
    "cap",
    [mf.Power(3.0), mf.Power(4.0, 2.0), mf.Paraboloid(), mf.Profile(lambda rho: rho**3, extent=0.6)],
    ids=["power 3", "power 4", "paraboloid", "profile"],
)
def test_caps_of_a_sample_give_modulus_and_adhesion(cap):
    place = [[0.0, 0.0], [70.0, 0.0], [0.0, 70.0]]
    surface = mf.Surface(place, [0.3] * 3, RADIUS, mf.Material(1.0), cap=cap)
    elastic = mf.Elastic()
    sample = Sample(3, model=mf.Independent(elastic), surface=surface)
    found = fit_compression(3 * load_of(A, elastic.bound(surface)), 3 * AREA, RADIUS, sample)
    assert found.composite_modulus == pytest.approx(MODULUS, rel=1e-9)
    assert found.adhesion_energy == pytest.approx(ENERGY, rel=1e-9)


def of_cap(cap, contacts=1):
    return Sample(contacts, model=mf.Independent(contact=cap))


def noisy(seed, contacts=1, energy=ENERGY, modulus=MODULUS):
    errors, rng = MeasurementErrors(), np.random.default_rng(seed)
    load = contacts * load_of(A, energy=energy, modulus=modulus) + errors.load * rng.standard_normal(A.size)
    total = contacts * AREA
    return load, total + errors.of_area(total) * rng.standard_normal(A.size)


@pytest.mark.parametrize("cap", [mf.Hertz(), mf.SphericalCap(), mf.PowerCap(3.0, 0.4), CAP, TABLE], ids=repr)
def test_exact_data_of_any_cap_give_e_and_w_back(cap):
    found = fit_compression(5.0 * load_of(SMALL, cap), 5.0 * math.pi * SMALL**2, RADIUS, of_cap(cap, 5))
    assert found.composite_modulus == pytest.approx(MODULUS, rel=1e-9)
    assert found.adhesion_energy == pytest.approx(ENERGY, rel=1e-7)
    assert found.load_fitted == pytest.approx(found.load, rel=1e-9)
    assert found.verdict.fits


@settings(max_examples=20, deadline=None)
@given(
    modulus=st.floats(0.1, 1e3),
    energy=st.floats(0.0, 1e-4),
    contacts=st.integers(1, 9),
    scale=st.floats(0.1, 10.0),
)
def test_units_of_length_and_force_do_not_matter(modulus, energy, contacts, scale):
    a = scale * A
    load = contacts * (
        modulus * 4.0 / 3.0 * a**3 / (scale * RADIUS) - np.sqrt(8.0 * math.pi * energy * modulus * a**3)
    )
    found = fit_compression(load, contacts * math.pi * a**2, scale * RADIUS, Sample(contacts))
    assert found.composite_modulus == pytest.approx(modulus, rel=1e-7)
    assert found.adhesion_root == pytest.approx(math.sqrt(energy), rel=1e-5, abs=1e-7 * math.sqrt(modulus))


def test_the_law_that_comes_out_predicts_the_data():
    found = fit_compression(load_of(A), AREA, RADIUS)
    surface = mf.Surface([[0.0, 0.0]], [0.5], RADIUS, found.material)
    law = mf.friction_law(surface, mf.Independent(found.contact_law), load=load_of(A)[5:])
    assert law.area == pytest.approx(AREA[5:], rel=1e-6)
    assert found.contact_law == mf.JKR(found.adhesion_energy)


def test_the_table_that_comes_out_has_the_loads_of_the_fitted_modulus():
    found = fit_compression(load_of(SMALL, TABLE, 0.0), math.pi * SMALL**2, RADIUS, of_cap(TABLE))
    law = found.contact_law.for_material(mf.Material(2.0))
    assert 2.0 * law.load(0.1, RADIUS) == pytest.approx(MODULUS * TABLE.load(0.1, RADIUS), rel=1e-6)


def test_areas_one_by_one_and_in_total_are_one_calibration_of_equal_contacts():
    load, each = 5.0 * load_of(A), np.repeat(AREA[:, None], 5, axis=1)
    total = fit_compression(load, 5.0 * AREA, RADIUS, FIVE)
    single = fit_compression(load, each, RADIUS, FIVE)
    assert single.composite_modulus == pytest.approx(total.composite_modulus, rel=1e-12)
    assert single.root_covariance == pytest.approx(total.root_covariance, rel=1e-9)
    assert single.total_area_sd == pytest.approx(total.total_area_sd, rel=1e-9)
    assert single.line.slope == pytest.approx(total.line.slope, rel=1e-12)


def test_an_open_contact_bears_no_load():
    each = np.repeat(AREA[:, None], 3, axis=1)
    each[:4, 2] = 0.0
    load = 3.0 * load_of(A)
    load[:4] *= 2.0 / 3.0
    found = fit_compression(load, each, RADIUS, Sample(3))
    assert found.composite_modulus == pytest.approx(MODULUS, rel=1e-9)


def test_errors_of_areas_can_be_given():
    load, area = noisy(1)
    usual = fit_compression(load, area, RADIUS)
    given_sd = fit_compression(load, area, RADIUS, area_sd=usual.area_sd)
    assert given_sd.composite_modulus == pytest.approx(usual.composite_modulus, rel=1e-9)
    rough = fit_compression(load, area, RADIUS, area_sd=10.0 * usual.area_sd)
    assert rough.root_covariance[0, 0] > usual.root_covariance[0, 0]


def test_the_error_of_the_radius_enters_as_theory_says():
    found = fit_compression(*noisy(2, contacts=5), RADIUS, Sample(5, radius_sd=0.005))
    relative = 0.005 / RADIUS
    # P = E* 4 a^3/(3 R) - b sqrt(8 pi a^3) with b = sqrt(w E*): E* ~ R and sqrt(w) ~ 1/sqrt(R)
    expected = relative * np.array([found.composite_modulus, -0.5 * found.adhesion_root])
    assert found.radius_change == pytest.approx(expected, rel=1e-3)
    systematic = found.root_covariance - found.statistical_covariance
    assert systematic == pytest.approx(np.outer(expected, expected), rel=2e-3)
    assert found.parameters == ("radius", "composite_modulus")
    assert found.parameter_covariance[0, 1] == pytest.approx(0.005 * expected[0], rel=1e-3)
    assert "the error of the radius changes E* by 0.95 %" in map(str, found.notes)


@pytest.mark.parametrize("cap", [mf.SphericalCap(), TABLE, CAP, PROFILE], ids=repr)
def test_caps_of_any_kind_keep_their_shape_with_the_radius(cap):
    # P = E* s^2 q(A/s^2): of the nominal law, data of caps that are s times larger
    small = SMALL[:18]
    scale = 1.0 + 1e-3
    load, area, model = 5.0 * load_of(small, cap), 5.0 * math.pi * small**2, mf.Independent(contact=cap)
    found = fit_compression(load, area, RADIUS, Sample(5, radius_sd=1e-3 * RADIUS, model=model))
    errors = MeasurementErrors(load=5e-3 / scale**2, boundary=1.4e-3 / scale)
    larger = fit_compression(load / scale**2, area / scale**2, RADIUS, Sample(5, model=model), errors=errors)
    change = larger.composite_modulus - found.composite_modulus
    assert found.radius_change[0] == pytest.approx(change, rel=2e-3)


def test_equal_tests_agree_and_different_ones_are_told_apart():
    tests = [noisy(seed, contacts=5) for seed in range(3)]
    labels = np.repeat(["a", "b", "c"], A.size)
    load, area = (np.concatenate(part) for part in zip(*tests, strict=True))
    same = fit_compression(load, area, RADIUS, FIVE, test=labels)
    assert same.heterogeneity.agree
    assert [test.name for test in same.tests] == ["a", "b", "c"]
    alone = fit_compression(*tests[1], RADIUS, FIVE)
    assert same.tests[1].value[0] == alone.composite_modulus
    assert same.tests[1].verdict == alone.verdict
    # chi-squares of nested fits of a linear law add
    total = sum(test.verdict["chi_square"].statistic for test in same.tests) + same.heterogeneity.chi_square
    assert same.verdict["chi_square"].statistic == pytest.approx(total, rel=0.02)
    other = np.concatenate([*load[:40].reshape(2, 20), noisy(2, contacts=5, modulus=1.45)[0]])
    different = fit_compression(other, area, RADIUS, FIVE, test=labels)
    assert not different.heterogeneity.agree
    assert any("the tests differ" in str(note) for note in different.notes)


def test_the_bootstrap_has_the_spread_of_the_covariance():
    tests = [noisy(seed) for seed in range(6)]
    points = *(np.concatenate(part) for part in zip(*tests, strict=True)), RADIUS
    given = {"test": np.repeat(np.arange(6), A.size), "bootstrap": Bootstrap(600)}
    found = fit_compression(*points, **given)
    ratio = found.bootstrap.std(axis=0) / np.sqrt(np.diag(found.statistical_covariance))
    # the points' own scatter has a relative error of 1/sqrt(2 * 118)
    assert ratio == pytest.approx(1.0, abs=4.0 * math.hypot(1.0 / math.sqrt(236), 1.0 / math.sqrt(1200)))
    again = fit_compression(*points, **given)
    assert (again.bootstrap == found.bootstrap).all()


def test_without_adhesion_the_interval_of_w_begins_at_zero_and_a_negative_root_is_kept():
    found = fit_compression(*noisy(5, energy=0.0), RADIUS)
    assert found.adhesion_energy_interval[0] == 0.0
    modulus, sd = found.modulus_without_adhesion
    assert abs(modulus - MODULUS) < 3.0 * sd < 3.0 * math.sqrt(found.root_covariance[0, 0])
    assert any("the data do not show adhesion" in str(note) for note in found.notes)
    found = fit_compression(load_of(A, energy=0.0) + 5.0 * math.sqrt(1e-6) * A**1.5, AREA, RADIUS)
    assert found.adhesion_root < 0.0
    assert found.adhesion_energy == 0.0
    assert found.contact_law == mf.Hertz()
    assert np.linalg.eigvalsh(found.covariance).min() >= 0.0


def test_an_outlier_is_named_and_loses_its_weight_in_a_robust_fit():
    load, area = noisy(4, contacts=5)
    load[-1] += 8.0 * MeasurementErrors().load
    found = fit_compression(load, area, RADIUS, FIVE)
    assert found.verdict["largest"].probability < 0.01
    (note,) = [note for note in found.notes if "robust=True" in str(note)]
    assert re.match(r"load\[19\] lies 4 standard deviations from the law", str(note))
    steady = fit_compression(load, area, RADIUS, FIVE, robust=True)
    assert steady.weight[-1] < 0.5 < steady.weight[:-1].min()
    assert steady.verdict.fits
    assert "gives less than half of their weight to load[19]" in " ".join(map(str, steady.notes))
    error, robust_error = (abs(each.composite_modulus - MODULUS) for each in (found, steady))
    assert robust_error < 0.5 * error
    assert (found.weight == 1.0).all()


def test_a_robust_fit_of_clean_data_has_slightly_wider_intervals():
    usual, robust = (fit_compression(*noisy(6), RADIUS, robust=each) for each in (False, True))
    ratio = np.sqrt(np.diag(robust.root_covariance) / np.diag(usual.root_covariance))
    assert ratio == pytest.approx(1.026, abs=0.03)
    assert robust.verdict.fits


def test_a_fit_to_another_law_or_with_too_small_errors_says_so():
    other = 10.0 * AREA**1.1, 5.0 * AREA, RADIUS, FIVE
    found = fit_compression(*other)
    assert not found.verdict.fits
    assert any("does not fit" in str(note) for note in found.notes)
    found = fit_compression(*other, robust=True)
    assert any(note.warns and "the law may not fit" in str(note) for note in found.notes)
    points = *noisy(4, contacts=5), RADIUS, FIVE
    small = MeasurementErrors(load=1e-4, boundary=0.02 * MeasurementErrors().boundary)
    found = fit_compression(*points, errors=small, robust=True)
    assert (found.weight < 0.5).sum() > 10
    assert not found.verdict.law_fits
    none = MeasurementErrors(load=1e-6, boundary=1e-4 * MeasurementErrors().boundary)
    with pytest.raises(mf.InvalidInput, match=r"fewer than two points are within 4\.7 standard deviations"):
        fit_compression(*points, errors=none, robust=True)


@pytest.mark.parametrize("wrong", [{"load": 1e3}, {"errors": 1e-2}])
def test_no_single_point_is_blamed_for_wrong_units_or_errors(wrong):
    load, area = noisy(4, contacts=5)
    usual, factor = MeasurementErrors(), wrong.get("errors", 1.0)
    errors = MeasurementErrors(load=factor * usual.load, boundary=factor * usual.boundary)
    found = fit_compression(wrong.get("load", 1.0) * load, area, RADIUS, FIVE, errors=errors)
    assert found.verdict["largest"].probability < 0.01
    assert not any("robust=True" in str(note) for note in found.notes)


@pytest.mark.slow
@pytest.mark.parametrize(("contacts", "place"), [(1, None), (1, 59), (5, None), (5, 59)])
def test_robust_intervals_hold_with_an_outlier(contacts, place):
    rng = np.random.default_rng(7)
    found = [
        fit_compression(*with_outlier(rng, contacts, place), RADIUS, Sample(contacts), robust=True)
        for _ in range(300)
    ]
    inside = [low <= MODULUS <= high for low, high in (each.composite_modulus_interval for each in found)]
    assert np.mean(inside) == pytest.approx(0.66, abs=3.0 * math.sqrt(0.68 * 0.32 / 300))


def test_the_largest_radii_are_noted():
    notes = fit_compression(load_of(A), AREA, RADIUS).notes
    assert any("contact radii reach 0.76 R" in str(note) for note in notes)
    notes = fit_compression(load_of(A[:10]), AREA[:10], RADIUS).notes
    assert not any("contact radii" in str(note) for note in notes)


def test_a_test_whose_load_falls_is_named():
    load, area = load_of(A), AREA
    load = np.append(load, load[2::-1])
    found = fit_compression(load, np.append(area, area[:3]), RADIUS, test=["up"] * len(A) + ["down"] * 3)
    (note,) = [note for note in found.notes if "no fit of their own" in str(note)]
    assert note.warns
    assert "the tests down have no fit of their own: their areas are alike, or their loads" in str(note)


def test_areas_that_are_all_error_are_named():
    rng = np.random.default_rng(2)
    errors = MeasurementErrors(load=1e-6, boundary=0.1)
    area = np.abs(AREA + errors.of_area(AREA) * rng.standard_normal(A.size))
    with pytest.raises(
        mf.NotConverged, match=r"the most uncertain area is area\[1\] = 0.00234494, with an error"
    ):
        fit_compression(load_of(A), area, RADIUS, errors=errors)


LOAD, EACH, FIRST = load_of(A), np.repeat(AREA[:, None], 2, axis=1), A < 0.09


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"load": LOAD[:2], "area": AREA[:2]}, "load has 2 points; E* and the adhesion energy need"),
        ({"area": AREA[:5]}, "area has 5 numbers; it must have 20"),
        ({"area": np.where(FIRST, 0.0, AREA)}, "area[0] = 0 is no contact; leave the row out"),
        ({"area": np.where(FIRST, -0.01, AREA)}, "area[0] = -0.01 must not be negative"),
        ({"area": np.where(FIRST, np.nan, AREA)}, "area holds nan at entry 0"),
        ({"area": EACH, "sample": Sample(3)}, "area has shape (20, 2); it must have shape (20, 3)"),
        ({"area": np.full(20, 0.1)}, "all areas are 0.1: E* and the adhesion energy need points"),
        ({"area": AREA[::-1]}, "the load does not grow with the contact area: load[19] = "),
        ({"area": 4.0 * AREA, "sample": of_cap(mf.SphericalCap())}, "area[11] = 0.884227 is beyond "),
        ({"area": AREA, "sample": of_cap(TABLE)}, "area[11] = 0.221057 is beyond "),
        ({"area_sd": np.zeros(20)}, "area_sd[0] = 0 must be greater than 0"),
        ({"sample": Sample(radius_sd=0.6)}, "radius_sd = 0.6 must be less than the radius, 0.526"),
        ({"errors": 0.005}, "errors = 0.005 must be a metafem.calibration.MeasurementErrors"),
        ({"test": ["a"] * 19}, "must hold a label for each of the 20 points"),
        ({"test": "a"}, "test = 'a' must hold a label"),
        ({"sample": 5}, "sample = 5 must be a metafem.calibration.Sample"),
        ({"area": 5.0 * AREA, "load": 5.0 * LOAD}, "R, which no cap has; check the radius, 0.526"),
    ],
)
def test_wrong_data_are_named(arguments, message):
    with pytest.raises(mf.InvalidInput, match=re.escape(message)):
        fit_compression(**({"load": LOAD, "area": AREA, "radius": RADIUS} | arguments))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Sample(0), "contacts = 0 must be a whole number of at least 1"),
        (lambda: of_cap(mf.JKR(1e-6)), "has an adhesion energy, which is fitted"),
        (lambda: of_cap(mf.KogutEtsion(0.1)), "is plastic; E* is fitted to an elastic law"),
        (lambda: of_cap(mf.TabulatedContact(*np.ones((3, 1)) * [1, 2, 3])), "has loads in N for one E*"),
        (lambda: Sample(model=mf.Interacting()), "model needs surface, the calibration sample"),
        (lambda: Sample(poisson_ratio=0.6), "poisson_ratio = 0.6 must be at most 0.5"),
        (lambda: Bootstrap(-1), "bootstrap = -1 must be a whole number"),
    ],
)
def test_samples_without_a_fit_and_a_bootstrap_without_draws_are_refused(call, message):
    with pytest.raises(mf.InvalidInput, match=re.escape(message)):
        call()
