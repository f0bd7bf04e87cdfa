"""E* and adhesion energy from compression tests: exact data, other fits, closed forms and wrong data."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.calibration import MeasurementErrors, fit_compression
from metafem.calibration.compression import fit_areas, of_root
from metafem.calibration.statistics import WIDTH
from tests.calibration.compression.scenes import (
    AREA,
    MODULUS,
    RADIUS,
    A,
    load_of,
    noisy,
)

EXACT = fit_compression(load_of(A), AREA, RADIUS)


def modulus_of(found):
    return found.estimates["composite_modulus"].value


def energy_of(found):
    return found.estimates["adhesion_energy"].value


@settings(max_examples=20)
@given(st.floats(0.1, 1e3), st.floats(0.0, 1e-4), st.integers(1, 9), st.floats(0.1, 10.0))
def test_units_of_length_and_force_do_not_matter(modulus, energy, contacts, scale):
    a = scale * A
    load = contacts * (
        modulus * 4.0 / 3.0 * a**3 / (scale * RADIUS) - np.sqrt(8.0 * math.pi * energy * modulus * a**3)
    )
    (found, root), _ = of_root(fit_areas(load, math.pi * a[:, None] ** 2, scale * RADIUS, contacts))
    assert found == pytest.approx(modulus, rel=1e-7)
    assert root == pytest.approx(math.sqrt(energy), rel=1e-5, abs=1e-7 * math.sqrt(modulus))


def test_of_given_variances_it_is_the_regression_of_odrpack():
    import odrpack

    errors = MeasurementErrors()
    tests = [noisy(seed) for seed in range(3)]
    load, area = (np.concatenate(part) for part in zip(*tests, strict=True))
    sd = errors.of_area(np.tile(AREA, 3))

    class Constant(MeasurementErrors):
        of_open = 0.0

        def of_area(self, area):
            return sd[:, None]

    def model(x, beta):
        radius = np.sqrt(x / math.pi)
        return beta[0] * 4.0 / 3.0 * radius**3 / RADIUS - beta[1] * np.sqrt(8.0 * math.pi * radius**3)

    found = fit_areas(load, area[:, None], RADIUS, 1, Constant())
    other = odrpack.odr_fit(
        model, area, load, np.array([1.0, 0.0]), weight_x=sd**-2, weight_y=errors.load**-2,
        diff_scheme="central", sstol=1e-15, partol=1e-15,
    )  # fmt: skip
    deviation = np.sqrt(np.diag(found.covariance))
    assert (np.abs(found.parameter - other.beta) < 1e-5 * deviation).all()
    assert np.abs(found.abscissa - other.xplusd).max() < 1e-6 * sd.max()
    assert found.chi_square.sum() == pytest.approx(other.sum_square, rel=1e-6)


def test_the_law_that_comes_out_predicts_the_data():
    surface = mf.Surface([[0.0, 0.0]], [0.5], RADIUS, EXACT.material)
    law = mf.friction_law(surface, mf.Independent(EXACT.contact_law), load=load_of(A)[5:])
    assert law.area == pytest.approx(AREA[5:], rel=1e-6)
    assert EXACT.contact_law == mf.JKR(energy_of(EXACT))
    # radii at which large strains change the law are noted
    assert any("0.76 R" in str(note) for note in EXACT.notes)
    few = fit_compression(load_of(A[:10]), AREA[:10], RADIUS)
    assert not any(" R; beyond" in str(note) for note in few.notes)


def test_areas_one_by_one_and_in_total_are_one_calibration_and_an_open_contact_bears_no_load():
    load, each = 5.0 * load_of(A), np.repeat(AREA[:, None], 5, axis=1)
    total = fit_compression(load, 5.0 * AREA, RADIUS, contacts=5)
    single = fit_compression(load, each, RADIUS, contacts=5)
    for name, estimate in total.estimates.items():
        value, sd, interval = single.estimates[name]
        assert (value, sd, *interval) == pytest.approx((*estimate[:2], *estimate.interval), rel=1e-9)
    each[:4, 2] = 0.0
    load[:4] *= 4.0 / 5.0
    assert modulus_of(fit_compression(load, each, RADIUS, contacts=5)) == pytest.approx(MODULUS, rel=1e-9)


def test_the_error_of_the_radius_enters_as_theory_says():
    found = fit_compression(
        *noisy(2, contacts=5), RADIUS, contacts=5, errors=MeasurementErrors(radius_sd=0.005)
    )
    alone = fit_compression(*noisy(2, contacts=5), RADIUS, contacts=5)
    # P = E* 4 a^3/(3 R) - b sqrt(8 pi a^3) with b = sqrt(w E*): E* ~ R and sqrt(w) ~ 1/sqrt(R)
    assert modulus_of(found) == pytest.approx(modulus_of(alone), rel=1e-9)
    change = 0.005 / RADIUS * modulus_of(found)
    of_radius, of_modulus = found.covariance
    assert found.parameters == ("radius", "composite_modulus")
    assert of_radius == pytest.approx([0.005**2, 0.005 * change], rel=1e-6)
    assert of_modulus[1] == pytest.approx(alone.covariance[0, 0] + change**2, rel=1e-6)
    _, _, (low, high) = found.estimates["adhesion_energy"]
    root, root_sd = 0.5 * (math.sqrt(low) + math.sqrt(high)), 0.5 * (math.sqrt(high) - math.sqrt(low))
    low, high = np.sqrt(alone.estimates["adhesion_energy"].interval)
    expected = math.hypot(0.5 * (high - low), WIDTH * 0.5 * 0.005 / RADIUS * root)
    assert root_sd == pytest.approx(expected, rel=1e-3)


def test_equal_tests_agree_and_different_ones_are_told_apart():
    tests = [noisy(seed, contacts=5) for seed in range(3)]
    labels = np.repeat(["a", "b", "c"], A.size)
    load, area = (np.concatenate(part) for part in zip(*tests, strict=True))
    same = fit_compression(load, area, RADIUS, contacts=5, test=labels)
    assert same.heterogeneity.fits
    other = np.concatenate([*load[:40].reshape(2, 20), noisy(2, contacts=5, modulus=1.45)[0]])
    different = fit_compression(other, area, RADIUS, contacts=5, test=labels)
    assert not different.heterogeneity.fits
    assert "the tests differ" in str(different.notes[-1])
    # another law than that of the caps does not fit
    other = fit_compression(10.0 * AREA**1.1, 5.0 * AREA, RADIUS, contacts=5)
    assert not other.verdict.fits
    assert any("does not fit" in str(note) for note in other.notes)


def test_without_adhesion_the_interval_of_w_begins_at_zero_and_e_is_that_of_a_fit_without_it():
    found = fit_compression(*noisy(5, energy=0.0), RADIUS)
    assert found.estimates["adhesion_energy"].interval[0] == 0.0
    value, sd, _ = found.estimates["composite_modulus"]
    assert abs(value - MODULUS) < 3.0 * sd
    repelled = load_of(A, energy=0.0) + 5.0 * math.sqrt(1e-6) * A**1.5
    found = fit_compression(repelled, AREA, RADIUS)
    assert energy_of(found) == 0.0
    assert found.contact_law == mf.Hertz()
    q = mf.Hertz().load(A, RADIUS)
    value, sd, _ = found.estimates["composite_modulus"]
    slope, errors = value * 1.5 * q / AREA, MeasurementErrors()
    weight = 1.0 / (errors.load**2 + (slope * errors.of_area(AREA)) ** 2)
    assert value == pytest.approx((weight * q * repelled).sum() / (weight * q**2).sum(), rel=1e-3)
    assert sd == pytest.approx((weight * q**2).sum() ** -0.5, rel=0.02)
    assert found.material.composite_modulus == value


def test_intervals_follow_from_the_covariance_and_that_of_w_is_asymmetric():
    sd = math.sqrt(EXACT.covariance[0, 0])
    assert np.diff(EXACT.estimates["composite_modulus"].interval) == pytest.approx(2.0 * WIDTH * sd)
    low, high = EXACT.estimates["adhesion_energy"].interval
    assert high - energy_of(EXACT) > energy_of(EXACT) - low > 0.0


def test_a_test_whose_load_falls_is_told():
    load, area = load_of(A), AREA
    load = np.append(load, load[2::-1])
    found = fit_compression(load, np.append(area, area[:3]), RADIUS, test=["up"] * len(A) + ["down"] * 3)
    (note,) = [note for note in found.notes if "not compared" in str(note)]
    assert note.warns
    assert "load does not grow" in str(note)


def test_no_interval_of_the_modulus_is_below_zero():
    a = np.array([0.05, 0.06, 0.08])
    found = fit_compression(4.0 / 3.0 * 1.36 * a**3 / 0.526, np.pi * a**2, 0.526)
    for value, _, (low, high) in found.estimates.values():
        assert 0.0 <= low <= value < high
