"""Calibrations of contacts: draws, robust fits, other samples and what is noted."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import Bootstrap, MeasurementErrors, Sample, fit_compression
from metafem.calibration.compression.adhesive_line import adhesive_line
from metafem.calibration.compression.scene import cap_curve, sample_curve
from tests.calibration.compression.scenes import (
    AREA,
    MODULUS,
    RADIUS,
    SMALL,
    TABLE,
    A,
    load_of,
    noisy,
    of_cap,
)
from validation.scenes.drift import with_outlier

CAP = mf.AxisymmetricCap(lambda rho: rho**2 / (2 * RADIUS) + rho**4, extent=0.4)

PROFILE = mf.AxisymmetricCap(np.array([SMALL, SMALL**2 / (2 * RADIUS)]) * (SMALL > 0.05))


EXACT = fit_compression(load_of(A), AREA, RADIUS)

PLACE = np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])


def test_the_table_that_comes_out_has_the_loads_of_the_fitted_modulus():
    found = fit_compression(load_of(SMALL, TABLE, 0.0), math.pi * SMALL**2, RADIUS, of_cap(TABLE))
    law = found.contact_law.for_material(mf.Material(2.0))
    assert 2.0 * law.load(0.1, RADIUS) == pytest.approx(MODULUS * TABLE.load(0.1, RADIUS), rel=1e-6)


def test_a_robust_fit_of_clean_data_has_slightly_wider_intervals():
    usual, robust = (fit_compression(*noisy(6), RADIUS, robust=each) for each in (False, True))
    ratio = np.sqrt(np.diag(robust.root_covariance) / np.diag(usual.root_covariance))
    assert ratio == pytest.approx(1.026, abs=0.03)
    assert robust.verdict.fits


def test_no_single_point_is_blamed_for_wrong_errors():
    usual = MeasurementErrors()
    errors = MeasurementErrors(load=0.01 * usual.load, boundary=0.01 * usual.boundary)
    found = fit_compression(*noisy(4, contacts=5), RADIUS, Sample(5), errors=errors)
    assert found.verdict["largest"].probability < 0.01
    assert not any("robust=True" in str(note) for note in found.notes)


@pytest.mark.parametrize(("contacts", "place"), [(1, None), (5, 59)])
def test_robust_intervals_hold_with_an_outlier(contacts, place):
    rng = np.random.default_rng(7)
    found = [
        fit_compression(*with_outlier(rng, contacts, place), RADIUS, Sample(contacts), robust=True)
        for _ in range(300)
    ]
    inside = [low <= MODULUS <= high for low, high in (each.composite_modulus_interval for each in found)]
    assert np.mean(inside) == pytest.approx(0.66, abs=3.0 * math.sqrt(0.68 * 0.32 / 300))


def test_a_test_whose_load_falls_is_named():
    load, area = load_of(A), AREA
    load = np.append(load, load[2::-1])
    found = fit_compression(load, np.append(area, area[:3]), RADIUS, test=["up"] * len(A) + ["down"] * 3)
    (note,) = [note for note in found.notes if "tests down" in str(note)]
    assert note.warns
    assert np.isnan(found.tests[1].value).all()


def test_no_interval_of_the_modulus_is_below_zero():
    a = np.array([0.05, 0.06, 0.08])
    found = fit_compression(4.0 / 3.0 * 1.36 * a**3 / 0.526, np.pi * a**2, 0.526)
    assert np.sqrt(found.root_covariance[0, 0]) > found.composite_modulus
    low, high = found.composite_modulus_interval
    assert 0.0 <= low < found.composite_modulus < high


def test_it_draws_points_with_error_bars_and_the_law():
    ax = EXACT.plot()
    assert len(ax.containers) == 1
    x, y = ax.lines[-1].get_data()
    assert x[-1] == pytest.approx(EXACT.load_fitted[-1])
    assert y[[0, -1]] == pytest.approx([0.0, AREA[-1]])
    assert np.interp(AREA, y, x) == pytest.approx(EXACT.load_fitted, abs=1e-5)


def test_errors_of_areas_can_be_given():
    load, area = noisy(1)
    usual = fit_compression(load, area, RADIUS)
    given_sd = fit_compression(load, area, RADIUS, area_sd=usual.area_sd)
    assert given_sd.composite_modulus == pytest.approx(usual.composite_modulus, rel=1e-9)
    rough = fit_compression(load, area, RADIUS, area_sd=10.0 * usual.area_sd)
    assert rough.root_covariance[0, 0] > usual.root_covariance[0, 0]


def test_caps_of_any_kind_keep_their_shape_with_the_radius():
    # P = E* s^2 q(A/s^2): of the nominal law, data of caps that are s times larger
    small, scale = SMALL[:18], 1.0 + 1e-3
    for cap in (mf.SphericalCap(), TABLE, CAP, PROFILE):
        load, area, model = 5.0 * load_of(small, cap), 5.0 * math.pi * small**2, mf.Independent(contact=cap)
        found = fit_compression(load, area, RADIUS, Sample(5, radius_sd=1e-3 * RADIUS, model=model))
        errors = MeasurementErrors(load=5e-3 / scale**2, boundary=1.4e-3 / scale)
        of_larger = load / scale**2, area / scale**2, RADIUS, Sample(5, model=model)
        change = fit_compression(*of_larger, errors=errors).composite_modulus - found.composite_modulus
        assert found.radius_change[0] == pytest.approx(change, rel=2e-3)


def test_the_bootstrap_has_the_spread_of_the_covariance():
    tests = [noisy(seed) for seed in range(6)]
    points = *(np.concatenate(part) for part in zip(*tests, strict=True)), RADIUS
    given_ = {"test": np.repeat(np.arange(6), A.size), "bootstrap": Bootstrap(600)}
    found = fit_compression(*points, **given_)
    ratio = found.bootstrap.std(axis=0) / np.sqrt(np.diag(found.statistical_covariance))
    # the points' own scatter has a relative error of 1/sqrt(2 * 118)
    assert ratio == pytest.approx(1.0, abs=4.0 * math.hypot(1.0 / math.sqrt(236), 1.0 / math.sqrt(1200)))
    assert (fit_compression(*points, **given_).bootstrap == found.bootstrap).all()


def test_the_covariance_of_the_line_is_that_of_errors_of_y():
    rng = np.random.default_rng(0)
    exact = adhesive_line(MODULUS * mf.Hertz().load(A, RADIUS), AREA, RADIUS)
    y = exact.y + 1e-4 * rng.standard_normal((4000, 20))
    # x ~ p/a0^(3/4) and y ~ a0^(3/4)
    area = AREA * (y / exact.y) ** (4.0 / 3.0)
    line = adhesive_line(MODULUS * mf.Hertz().load(A, RADIUS) * y / exact.y, area, RADIUS)
    # relative error of a variance from 4000 draws: 2.2 %
    spread = np.cov(line.composite_modulus, line.adhesion_root)
    assert line.root_covariance.mean(axis=0) == pytest.approx(spread, rel=0.12)


def test_independent_caps_of_one_height_have_the_curve_of_the_cap():
    for one_by_one in (False, True):
        area = np.repeat(AREA[:15, None], 5, axis=1) if one_by_one else AREA[:15, None]
        surface = mf.Surface(5.0 * PLACE, [0.4] * 5, RADIUS, mf.Material(1.0))
        cap = mf.SphericalCap()
        found = sample_curve(surface, mf.Independent(contact=cap), area, one_by_one).load_and_slope(area)
        alone = cap_curve(cap, RADIUS).load_and_slope(area)
        assert found[0] == pytest.approx(alone[0], rel=1e-7)
        assert found[1] == pytest.approx(alone[1], rel=1e-5)
